"""Values of JAUS messages by path: texts to a payload, and a payload to texts."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from datetime import datetime, timezone
from typing import Any

from jausml.authoring.proposals.elements import AnswerError
from jausml.language import wire
from jausml.language.metamodel.classes import jaus
from jausml.language.semantics.jaus.fields import is_group
from jausml.live.messages import MessageEntry, MessageError
from jausml.live.messages.catalogue import as_it_is
from jausml.live.messages.codec import TAG
from jausml.live.messages.defined import defined_message
from jausml.live.messages.text import sample
from jausml.live.peers.rendering import field_texts

_STEP = re.compile(r"(.+?)((?:\[\d{1,4}\])*)")
_TIME = ("Milliseconds", "Seconds", "Minutes", "Hour", "Day")
"""The members of a TimeStamp (AS5710, ReportTime)."""


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
        fields: Any = sample(entry.record)
        kind, value = _body(message, entry, fields)
        for path, text in values.items():
            _put(kind, value, path.split("."), text, path)
        return entry.encode(fields)
    except MessageError as error:
        raise AnswerError(str(error)) from error


def rows(message: jaus.MessageDef, data: bytes) -> list[tuple[str, str]]:
    """Returns path and text of each value of a message, texts with their units.

    Raises:
        AnswerError: `data`, code and body, is no such message.
    """
    entry = _entry(message)
    try:
        return list(field_texts(entry.record, entry.decode(data)))
    except MessageError as error:
        raise AnswerError(str(error)) from error


def moment(text: str) -> datetime:
    """Returns the time in UTC of a text: `now` or nothing, or a date and time of ISO 8601.

    Raises:
        AnswerError: It is another text, or no time of the years 1 to 9999.
    """
    if text.strip().lower() in ("", "now"):
        return datetime.now(timezone.utc)
    try:
        instant = datetime.fromisoformat(text.strip().replace("Z", "+00:00"))
        if instant.tzinfo is None:
            return instant.replace(tzinfo=timezone.utc)
        return instant.astimezone(timezone.utc)
    except (ValueError, OverflowError) as error:
        raise AnswerError(f"{text!r} is no time such as 2026-05-17T12:30:15.250") from error


def _entry(message: jaus.MessageDef) -> MessageEntry:
    return defined_message(message, _no_message, as_it_is)


def _no_message(_: Any, /) -> bytes:
    raise MessageError("a message inside a message cannot be typed here")


def _body(message: jaus.MessageDef, entry: MessageEntry, fields: Any) -> tuple[wire.Record, Any]:
    """Returns the start of all paths: the top record, or the one body field."""
    if is_group(wire.target_of(message.body)):
        [member] = entry.record.members
        if isinstance(member.kind, wire.Record):
            return member.kind, fields[member.name]
    return entry.record, fields


def _put(kind: wire.Kind, value: Any, steps: Sequence[str], text: str, path: str) -> None:
    """Gives a member of a record a value; optional ones and elements on the way come to be."""
    (name, indices), rest = _split(steps[0]), steps[1:]
    member = _member(kind, name)
    if member is None:
        raise AnswerError(f"there is no member {path}")
    # A bit field has all of its members from the beginning.
    if name not in value and not isinstance(member, wire.Bits):
        if isinstance(kind, wire.Variant):
            value.clear()
            value[TAG] = [option.name for option in kind.options].index(name)
        value[name] = sample(member)
    inner, at = member, value
    key: Any = name
    for index in indices:
        if not isinstance(inner, wire.List | wire.Array):
            raise AnswerError(f"{path}: {name} is no list")
        at, key, inner = at[key], index, inner.element.kind
        while isinstance(at, list) and len(at) <= index:
            at.append(sample(inner))
    if rest and isinstance(inner, wire.Record | wire.Variant | wire.BitField):
        _put(inner, at[key], rest, text, path)
    elif len(rest) == 1 and isinstance(inner, wire.VariableNumber):
        at[key] = _variable(inner, rest[0], text, path)
    elif rest:
        raise AnswerError(f"there is no member {path}")
    else:
        at[key] = _value(inner, text, path)


def _member(kind: wire.Kind, name: str) -> wire.Kind | wire.Bits | None:
    match kind:
        case wire.Record():
            return next((member.kind for member in kind.members if member.name == name), None)
        case wire.Variant():
            return next((option.kind for option in kind.options if option.name == name), None)
        case wire.BitField():
            return next((group for group in kind.groups if group.name == name), None)
        case _:
            return None


def _variable(kind: wire.VariableNumber, name: str, text: str, path: str) -> dict[str, Any]:
    for alternative in kind.alternatives:
        if name in (alternative.name, str(alternative.index)):
            number = _value(alternative.number, text, path)
            return {"index": alternative.index, "value": number}
    raise AnswerError(f"there is no member {path}")


def _value(kind: wire.Kind | wire.Bits, text: str, path: str) -> Any:
    match kind:
        case wire.BitField():
            return _time(kind, text, path)
        case wire.Text() | wire.FixedText():
            return text
        case wire.Octets() | wire.FormattedOctets():
            return {"hex": text}
        case wire.Scaled() | wire.Real():
            try:
                return float(text)
            except ValueError as error:
                raise AnswerError(f"{path}: {text!r} is no number") from error
        case wire.Record() | wire.List() | wire.Array() | wire.Variant():
            raise AnswerError(f"{path}: give its members values")
        case _:
            return _integer(text)


def _integer(text: str) -> int | str:
    """Returns an integer, or the name of one."""
    try:
        return int(text, 0)
    except ValueError:
        return text


def _time(kind: wire.BitField, text: str, path: str) -> dict[str, int]:
    if {group.name for group in kind.groups} != set(_TIME):
        raise AnswerError(f"{path}: give its bits values")
    at = moment(text)
    values = (at.microsecond // 1000, at.second, at.minute, at.hour, at.day)
    return dict(zip(_TIME, values, strict=True))


def _split(step: str) -> tuple[str, list[int]]:
    """Returns the name of a step such as `Rows[2][0]`, and its indices."""
    match = _STEP.fullmatch(step)
    if match is None:
        return step, []
    return match[1], [int(occurrence) for occurrence in re.findall(r"\d+", match[2])]
