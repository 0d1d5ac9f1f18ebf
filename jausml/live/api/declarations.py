"""What a component declares, before it runs or while it does: services, answers, commands."""

from __future__ import annotations

from inspect import iscoroutinefunction
from typing import TYPE_CHECKING

from jausml.live.api.messages import Received
from jausml.live.peers.entry_messages import find_exchange, find_message
from jausml.live.peers.operator import Identity
from jausml.runtime.services.definitions import ServiceIdentity

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from jausml.live.api.messages import Fields
    from jausml.live.messages import Catalogue, MessageEntry
    from jausml.live.peers.operator import Operator
    from jausml.live.peers.watching import Reply
    from jausml.runtime.base.address import JausAddress


class Declarations:
    """Services of a component, the reports that it gives, and the messages that it takes."""

    def __init__(self, known: Catalogue, name: str, provides: str | Sequence[str]) -> None:
        """Declares services alone."""
        named = (provides,) if isinstance(provides, str) else provides
        self.identity = Identity(name, _identities(known, named))
        self._known = known
        self._answers: dict[MessageEntry, tuple[MessageEntry, Callable[[], Fields | None]]] = {}
        self._obeyed: dict[MessageEntry, Callable[[Received], Reply | None]] = {}

    def answer(
        self, name: str, give: Callable[[], Fields | None]
    ) -> tuple[MessageEntry, MessageEntry]:
        """Declares that a function gives a report; returns its query, and itself."""
        _check_callable(give, "that returns the fields")
        query, report = find_exchange(self._known, name, self.identity.services)
        if query in self._answers:
            raise ValueError(f"{query.name} is answered already")
        self._answers[query] = report, give
        return query, report

    def obey(self, name: str, take: Callable[[Received], Reply | None]) -> MessageEntry:
        """Declares that a function takes a message, and returns that."""
        _check_callable(take, "that takes the message")
        entry = find_message(self._known, name, self.identity.services)
        if entry.name.startswith("Query"):
            raise ValueError(f"{entry.name} is a query: `answer` gives its report")
        if entry in self._obeyed:
            raise ValueError(f"{entry.name} is obeyed already")
        self._obeyed[entry] = take
        return entry

    def prepare(self, operator: Operator) -> None:
        """Has an operator do what was declared, before anybody can ask it."""
        for query, (report, give) in self._answers.items():
            operator.provide(query, report, give)
        for entry, take in self._obeyed.items():
            operator.obey(entry, taking(take))


def taking(
    take: Callable[[Received], Reply | None],
) -> Callable[[MessageEntry, Fields, JausAddress], Reply | None]:
    """Returns what takes a message as an operator has it, and hands it to a user's function."""

    def take_entry(entry: MessageEntry, fields: Fields, sender: JausAddress) -> Reply | None:
        return take(Received(entry.name, entry.shortened(fields), str(sender)))

    return take_entry


def _check_callable(function: object, purpose: str) -> None:
    if iscoroutinefunction(function):
        raise TypeError(f"a function {purpose} cannot be async: it is called on another thread")
    if not callable(function):
        raise TypeError(f"{function!r} is not a function {purpose}")


def _identities(known: Catalogue, names: Sequence[str]) -> tuple[ServiceIdentity, ...]:
    """Returns services with all that they inherit, and the core services that each tool has."""
    found = {each.urn: each for each in Identity().services}
    for name in names:
        for each in known.find_services(name)[0].lineage:
            major, _, minor = each.version.partition(".")
            found.setdefault(each.urn, ServiceIdentity(each.urn, int(major), int(minor or 0)))
    return tuple(found.values())
