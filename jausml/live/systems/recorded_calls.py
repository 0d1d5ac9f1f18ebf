"""Calls of ROS services in a recording, as their ends published them (service introspection)."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.live.recording.mcap_files import RecordingError
from jausml.live.recording.recorder import CALLS

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.live.recording.mcap_files import Found
    from jausml.live.systems.playback import Mark, RecordedSystem

SENT, RECEIVED, ANSWERED, GOT = range(4)
"""Kinds of events: the client sent a request, the server received it and answered, the client got
the response (service_msgs/msg/ServiceEventInfo)."""

REQUEST_AT, RESPONSE_AT = 48, 52
"""Where a request and a response begin in the bytes of an event that has only this one."""

_COUNT_AT = 44
_TICK = 1e-9
_PATIENCES = 2
"""How many time-outs a call may last: it waits for its turn, then for its answer."""


def kind_of(found: Found) -> int | None:
    """Returns the kind of an event; None of another message."""
    _, channel, message = found
    return message.data[4] if channel.topic.endswith(CALLS) and len(message.data) > 4 else None


def part_of(data: bytes) -> bytes:
    """Returns the request or response of an event, padded to words; none where it has none."""
    if data[4] in (SENT, RECEIVED):
        return data[REQUEST_AT:-4] if any(data[_COUNT_AT:REQUEST_AT]) else b""
    return data[RESPONSE_AT:]


def has_contents(system: RecordedSystem, topic: str) -> bool:
    """Tells whether a recording has requests or responses of a service."""
    if topic not in system.recording.topics:
        return False
    last = system.recording.last(topic, system.recording.duration)
    return last is not None and bool(part_of(bytes(last[1][2].data)))


@dataclass(frozen=True)
class CallEnd:
    """The end that a bridge has of the calls of a service.

    Attributes:
        serves: Whether it answers; else it asks.
        timeout: Seconds after which it waits no more.
        success: Path of what says in a response whether all went well; empty where nothing does.
        reason: Path of why it did not.
        succeeded: What is there where all went well.
        counters: Those that count such calls; none for all.
    """

    topic: str
    serves: bool
    timeout: float
    success: str = ""
    reason: str = ""
    succeeded: object = True
    counters: frozenset[str] = frozenset()


@dataclass(frozen=True)
class RecordedCall:
    """A call at the end that the bridge has.

    Attributes:
        asked: When its request came or was sent.
        answered: When its response was sent or came; None for never.
        is_success: Whether the response says that all went well; None where none does.
        reason: Why it did not, as the response says.
    """

    asked: float
    answered: float | None = None
    is_success: bool | None = None
    reason: str = ""


def failed_call(system: RecordedSystem, end: CallEnd, risen: Sequence[Mark]) -> RecordedCall | None:
    """Returns the first call that failed, as counters rose; None if nobody knows.

    Those are known if exactly as many failed as were counted.
    """
    since, time = risen[0].since, risen[0].time
    count = sum(each.count for each in risen if not end.counters or each.counter in end.counters)
    longest = _PATIENCES * end.timeout + 1.0
    try:
        calls = _calls(system, end, since - longest, time + longest)
    except RecordingError:
        return None
    found = [each for each in calls if _has_failed(each, since, time)]
    return found[0] if found and len(found) == count else None


def _has_failed(call: RecordedCall, since: float, time: float) -> bool:
    if call.answered is None:
        return call.asked <= time
    return call.is_success is False and since < call.answered <= time


def _calls(system: RecordedSystem, end: CallEnd, since: float, until: float) -> list[RecordedCall]:
    """Returns the calls of a time; none where several clients cannot be told apart."""
    begins, ends = (RECEIVED, ANSWERED) if end.serves else (SENT, GOT)
    asked: dict[object, float] = {}
    answers: dict[object, tuple[float, dict[str, Any]]] = {}
    seen: Counter[object] = Counter()
    for time, found in system.recording.between(end.topic, since, until):
        kind = kind_of(found)
        if kind not in (begins, ends):
            continue
        event = system.recording.value_of(found)
        client, number = event["info"]["client_gid"], event["info"]["sequence_number"]
        key = client, number
        if kind == begins:
            asked[key] = time
            seen[client] += 1
        else:
            answers[key] = time, event
    if not end.serves and len(seen) > 1:
        return []
    return [_call(end, at, answers.get(key)) for key, at in asked.items()]


def _call(end: CallEnd, asked: float, answer: tuple[float, dict[str, Any]] | None) -> RecordedCall:
    if answer is None:
        return RecordedCall(asked)
    time, event = answer
    response: dict[str, Any] = next(iter(event["response"]), {})
    success, reason = _member(response, end.success), _member(response, end.reason)
    is_success = None if success is None else bool(success == end.succeeded)
    return RecordedCall(asked, time, is_success, "" if reason is None else reason)


def _member(value: Any, path: str) -> Any:
    for name in path.split("."):
        value = value.get(name) if isinstance(value, dict) else None
    return value


def events_of(
    system: RecordedSystem, topics: Sequence[str], start: float, end: float, kind: int | None
) -> Iterator[tuple[float, Found]]:
    """Yields messages of topics in a time; of calls those of one kind alone."""
    for topic in topics:
        for time, found in system.recording.between(topic, start, end):
            if kind is None or kind_of(found) in (kind, None):
                yield time, found


def last_of(
    system: RecordedSystem, topic: str, at: float, kind: int | None
) -> tuple[float, Found] | None:
    """Returns the latest message of a topic up to a time; of calls the latest event of a kind."""
    last = system.recording.last(topic, at)
    while last is not None and kind is not None and kind_of(last[1]) not in (kind, None):
        last = system.recording.last(topic, last[0] - _TICK)
    return last
