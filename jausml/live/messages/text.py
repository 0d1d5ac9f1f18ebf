"""Messages for people: one line for each field, with units and the names of values."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from jausml.live.messages.blobs import MESSAGE, FormattedOctets, Octets, VariableNumber
from jausml.live.messages.codec import Scalar
from jausml.live.messages.containers import TAG, Array, List, Record, Variant
from jausml.live.messages.scalars import BitField, Integer, Real, Scaled

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from jausml.live.messages.codec import Codec
    from jausml.live.messages.embedded import DecodedMessage

_INDENT = "  "
_SHOWN_OCTETS = 32
_SHOWN_ELEMENTS = 64


def title(decoded: DecodedMessage) -> str:
    """Returns the first line of a message: its name, code and service.

    Args:
        decoded: The message.
    """
    return f"{decoded.entry.name} {decoded.entry.code_text} ({decoded.service.label})"


def lines(decoded: DecodedMessage) -> Iterator[str]:
    """Yields the fields of a message, indented by depth.

    Args:
        decoded: The message.
    """
    writer = _Writer(decoded)
    for member in decoded.entry.codec.members:
        yield from writer.field(member.name, member.codec, decoded.fields[member.name], "")


class _Writer:
    """Writes the fields of one message, and between them the messages that stand in it."""

    def __init__(self, decoded: DecodedMessage) -> None:
        self._embedded = iter(decoded.embedded)

    def field(self, name: str, codec: Codec, value: Any, indent: str) -> Iterator[str]:
        if isinstance(codec, Record):
            yield f"{indent}{name}"
            for member in codec.members:
                if member.name in value:
                    part = value[member.name]
                    yield from self.field(member.name, member.codec, part, indent + _INDENT)
        elif isinstance(codec, (List, Array)):
            yield from self._elements(name, codec, value, indent)
        elif isinstance(codec, Variant):
            yield f"{indent}{name}: {value[TAG]}"
            if codec.options:
                option, inner = codec.options[value[TAG]]
                yield from self.field(option, inner, value[option], indent + _INDENT)
        elif isinstance(codec, (Octets, FormattedOctets)):
            yield f"{indent}{name}: {_octets(codec, value)}"
            if _holds_message(codec, value):
                yield from self._message(indent + _INDENT)
        else:
            yield f"{indent}{name}: {simple(codec, value)}"

    def _elements(
        self, name: str, codec: List | Array, value: Sequence[Any], indent: str
    ) -> Iterator[str]:
        head = f"{indent}{name}[{len(value)}]"
        if isinstance(codec.element, Scalar) and not isinstance(codec.element, BitField):
            shown = ", ".join(simple(codec.element, item) for item in value[:_SHOWN_ELEMENTS])
            yield f"{head}: {shown}" + (", ..." if len(value) > _SHOWN_ELEMENTS else "")
            return
        yield head
        for index, item in enumerate(value):
            yield from self.field(f"[{index}]", codec.element, item, indent + _INDENT)

    def _message(self, indent: str) -> Iterator[str]:
        """Yields the message of the next field that holds one."""
        found = next(self._embedded, None)
        if found is None:
            return
        if found.message is None:
            yield f"{indent}{MESSAGE}: {found.error}"
            return
        yield f"{indent}{title(found.message)}"
        yield from (f"{indent}{_INDENT}{line}" for line in lines(found.message))


def simple(codec: Codec, value: Any) -> str:
    """Returns a value that has no fields inside, with its unit or its name.

    Args:
        codec: The codec of the field.
        value: Its decoded value.
    """
    if isinstance(codec, Integer):
        return f"{value}{_named(codec.names, value)}{_unit(codec.units)}"
    if isinstance(codec, Scaled):
        decimals = max(0, 1 - math.floor(math.log10(codec.step)))
        return f"{value:.{decimals}f}{_unit(codec.units)}"
    if isinstance(codec, Real):
        return f"{value!r}{_unit(codec.units)}"
    if isinstance(codec, BitField):
        groups = ((each.name, value[each.name], each.names) for each in codec.groups)
        return ", ".join(
            f"{name} {number}{_named(names, number)}" for name, number, names in groups
        )
    if isinstance(codec, VariableNumber):
        return simple(codec.alternatives[value["index"]], value["value"])
    # What a terminal would obey instead of showing it is escaped.
    return f'"{value if value.isprintable() else ascii(value)[1:-1]}"'


def _named(names: Mapping[int, str], value: int) -> str:
    return f" ({names[value]})" if value in names else ""


def _unit(units: str) -> str:
    return f" {units}" if units and units != "one" else ""


def _holds_message(codec: Octets | FormattedOctets, value: Mapping[str, Any]) -> bool:
    if isinstance(codec, Octets):
        return codec.holds_message
    return codec.holds_message(value["format"])


def _octets(codec: Octets | FormattedOctets, value: Mapping[str, Any]) -> str:
    if isinstance(codec, Octets):
        name = codec.content
    else:
        name = codec.formats.get(value["format"], f"format {value['format']}")
    digits: str = value["hex"]
    shown = digits[: 2 * _SHOWN_OCTETS] + ("..." if len(digits) > 2 * _SHOWN_OCTETS else "")
    return f"{len(digits) // 2} bytes of {name} {shown}".rstrip()
