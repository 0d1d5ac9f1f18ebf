"""Values of JAUS messages by path: texts to a payload, and a payload to texts."""

from __future__ import annotations

import re
from datetime import datetime, timezone
from typing import TYPE_CHECKING, Any

from jausml.authoring.proposals.elements import AnswerError
from jausml.language import wire
from jausml.language.semantics.layouts import is_group
from jausml.live.messages import MessageEntry, MessageError
from jausml.live.messages.blobs import FormattedOctets, Octets, Text, VariableNumber
from jausml.live.messages.codec import Scalar
from jausml.live.messages.containers import TAG, Array, List, Record, Variant
from jausml.live.messages.samples import sample
from jausml.live.messages.scalars import BitField, FixedText, Real, Scaled

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from jausml.language.metamodel.classes import jaus
    from jausml.live.messages.codec import Codec

_STEP = re.compile(r"(.+?)((?:\[\d{1,4}\])*)")
_PRESENCE = "_pv"
_TIME = ("Milliseconds", "Seconds", "Minutes", "Hour", "Day")
_SHOWN = 8


def payload(message: jaus.MessageDef, values: Mapping[str, str]) -> bytes:
    """Returns code and body of a message.

    Args:
        values: Texts by path, as maps write paths; what is not among them is left out where it may
            be, and has its least legal value elsewhere.

    Raises:
        AnswerError: A text is no legal value, or a path leads nowhere.
    """
    entry = _entry(message)
    try:
        fields: Any = sample(entry.codec)
        for path, text in values.items():
            codec, value = _body(message, entry, fields)
            _put(codec, value, path.split("."), text, path)
        return entry.encode(fields)
    except MessageError as error:
        raise AnswerError(str(error)) from error


def rows(message: jaus.MessageDef, data: bytes) -> list[tuple[str, str]]:
    """Returns the values of a message by path."""
    entry = _entry(message)
    try:
        fields = entry.decode(data)
    except MessageError as error:
        raise AnswerError(str(error)) from error
    codec, value = _body(message, entry, fields)
    return list(_rows(codec, value, ""))


def moment(text: str) -> datetime:
    """Returns the time that a text says: `now`, or a date and time of ISO 8601, in UTC."""
    if text.strip().lower() in ("", "now"):
        return datetime.now(timezone.utc)
    try:
        found = datetime.fromisoformat(text.strip().replace("Z", "+00:00"))
    except ValueError as error:
        raise AnswerError(f"{text!a} is no time such as 2026-05-17T12:30:15.250") from error
    return found if found.tzinfo is not None else found.replace(tzinfo=timezone.utc)


def _entry(message: jaus.MessageDef) -> MessageEntry:
    return MessageEntry(message, _no_message)


def _no_message(_: Any, /) -> bytes:
    raise MessageError("a message inside a message cannot be typed here")


def _body(message: jaus.MessageDef, entry: MessageEntry, fields: Any) -> tuple[Record, Any]:
    """Returns what paths start in: the top record, or the one body field."""
    if is_group(wire.target_of(message.body)):
        [member] = entry.codec.members
        if isinstance(member.codec, Record):
            return member.codec, fields[member.name]
    return entry.codec, fields


def _put(codec: Codec, value: Any, steps: Sequence[str], text: str, path: str) -> None:
    """Gives a member of a record a value; optional ones and elements on the way come to be."""
    name, indices = _split(steps[0])
    member = _member(codec, name)
    if member is None:
        raise AnswerError(f"there is no member {path}")
    if name not in value:
        _choose(codec, value, name)
        value[name] = sample(member)
    inner, at = member, value
    key: Any = name
    for index in indices:
        if not isinstance(inner, List | Array):
            raise AnswerError(f"{path}: {name} is no list")
        at, key, inner = at[key], index, inner.element
        while isinstance(at, list) and len(at) <= index:
            at.append(sample(inner))
    if steps[1:] and isinstance(inner, Record | Variant | BitField):
        _put(inner, at[key], steps[1:], text, path)
    elif steps[1:] and isinstance(inner, VariableNumber):
        at[key] = _variable(inner, steps[1], text, path)
    else:
        at[key] = _value(inner, text, path)


def _member(codec: Codec, name: str) -> Any:
    """Returns the codec of a member, itself for a group of bits."""
    if isinstance(codec, Record):
        return next((each.codec for each in codec.members if each.name == name), None)
    if isinstance(codec, Variant):
        return next((inner for option, inner in codec.options if option == name), None)
    if isinstance(codec, BitField):
        return next((each for each in codec.groups if each.name == name), None)
    return None


def _choose(codec: Codec, value: Any, name: str) -> None:
    if isinstance(codec, Variant):
        value.clear()
        value[TAG] = [option for option, _ in codec.options].index(name)


def _variable(codec: VariableNumber, name: str, text: str, path: str) -> dict[str, Any]:
    try:
        index = int(name)
    except ValueError:
        index = min(codec.alternatives)
    return {"index": index, "value": _value(codec.alternatives[index], text, path)}


def _value(codec: Any, text: str, path: str) -> Any:
    if isinstance(codec, BitField):
        return _time(codec, text, path)
    if isinstance(codec, Text | FixedText):
        return text
    if isinstance(codec, Octets | FormattedOctets):
        return {"hex": text}
    if isinstance(codec, Scaled | Real):
        try:
            return float(text)
        except ValueError as error:
            raise AnswerError(f"{path}: {text!a} is no number") from error
    if isinstance(codec, Record | List | Array | Variant):
        raise AnswerError(f"{path}: give its members values")
    try:
        return int(text, 0)
    except ValueError:
        return text  # the name of a value


def _time(codec: BitField, text: str, path: str) -> dict[str, int]:
    if {each.name for each in codec.groups} != set(_TIME):
        raise AnswerError(f"{path}: give its bits values")
    at = moment(text)
    values = (at.microsecond // 1000, at.second, at.minute, at.hour, at.day)
    return dict(zip(_TIME, values, strict=True))


def _split(step: str) -> tuple[str, list[int]]:
    match = _STEP.fullmatch(step)
    if match is None:
        return step, []
    return match[1], [int(each) for each in re.findall(r"\d+", match[2])]


def _rows(codec: Codec, value: Any, before: str) -> Iterator[tuple[str, str]]:
    """Yields the values below a place; of long lists the first."""
    for step, inner, part in _parts(codec, value):
        yield from _rows(inner, part, f"{before}{step}" if before else step.lstrip("."))
    match codec:
        case List() | Array() if len(value) > _SHOWN:
            yield before, f"... ({len(value)} elements)"
        case BitField():
            yield from _bits(codec, value, before)
        case VariableNumber():
            yield before, _text(value["value"])
        case Octets() | FormattedOctets():
            yield before, str(value["hex"])
        case Scalar() | Text():
            yield before, _named(value, getattr(codec, "names", {}))


def _parts(codec: Codec, value: Any) -> Iterator[tuple[str, Codec, Any]]:
    """Yields what a value consists of: step of the path, codec and value."""
    match codec:
        case Record():
            for member in codec.members:
                if member.name in value:
                    yield f".{member.name}", member.codec, value[member.name]
        case Variant():
            for option, inner in codec.options:
                if option in value:
                    yield f".{option}", inner, value[option]
        case List() | Array():
            for index, each in enumerate(value[:_SHOWN]):
                yield f"[{index}]", codec.element, each


def _bits(codec: BitField, value: Mapping[str, int], before: str) -> Iterator[tuple[str, str]]:
    if {each.name for each in codec.groups} == set(_TIME):
        clock = f"{value['Hour']:02}:{value['Minutes']:02}:{value['Seconds']:02}"
        yield before, f"day {value['Day']}, {clock}.{value['Milliseconds']:03}"
        return
    for each in codec.groups:
        yield f"{before}.{each.name}", _named(value[each.name], each.names)


def _named(value: Any, names: Mapping[int, str]) -> str:
    name = names.get(value, "") if isinstance(value, int) else ""
    return f"{value} {name}" if name else _text(value)


def _text(value: Any) -> str:
    return f"{value:.9g}" if isinstance(value, float) else str(value)
