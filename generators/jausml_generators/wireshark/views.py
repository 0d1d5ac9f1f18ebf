"""View of the dissector for its template: messages as plain tables, ports, names."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from jausml.generation.errors import GenerationError
from jausml.language import wire
from jausml_generators.python import names
from jausml_generators.wireshark.tables import TableBuilder, label

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from jausml.language.metamodel.classes import jaus
    from jausml.language.metamodel.classes.system import System
    from jausml_generators.wireshark.tables import Table

JAUS_PORT = 3794
NEIGHBOUR_PORTS = range(53794, 53826)
"""UDP ports of processes that share that of JAUS and do not own it, as the runtime takes them."""
"""The port that IANA assigned to JAUS (AS5669A)."""


class MessageTable:
    """A message of one code, name and layout, and the services that define it."""

    def __init__(self, code: int, name: str, body: Table, filter_name: str) -> None:
        self.code = code
        self.name = name
        self.body = body
        self.filter = filter_name
        self.services: list[str] = []

    @property
    def code_text(self) -> str:
        """Message code as the standard writes it, e.g. `0x4404`."""
        return f"0x{self.code:04X}"

    @property
    def table(self) -> Table:
        """What the dissector knows of the message."""
        head: Table = {"name": self.name, "filter": self.filter, "services": self.services}
        return {**head, **({"body": self.body} if self.body else {})}


class DissectorView:
    """The dissector of a system.

    Args:
        services: The `jaus.Service` elements whose messages are known; of several definitions of
            one message code the first that fits is shown, in this order.
    """

    def __init__(self, system: System, source: str, services: Sequence[jaus.Service]) -> None:
        self.system = system
        self.source = source
        self.element_id = f"wireshark:{system.name}"
        self._services = services

    @property
    def path(self) -> str:
        """Where the file stands."""
        return f"wireshark/{names.snake_case(self.system.name)}_jaus.lua"

    @property
    def title(self) -> str:
        """The name of the system in one line."""
        return label(str(self.system.name))

    @property
    def ports(self) -> list[int]:
        """The UDP and TCP ports of the hosts of the system, and that of JAUS."""
        return sorted({JAUS_PORT, *(int(host.port) for host in self.system.hosts)})

    @property
    def neighbour_ports(self) -> list[int]:
        """The UDP ports of processes that share that of JAUS."""
        return list(NEIGHBOUR_PORTS)

    @cached_property
    def messages(self) -> list[MessageTable]:
        """The messages in the order of their codes."""
        return message_tables(self._services)


def message_tables(services: Iterable[jaus.Service]) -> list[MessageTable]:
    """Returns the messages of some services, equal ones once, in the order of their codes.

    Raises:
        GenerationError: A message cannot be encoded; validation tells users before.
    """
    found: dict[int, list[MessageTable]] = {}
    filters: dict[str, dict[str, str]] = {}
    for service in services:
        identity = label(f"{service.urn} {service.version}")
        for element in (*service.inputs, *service.outputs):
            of_code = found.setdefault(int(str(element.code), 16), [])
            _add(element, identity, of_code, filters)
    return [message for code in sorted(found) for message in found[code]]


def _add(
    element: jaus.MessageDef,
    identity: str,
    of_code: list[MessageTable],
    filters: dict[str, dict[str, str]],
) -> None:
    """Adds a message unless one of its code has its name and layout; then only its service."""
    try:
        layout = wire.resolve(element)
    except wire.LayoutError as error:
        raise GenerationError(str(error)) from None
    name = label(layout.name)
    base = names.snake_case(layout.name)
    number = 1
    while True:
        filter_name = f"jaus.{base}" if number == 1 else f"jaus.{base}_{number}"
        builder = TableBuilder(filter_name)
        body = builder.build(layout.body)
        for message in of_code:
            if (message.name, message.body, message.filter) == (name, body, filter_name):
                if identity not in message.services:
                    message.services.append(identity)
                return
        known = filters.setdefault(filter_name, {})
        # Definitions of one name share their filters unless a filter would have two types.
        if all(known.get(each, kind) == kind for each, kind in builder.types.items()):
            known.update(builder.types)
            message = MessageTable(layout.code, name, body, filter_name)
            message.services.append(identity)
            of_code.append(message)
            return
        number += 1
