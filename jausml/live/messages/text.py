"""Messages for people: one line for each field, with units and the names of values."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, SupportsInt

from jausml.language import wire
from jausml.live.messages.codec import TAG
from jausml.live.messages.counted import MESSAGE

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from jausml.live.messages.entries import DecodedMessage, EmbeddedMessage

_INDENT = "  "
_SHOWN_OCTETS = 32
_SHOWN_ELEMENTS = 64


def title(decoded: DecodedMessage) -> str:
    """Returns the first line of a message: its name, code and service."""
    return f"{decoded.entry.name} {decoded.entry.code_text} ({decoded.service.label})"


def lines(decoded: DecodedMessage) -> Iterator[str]:
    """Yields the fields of a message, indented by depth."""
    for member in decoded.entry.record.members:
        yield from _field(member.name, member.kind, decoded.fields[member.name], "")


def _field(name: str, kind: wire.Kind, value: Any, indent: str) -> Iterator[str]:
    match kind:
        case wire.Record():
            yield f"{indent}{name}"
            for member in kind.members:
                if member.name in value:
                    part = value[member.name]
                    yield from _field(member.name, member.kind, part, indent + _INDENT)
        case wire.List() | wire.Array():
            yield from _elements(name, kind.element.kind, value, indent)
        case wire.Variant():
            yield f"{indent}{name}: {value[TAG]}"
            if kind.options:
                option = kind.options[value[TAG]]
                part = value[option.name]
                yield from _field(option.name, option.kind, part, indent + _INDENT)
        case wire.Octets() | wire.FormattedOctets():
            yield f"{indent}{name}: {_octets(kind, value)}"
            yield from _message(value.get(MESSAGE), indent + _INDENT)
        case _:
            yield f"{indent}{name}: {simple(kind, value)}"


def _elements(name: str, kind: wire.Kind, value: Sequence[Any], indent: str) -> Iterator[str]:
    head = f"{indent}{name}[{len(value)}]"
    if isinstance(kind, wire.Number | wire.FixedText):
        shown = ", ".join(simple(kind, item) for item in value[:_SHOWN_ELEMENTS])
        yield f"{head}: {shown}" + (", ..." if len(value) > _SHOWN_ELEMENTS else "")
        return
    yield head
    for index, item in enumerate(value):
        yield from _field(f"[{index}]", kind, item, indent + _INDENT)


def _message(embedded: EmbeddedMessage | None, indent: str) -> Iterator[str]:
    """Yields the message that stands in a field."""
    if embedded is None:
        return
    if embedded.decoded is None:
        yield f"{indent}{MESSAGE}: {embedded['error']}"
        return
    yield f"{indent}{title(embedded.decoded)}"
    yield from (f"{indent}{_INDENT}{line}" for line in lines(embedded.decoded))


def simple(kind: wire.Scalar | wire.Text | wire.VariableNumber, value: Any) -> str:
    """Returns a decoded value that has no fields inside, with its unit or its name."""
    match kind:
        case wire.Integer():
            return f"{named(kind.legal, value)}{_unit(kind.units)}"
        case wire.Scaled():
            decimals = max(0, 1 - math.floor(math.log10(kind.step)))
            return f"{value:.{decimals}f}{_unit(kind.units)}"
        case wire.Real():
            return f"{value!r}{_unit(kind.units)}"
        case wire.BitField():
            return ", ".join(
                f"{each.name} {named(each.legal, value[each.name])}" for each in kind.groups
            )
        case wire.VariableNumber():
            return simple(kind.by_index[value["index"]], value["value"])
        case wire.Text() | wire.FixedText():
            # What a terminal would obey instead of showing it is escaped.
            return f'"{value if value.isprintable() else ascii(value)[1:-1]}"'


def named(legal: wire.LegalIntegers, value: SupportsInt) -> str:
    """Returns an integer with its name, if it has one, e.g. `1 (READY)`."""
    number = int(value)
    return f"{number} ({legal.names[number]})" if number in legal.names else str(number)


def _unit(units: str) -> str:
    return f" {units}" if units and units != "one" else ""


def _octets(kind: wire.Octets | wire.FormattedOctets, value: Mapping[str, Any]) -> str:
    if isinstance(kind, wire.Octets):
        name = kind.content
    else:
        name = kind.names.get(int(value["format"]), f"format {value['format']}")
    digits: str | None = value.get("hex")
    if digits is None:
        return name
    shown = digits[: 2 * _SHOWN_OCTETS] + ("..." if len(digits) > 2 * _SHOWN_OCTETS else "")
    return f"{len(digits) // 2} bytes of {name} {shown}".rstrip()
