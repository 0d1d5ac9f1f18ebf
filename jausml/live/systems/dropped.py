"""Which message a connection did not pass on: what its translation makes of each is looked for.

The time of a message decides only where that does not.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import islice, pairwise
from math import inf
from typing import TYPE_CHECKING, Any

from jausml.language.semantics.jaus.services import code
from jausml.live.messages import Catalogue, MessageError
from jausml.live.messages.entries import as_it_is
from jausml.live.recording.mcap_files import RecordingError
from jausml.live.recording.mcap_reading import definition_in
from jausml.live.recording.passing import UNKNOWN, Given, Made, RecordedTranslation, Taken, passed
from jausml.live.recording.recorded_types import RecordedTypes
from jausml.live.recording.seeking import JAUS_TOPICS
from jausml.live.systems.recorded_calls import events_of, failed_call, kind_of, part_of
from jausml.live.systems.ways import topics_of_joins

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.language.metamodel.classes import bridge
    from jausml.language.model import Model
    from jausml.live.messages import MessageEntry
    from jausml.live.recording.mcap_files import Found
    from jausml.live.systems.playback import Mark, RecordedSystem
    from jausml.live.systems.recorded_calls import CallEnd, RecordedCall
    from jausml.live.systems.state import ConnectionState
    from jausml.live.systems.ways import Ways

NEAR = 0.005
"""Seconds by which times of the two sides may differ: each has a thread that reads."""

AROUND = 1.0
"""Seconds before and after a drop in which both sides are compared."""

MOST_COMPARED = 5_000
"""Messages of one side that are compared."""

NOT_TRANSLATED = "not_translated"
"""How a call is counted of which a half could not be translated, for whatever reason."""

_OF_SEVERAL = "several messages became the same"
_NOT_KNOWN = "what it becomes is not known here"
_TOO_MANY = "too many messages came to compare them"


@dataclass(frozen=True)
class Dropped:
    """A message that was not passed on.

    Attributes:
        reason: Why its translation refused it; empty where it did not.
        guess: Why only its time tells that it was this one; empty where its content does.
        call: The call that failed, with the end that it was recorded at.
    """

    time: float
    reason: str = ""
    guess: str = ""
    call: tuple[CallEnd, RecordedCall] | None = None


@dataclass(frozen=True)
class _Source:
    time: float
    made: Made
    is_passed: bool | None


def dropped_message(
    system: RecordedSystem,
    model: Model,
    connection: ConnectionState,
    several: Sequence[Ways],
    risen: Sequence[Mark],
) -> tuple[Ways, Dropped | None]:
    """Returns the first message that was not passed on, as counters rose; None if nobody knows.

    Args:
        several: The ways of the connection; that of the message is returned, else the first.
    """
    requests = several[0]
    for end in requests.calls:
        call = failed_call(system, end, risen)
        if call is not None:
            return requests, Dropped(call.asked, call=(end, call))
    for ways in several:
        found = _dropped_on(system, model, connection, ways, risen)
        if found is not None:
            return ways, found
    return requests, None


def _dropped_on(
    system: RecordedSystem,
    model: Model,
    connection: ConnectionState,
    ways: Ways,
    risen: Sequence[Mark],
) -> Dropped | None:
    since, time, count = risen[0].since, risen[0].time, sum(each.count for each in risen)
    try:
        sources, given = _compared(system, model, connection, ways, since, time)
    except RecordingError as error:
        if ways.missing:
            return None  # a time alone would tell nothing
        sources = [_Source(at, UNKNOWN, None) for at in times(system, ways, since, time)]
        found = events_of(system, ways.target, since - NEAR, time + NEAR, ways.events_of_target)
        given, why = sorted(at for at, _ in found), str(error)
    else:
        why = _NOT_KNOWN if any(each.made is UNKNOWN for each in sources) else _OF_SEVERAL
    counters = {each.counter for each in risen}
    refused = [
        each
        for each in sources
        if each.made.counter in counters or (each.made.counter and NOT_TRANSLATED in counters)
    ]
    if refused:  # a status on its way may come after the next message
        first = min(refused, key=lambda each: (not since < each.time <= time, each.time))
        return Dropped(first.time, reason=first.made.reason or first.made.counter)
    if ways.missing:
        return None
    lost = [
        each
        for each in sources
        if since < each.time <= time and not each.is_passed and not each.made.counter
    ]
    if len(lost) == count and all(each.is_passed is False for each in lost):
        return Dropped(lost[0].time)
    alone = [
        begin
        for begin, end in pairwise([*(each.time for each in lost), inf])
        if not any(begin - NEAR <= each < end - NEAR for each in given)
    ]
    return Dropped(alone[0], guess=why) if len(alone) == count else None


def _compared(
    system: RecordedSystem,
    model: Model,
    connection: ConnectionState,
    ways: Ways,
    since: float,
    time: float,
) -> tuple[list[_Source], list[float]]:
    """Returns what came around a time, and when on the other side what may be of those unsure."""
    override = dict(connection.values).get("override")
    if override:
        raise RecordingError(f"{override} is an override, which is not run here")
    if ways.carried is None or ways.like is None:
        raise RecordingError("nothing that is recorded is translated")
    types = _types(system, connection, ways, ways.carried)
    with RecordedTranslation(
        model.metamodels, ways.carried, ways.like, offset=ways.offset
    ) as translation:
        entry = None if ways.holder is None else Catalogue(model).entry(ways.holder)
        taken = [
            (at, each)
            for at, found in _around(system, ways.source, ways.events_of_source, since, time)
            for each in _sources(_taken(system, found, types), ways.carried, entry)
        ]
        joins = _joined(system, connection, ways.carried, types, since, time)
        messages = sorted([*joins, *(each for _, each in taken)], key=lambda each: each.nanoseconds)
        made = translation.made_of(messages)
        given = [
            (at, _given(system, found, types, translation))
            for at, found in _around(system, ways.target, ways.events_of_target, since, time)
        ]
    told = passed(made, [each for _, each in given])
    sources = [
        _Source(at, one, is_passed)
        for (at, _), one, is_passed in zip(taken, made, told, strict=True)
    ]
    unsure = {each.made for each in sources if each.is_passed is None}
    return sources, [at for at, each in given if any(one.may_be(each.data) for one in unsure)]


def _joined(
    system: RecordedSystem,
    connection: ConnectionState,
    carried: bridge.Connection,
    types: RecordedTypes,
    since: float,
    time: float,
) -> Iterator[Taken]:
    """Yields the messages of joins, each with the last one before."""
    for topic, join in topics_of_joins(system, connection, carried):
        begin = since - AROUND
        before = system.recording.last(topic, begin)
        found = list(system.recording.between(topic, begin, time + AROUND))
        for _, each in [*([before] if before is not None else []), *found]:
            yield _taken(system, each, types, join)


def _around(
    system: RecordedSystem, topics: Sequence[str], event: int | None, since: float, time: float
) -> list[tuple[float, Found]]:
    events = events_of(system, topics, since - AROUND, time + AROUND, event)
    found = list(islice(events, MOST_COMPARED + 1))
    if len(found) > MOST_COMPARED:
        raise RecordingError(_TOO_MANY)
    return sorted(found, key=lambda each: each[0])


def times(system: RecordedSystem, ways: Ways, start: float, end: float) -> list[float]:
    """Returns when messages came that were to be passed on."""
    found = events_of(system, ways.source, start, end, ways.events_of_source)
    return sorted(time for time, _ in found)


def _types(
    system: RecordedSystem, connection: ConnectionState, ways: Ways, carried: bridge.Connection
) -> RecordedTypes:
    """Returns the types of the topics that have messages by themselves, not those of calls."""
    topics = () if ways.event is not None else (*ways.source, *ways.target)
    found = dict.fromkeys(topics, carried.map.type)
    joins = {str(each.name): each.type for each in carried.map.joins if each.type is not None}
    for topic, join in topics_of_joins(system, connection, carried):
        if join in joins:
            found[topic] = joins[join]
    return RecordedTypes({name: each for name, each in found.items() if each is not None})


def _taken(system: RecordedSystem, found: Found, types: RecordedTypes, join: str = "") -> Taken:
    _, channel, message = found
    sender = channel.topic.removeprefix(JAUS_TOPICS).partition(".")[0]
    subsystem = int(sender) if sender.isdigit() else 0
    return Taken(message.log_time, subsystem, _data(system, found, types)[1], join)


def _sources(
    whole: Taken, carried: bridge.Connection, holder: MessageEntry | None
) -> Iterator[Taken]:
    """Yields a message, or those in it that the connection carries."""
    if holder is None:
        yield whole
        return
    try:
        fields = holder.decode(whole.data, as_it_is)
    except MessageError as error:
        raise RecordingError(f"{holder.name} cannot be read: {error}") from error
    for data in _held(fields):
        if int.from_bytes(data[:2], "little") == code(carried.map.message):
            yield replace(whole, data=data)


def _held(fields: Any) -> Iterator[bytes]:
    """Yields the messages in the elements of a list, or in the tasks of a mission."""
    if isinstance(fields, list):
        for each in fields:
            yield from _held(each)
    elif isinstance(fields, dict):
        text = fields.get("hex")
        if isinstance(text, str):
            yield bytes.fromhex(text)
        else:
            yield from _held([*fields.values()])


def _given(
    system: RecordedSystem, found: Found, types: RecordedTypes, translation: RecordedTranslation
) -> Given:
    receiver, data = _data(system, found, types)
    if kind_of(found) is not None:
        data = part_of(data)
    return Given(receiver, translation.comparable(data))


def _data(system: RecordedSystem, found: Found, types: RecordedTypes) -> tuple[str, bytes]:
    """Returns to whom a message went, of one of JAUS, and its bytes."""
    schema, channel, message = found
    if not channel.topic.startswith(JAUS_TOPICS):
        if schema is not None:
            difference = types.difference(channel.topic, schema.name, definition_in(schema))
            if difference:
                raise RecordingError(f"{channel.topic} {difference}")
        return "", bytes(message.data)
    value = system.recording.value_of(found)
    try:
        return str(value.get("destination")), bytes.fromhex(value["payload"])
    except (KeyError, TypeError, ValueError) as error:
        raise RecordingError(f"a message of {channel.topic} has no bytes") from error
