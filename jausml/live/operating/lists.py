"""Lists of elements, such as waypoints, that a person draws on a map and a component executes."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager
from typing import Any

from jausml.live.messages import MessageEntry
from jausml.live.messages.errors import CodecError
from jausml.live.operating.journal import Journal
from jausml.live.operating.watching import WatchedSystem
from jausml.live.peers.query_client import NoAnswer, Refused
from jausml.live.peers.rendering import printable, shown_fields
from jausml.runtime.base.address import JausAddress
from jausml.runtime.services.list_elements import ELEMENTS_OF_DRIVERS

MOST_ELEMENTS = 1000

# The fields of each element, in the order of the list.
Elements = tuple[dict[str, object], ...]


class Lists:
    """The lists of the components that the unit controls; any thread may call it."""

    def __init__(self, system: WatchedSystem, journal: Journal) -> None:
        """Sends nothing."""
        self._system, self._journal = system, journal

    def set(
        self,
        name: str,
        target: JausAddress,
        message: str,
        elements: Elements,
        gate: AbstractContextManager[None],
    ) -> None:
        """Replaces the list of a component, which ends the execution of its former list.

        Args:
            name: The person, for the journal.
            gate: Is held while the change begins, and may refuse it.

        Raises:
            CodecError: A value does not fit its field; nothing is sent.
            Refused: The component takes no such list.
        """
        operator = self._system.operator
        entry, payloads = self._encoded(target, message, elements)
        operator.check_obeyed(target, operator.find(target, "SetElement"))
        shown = "; ".join(
            f"{uid}: {printable(shown_fields(entry, entry.decode(payload)))}"
            for uid, payload in enumerate(payloads, 1)
        )
        self._journal.note(name, f"list of {len(payloads)} {entry.name} to {target}: {shown}")
        self._change(target, payloads, gate)
        self._journal.note(str(target), f"has the list of {len(payloads)} {entry.name}")

    def check(self, target: JausAddress, message: str, elements: Elements) -> None:
        """Raises `Refused` unless the component has the drawn list."""
        _, payloads = self._encoded(target, message, elements)
        if not self._system.operator.has_list(target, payloads):
            raise Refused(f"{target} has another list than the one that is drawn; send it first")

    def end(self, name: str, target: JausAddress) -> None:
        """Stops a component and deletes its list.

        Speed 0 alone does not suffice: a lost ExecuteList may be repeated after it.
        """
        operator = self._system.operator
        execute = operator.find(target, "ExecuteList")
        operator.check_obeyed(target, execute)
        self._journal.note(name, f"ends the list of {target}: speed 0, and no element")
        operator.send(target, operator.message(execute, {"Speed": 0.0}), acknowledge=True)
        self._change(target, ())
        self._journal.note(str(target), "has no element in its list")

    def _change(
        self,
        target: JausAddress,
        payloads: Sequence[bytes],
        gate: AbstractContextManager[None] | None = None,
    ) -> None:
        try:
            self._system.operator.set_list(target, payloads, gate)
        except (NoAnswer, Refused) as error:
            named = self._system.name_of(target)
            self._journal.alarm(named, str(error), f"list of {named}")
            raise

    def _encoded(
        self, target: JausAddress, message: str, elements: Elements
    ) -> tuple[MessageEntry, list[bytes]]:
        if not 0 < len(elements) <= MOST_ELEMENTS:
            raise Refused(f"{len(elements)} elements are drawn, not 1 to {MOST_ELEMENTS}")
        operator = self._system.operator
        entry = operator.find(target, message)
        provided = {service.urn for service in operator.services(target)}
        taken = {code for urn, code in ELEMENTS_OF_DRIVERS.items() if urn in provided}
        if entry.code not in taken:
            raise Refused(f"{target} provides no driver for lists of {entry.name}")
        return entry, [_encoded(entry, at, element) for at, element in enumerate(elements)]


def _encoded(entry: MessageEntry, at: int, fields: dict[str, Any]) -> bytes:
    try:
        return entry.encode(entry.completed(fields))
    except CodecError as error:
        raise error.inside(f"elements[{at}]") from None
