"""Target `wireshark`: one Lua file that makes Wireshark show JAUS messages."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from typing import Any

from jausml.generation.errors import GenerationError
from jausml.generation.literals import printable
from jausml.generation.target import (
    FileTask,
    Target,
    Task,
    WholeLibrary,
    source_of,
    system_of,
    templates_beside,
)
from jausml.language import wire
from jausml.language.metamodel.classes import jaus
from jausml.language.metamodel.classes.system import System
from jausml.language.model.model import Model
from jausml.language.semantics import names as words
from jausml_generators.common.components import library_services, used_services
from jausml_generators.python import names
from jausml_generators.python.names import Scope

JAUS_PORT = 3794
"""The port that IANA assigned to JAUS (AS5669A)."""
NEIGHBOUR_PORTS = range(53794, 53826)
"""UDP ports of processes that share that of JAUS and do not own it, as the runtime takes them."""


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
        """The facts of the message for the dissector."""
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
    def second(self) -> str:
        """The message of a script that finds another one of JAUS loaded."""
        file = self.path.rpartition("/")[2]
        cure = "keep one script of JAUS, or generate one of all your services"
        return f"{file} is not loaded, since another script shows JAUS already: {cure}"

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
    """Returns the messages of some services, equal ones once, in the order of their codes."""
    tables_by_code: dict[int, list[MessageTable]] = {}
    filters: dict[str, dict[str, str]] = {}
    for service in services:
        identity = label(f"{service.urn} {service.version}")
        for element in (*service.inputs, *service.outputs):
            of_code = tables_by_code.setdefault(int(str(element.code), 16), [])
            _add(element, identity, of_code, filters)
    return [message for code in sorted(tables_by_code) for message in tables_by_code[code]]


def _add(
    element: jaus.MessageDef,
    identity: str,
    of_code: list[MessageTable],
    filters: dict[str, dict[str, str]],
) -> None:
    """Adds a message, or only its service if one of its code has its name and layout."""
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
        if all(known.get(path, kind) == kind for path, kind in builder.types.items()):
            known.update(builder.types)
            message = MessageTable(layout.code, name, body, filter_name)
            message.services.append(identity)
            of_code.append(message)
            return
        number += 1


Table = dict[Any, Any]

# What the dissector itself adds below the filter of a field.
_TAKEN = frozenset(("count", "data", "format", "index", "length", "presence", "raw", "tag"))
_EXACT = 2**53  # integers below are exact in the numbers of Lua 5.1 and 5.2


def label(text: str) -> str:
    """Returns a text of the model on one line without control characters, never empty."""
    return " ".join(printable(text).split()) or "unnamed"


def filter_word(name: str) -> str:
    """Returns the part of a display filter for a name, e.g. `request_id` for RequestID."""
    word = words.snake_case(name) or "unnamed"
    return f"n{word}" if word[0].isdigit() else word


class TableBuilder:
    """Builds the table of one message's body.

    Args:
        filter_name: What the display filters of its fields begin with.

    Attributes:
        types: Type of each display filter.
    """

    def __init__(self, filter_name: str) -> None:
        self._filter = filter_name
        self.types: dict[str, str] = {}

    def build(self, body: wire.Field | None) -> Table:
        """Returns the table of a body; one without members for no body."""
        return {} if body is None else self._inner(body, self._filter)

    def _inner(self, field: wire.Field, path: str) -> Table:
        """Returns the table of a field by itself; a record passes on the filter around it."""
        if isinstance(field.kind, wire.Record):
            return self._field(field, path)
        word = Scope(_TAKEN).claim(filter_word(field.name))
        return self._field(field, f"{path}.{word}")

    def _field(self, field: wire.Field, path: str) -> Table:
        presence = {"presence_bit": field.bit.bit_length() - 1} if field.is_optional else {}
        table = self._kind(field.kind, path)
        return {"name": label(field.name), **presence, "filter": path, **table}

    def _kind(self, kind: wire.Kind, path: str) -> Table:  # noqa: C901 - a branch for each kind
        match kind:
            case wire.Integer() | wire.Real() | wire.Scaled():
                return self._number(kind, path)
            case wire.BitField():
                return self._bits(kind, path)
            case wire.FixedText():
                self._typed(path, "string")
                return {"kind": "text", "length": kind.length}
            case wire.Text():
                self._typed(path, "string")
                return {
                    "kind": "text",
                    "count": self._typed(f"{path}.length", kind.count.type.name),
                }
            case wire.Octets():
                return self._bytes(kind, path)
            case wire.FormattedOctets():
                return self._formatted(kind, path)
            case wire.VariableNumber():
                return self._choice(kind, path)
            case wire.Record():
                return self._record(kind, path)
            case wire.List():
                self._typed(path, "none")
                count = self._typed(f"{path}.count", kind.count.type.name)
                return {"kind": "list", "count": count, "element": self._inner(kind.element, path)}
            case wire.Array():
                self._typed(path, "none")
                element = self._inner(kind.element, path)
                return {"kind": "array", "sizes": list(kind.dimensions), "element": element}
            case wire.Variant():
                self._typed(path, "none")
                tag = self._typed(f"{path}.tag", kind.tag.name)
                return {"kind": "variant", "tag": tag, "options": self._members(kind.options, path)}

    def _typed(self, path: str, filter_type: str) -> str:
        """Notes the type of a display filter, and returns it."""
        self.types[path] = filter_type
        return filter_type

    def _members(self, fields: Iterable[wire.Field], path: str) -> list[Table]:
        scope = Scope(_TAKEN)
        return [
            self._field(field, f"{path}.{scope.claim(filter_word(field.name))}") for field in fields
        ]

    # -- values ----------------------------------------------------------------------------------

    def _number(self, kind: wire.Number, path: str) -> Table:
        table: Table = {"kind": "number", "type": kind.type.name}
        if isinstance(kind, wire.Scaled):
            table["scale"] = [kind.lower, kind.step]
        if isinstance(kind, wire.Integer) and kind.legal.offset:
            table["offset"] = kind.legal.offset
        is_raw = "scale" in table or "offset" in table
        if is_raw:
            self._typed(f"{path}.raw", kind.type.name)
        self._typed(path, "double" if is_raw else kind.type.name)
        if kind.units:
            table["units"] = label(kind.units)
        if isinstance(kind, wire.Integer):
            table.update(_names(kind.legal, kind.legal.names, as_table=is_raw))
        return table

    def _bits(self, kind: wire.BitField, path: str) -> Table:
        self._typed(path, kind.type.name)
        scope = Scope(_TAKEN)
        parts = []
        for group in kind.groups:
            word = f"{path}.{scope.claim(filter_word(group.name))}"
            self._typed(word, kind.type.name)
            place = {"low": group.low, "high": group.high}
            head = {"name": label(group.name), "filter": word, **place}
            offset = group.legal.offset
            on_wire = {value - offset: name for value, name in group.legal.names.items()}
            counted = {"offset": offset} if offset else {}
            parts.append({**head, **counted, **_names(group.legal, on_wire)})
        return {"kind": "bits", "type": kind.type.name, "parts": parts}

    def _bytes(self, kind: wire.Octets, path: str) -> Table:
        self._typed(path, "bytes")
        is_message = {"is_message": True} if kind.holds_message else {}
        count = self._typed(f"{path}.length", kind.count.type.name)
        return {"kind": "bytes", "count": count, **is_message}

    def _formatted(self, kind: wire.FormattedOctets, path: str) -> Table:
        self._typed(f"{path}.format", "uint8")
        self._typed(path, "bytes")
        formats = {data_format.index: label(data_format.name) for data_format in kind.formats}
        count = self._typed(f"{path}.length", kind.count.type.name)
        return {"kind": "bytes", "formats": dict(sorted(formats.items())), "count": count}

    def _choice(self, kind: wire.VariableNumber, path: str) -> Table:
        self._typed(path, "none")
        self._typed(f"{path}.index", "uint8")
        scope = Scope(_TAKEN)
        options: Table = {}
        for alternative in sorted(kind.alternatives, key=lambda option: option.index):
            word = f"{path}.{scope.claim(filter_word(alternative.name))}"
            head = {"name": label(alternative.name), "filter": word}
            options[alternative.index] = {**head, **self._number(alternative.number, word)}
        return {"kind": "choice", "options": options}

    def _record(self, kind: wire.Record, path: str) -> Table:
        self._typed(path, "none")
        table: Table = {"kind": "record"}
        if kind.presence is not None:
            table["presence"] = self._typed(f"{path}.presence", kind.presence.name)
        return {**table, "fields": self._members(kind.members, path)}


def _names(legal: wire.LegalIntegers, names: Mapping[int, str], *, as_table: bool = False) -> Table:
    """Returns the named integers of a value set.

    Args:
        as_table: Whether the display filter cannot hold the names.

    Returns:
        The `names` that the display filter holds, which is when no others are legal; else
        `some_names`.
    """
    named = {number: label(name) for number, name in names.items() if abs(number) < _EXACT}
    if not named:
        return {}
    key = "names" if legal.is_closed and not as_table else "some_names"
    return {key: dict(sorted(named.items()))}


def tasks(model: Model) -> list[Task]:
    """Returns the one file, for the messages that the system can send or receive."""
    return _dissector(model, used_services(model))


def whole_library_tasks(model: Model) -> list[Task]:
    """Returns the one file, for every message of the shipped library and of the system."""
    return _dissector(model, [*used_services(model), *library_services()])


def _dissector(model: Model, services: Sequence[jaus.Service]) -> list[Task]:
    view = DissectorView(system_of(model), source_of(model), services)
    return [FileTask("dissector.lua.j2", [view], lambda view: view.path)]


TARGET = Target(
    name="wireshark",
    description="A Wireshark dissector in Lua for the messages of the system.",
    tasks=tasks,
    template_folders=(templates_beside(__file__),),
    is_on_request=True,
    whole_library=WholeLibrary(
        help="every message of the library, not only those of the system", tasks=whole_library_tasks
    ),
)
"""A dissector for JAUS over UDP and TCP (AS5669A) and the bodies of messages (AS5684)."""
