"""Fields of a message in words: their paths, values, names of values and units."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jausml.language import wire
from jausml.live.messages.codec import TAG

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.live.messages import MessageEntry

_SYMBOLS = {
    "ampere": "A",
    "coulomb": "C",
    "cubic meter": "m3",
    "degree": "deg",
    "degree Celsius": "°C",
    "hertz": "Hz",
    "hour": "h",
    "kilogram": "kg",
    "liter": "l",
    "meter": "m",
    "meter per second": "m/s",
    "meter per second squared": "m/s2",
    "minute": "min",
    "newton": "N",
    "newton meter": "N m",
    "one": "",
    "percent": "%",
    "radian": "rad",
    "radian per second": "rad/s",
    "radian per second squared": "rad/s2",
    "second": "s",
    "volt": "V",
}
"""Symbols of the units of the library; others are shown as they are written."""


_CLOCK = {"Hour", "Minutes", "Seconds", "Milliseconds"}
"""Bits of a TimeStamp (AS5710, ReportTime; AS6009)."""


def shown_fields(entry: MessageEntry, fields: dict[str, Any]) -> str:
    """Returns the fields of a message on one line, e.g. `Velocity_X=1.25 m/s YawRate=0 rad/s`.

    Args:
        entry: The message.
        fields: Its fields as decoded.
    """
    pairs = list(field_texts(entry.record, fields))
    return "  ".join(f"{path}={text}" for path, text in pairs) or "(no fields)"


def field_texts(kind: wire.Kind, value: Any, path: str = "") -> Iterator[tuple[str, str]]:
    """Yields the path and the text of each value; the outermost record is not named.

    Args:
        kind: The kind of the field.
        value: Its decoded value.
        path: Path of the field.
    """
    match kind:
        case wire.Record():
            yield from _record_texts(kind, value, path)
        case wire.List() | wire.Array():
            if not value:
                yield path, "[]"
            for index, item in enumerate(value):
                yield from field_texts(kind.element.kind, item, f"{path}[{index}]")
        case wire.Variant(options=()):
            yield _joined(path, TAG), str(value[TAG])
        case wire.Variant():
            option = kind.options[value[TAG]]
            yield from field_texts(option.kind, value[option.name], _joined(path, option.name))
        case wire.BitField() if value.keys() >= _CLOCK:
            yield path, _clock(value)
        case wire.BitField():
            for group in kind.groups:
                number = value[group.name]
                name = group.legal.names.get(number, "")
                yield _joined(path, group.name), _named(number, name)
        case _:
            yield path, _leaf(kind, value)


def _record_texts(kind: wire.Record, value: dict[str, Any], path: str) -> Iterator[tuple[str, str]]:
    outermost = len(kind.members) == 1 and not path
    for member in kind.members:
        if member.name in value:
            step = "" if outermost and isinstance(member.kind, wire.Record) else member.name
            yield from field_texts(member.kind, value[member.name], _joined(path, step))


def _clock(value: dict[str, int]) -> str:
    day = f"day {value['Day']} " if "Day" in value else ""
    seconds = f"{value['Seconds']:02}.{value['Milliseconds']:03}"
    return f"{day}{value['Hour']:02}:{value['Minutes']:02}:{seconds}"


def _leaf(kind: wire.Leaf, value: Any) -> str:
    match kind:
        case wire.VariableNumber():
            return _leaf(kind.by_index[value["index"]], value["value"])
        case wire.Integer():
            return _with_unit(_named(value, kind.legal.names.get(value, "")), kind.units)
        case wire.Scaled():
            # No more digits than the step of the scale carries.
            return _with_unit(_rounded(value, kind.step), kind.units)
        case wire.Real():
            return _with_unit(f"{value:.7g}", kind.units)
        case wire.Octets() | wire.FormattedOctets():
            return str(value["hex"])
        case _:
            return repr(value)


def _joined(path: str, step: str) -> str:
    return f"{path}.{step}" if path and step else path or step


def _named(number: Any, name: str) -> str:
    return f"{number} ({name})" if name else str(number)


def _rounded(value: float, step: float) -> str:
    digits = 0
    while digits < 9 and step * 10**digits < 1:
        digits += 1
    return f"{value:.{digits}f}" if abs(round(value, digits)) > 0 else "0"


def _with_unit(text: str, unit: str) -> str:
    symbol = _SYMBOLS.get(unit, unit)
    return f"{text} {symbol}" if symbol else text
