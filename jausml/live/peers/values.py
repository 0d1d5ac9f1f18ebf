"""Fields of a message in words: their paths, values, names of values and units."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jausml.live.messages.blobs import VariableNumber
from jausml.live.messages.containers import TAG, Array, List, Record, Variant
from jausml.live.messages.scalars import BitField, Integer, Real, Scaled

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.live.messages import MessageEntry
    from jausml.live.messages.codec import Codec

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
    """Returns the fields of a message on one line, e.g. `Velocity_X=1.25 m/s YawRate=0 rad/s`."""
    pairs = list(field_texts(entry.codec, fields))
    return "  ".join(f"{path}={text}" for path, text in pairs) or "(no fields)"


def field_texts(codec: Codec, value: Any, path: str = "") -> Iterator[tuple[str, str]]:
    """Yields the path and the text of each value; the outermost record is not named."""
    if isinstance(codec, Record):
        yield from _record_texts(codec, value, path)
    elif isinstance(codec, List | Array):
        if not value:
            yield path, "[]"
        for index, item in enumerate(value):
            yield from field_texts(codec.element, item, f"{path}[{index}]")
    elif isinstance(codec, Variant):
        if not codec.options:
            yield _joined(path, TAG), str(value[TAG])
            return
        name, inner = codec.options[value[TAG]]
        yield from field_texts(inner, value[name], _joined(path, name))
    elif isinstance(codec, BitField) and value.keys() >= _CLOCK:
        yield path, _clock(value)
    elif isinstance(codec, BitField):
        for group in codec.groups:
            number = value[group.name]
            yield _joined(path, group.name), _named(number, group.names.get(number, ""))
    else:
        yield path, _leaf(codec, value)


def _record_texts(codec: Record, value: dict[str, Any], path: str) -> Iterator[tuple[str, str]]:
    outermost = len(codec.members) == 1 and not path
    for name, inner, _ in codec.members:
        if name in value:
            step = "" if outermost and isinstance(inner, Record) else name
            yield from field_texts(inner, value[name], _joined(path, step))


def _clock(value: dict[str, int]) -> str:
    day = f"day {value['Day']} " if "Day" in value else ""
    seconds = f"{value['Seconds']:02}.{value['Milliseconds']:03}"
    return f"{day}{value['Hour']:02}:{value['Minutes']:02}:{seconds}"


def _leaf(codec: Codec, value: Any) -> str:
    if isinstance(codec, VariableNumber):
        return _leaf(codec.alternatives[value["index"]], value["value"])
    if isinstance(codec, Integer):
        return _with_unit(_named(value, codec.names.get(value, "")), codec.units)
    if isinstance(codec, Scaled):
        # No more digits than the step of the scale carries.
        return _with_unit(_rounded(value, codec.step), codec.units)
    if isinstance(codec, Real):
        return _with_unit(f"{value:.7g}", codec.units)
    if isinstance(value, dict):
        return str(value.get("hex", value))
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
