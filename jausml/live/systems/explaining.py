"""Why a message was not passed on, in sentences: the counter, the state, and the message itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.live.recording.mcap_files import RecordingError
from jausml.live.recording.ros_values import value_lines
from jausml.live.recording.seeking import JAUS_TOPICS
from jausml.live.systems.dropped import AROUND, NEAR, dropped_message, times
from jausml.live.systems.playback import NO_ROS
from jausml.live.systems.recorded_calls import (
    ANSWERED,
    GOT,
    RECEIVED,
    SENT,
    events_of,
    kind_of,
    last_of,
)
from jausml.live.systems.recorded_facts import BRIDGE
from jausml.live.systems.state import declarations_of
from jausml.live.systems.tables import shown_name, state_text
from jausml.live.systems.ways import ways_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from jausml.language.model import Model
    from jausml.live.recording.mcap_files import Found
    from jausml.live.systems.dropped import Dropped
    from jausml.live.systems.playback import Mark, RecordedSystem
    from jausml.live.systems.recorded_calls import CallEnd, RecordedCall
    from jausml.live.systems.state import ComponentState, ConnectionState, SystemState
    from jausml.live.systems.ways import Ways

MOST_LINES = 60
"""Lines of a message that are shown."""

MEANINGS: Mapping[str, str] = {
    "aborted": "whoever executed the goal or the list gave it up",
    "absent_field": "a field that the map needs was absent",
    "answer_not_delivered": "the answer to a call could not be delivered",
    "canceled": "the goal or the list was canceled",
    "empty_goal": "the goal of the action had no element",
    "ended": "the bridge ended while a call was under way",
    "filtered": "the translation gave no message, as its map or override decides",
    "inactive": "the bridge was inactive, as somebody wanted it",
    "lost": "nobody knew of the goal or the list any more",
    "no_action_server": "no server of the ROS action was there",
    "no_counterpart": "a value has no counterpart on the other side",
    "no_peer": "no JAUS component was there to send it to",
    "no_service": "the ROS service was not there",
    "no_speed": "the list needs a speed, and the goal had none",
    "not_asked": "the question could not be sent to the JAUS component",
    "not_decodable": "its bytes could not be decoded",
    "not_encodable": "what it became could not be encoded",
    "not_published": "the ROS middleware did not take it",
    "not_ready": "nobody at the other end obeyed, or the bridge might not command",
    "not_translated": "a call could not be translated",
    "out_of_range": "a value did not fit its field, and the map drops such a message",
    "over_rate": "its source sent more than the rate cap of the connection",
    "rejected": "who was asked refused it",
    "stale_join": "a topic or report that is joined to it had nothing fresh",
    "timed_out": "no answer came in time",
    "too_long": "the list had more elements than one goal may have",
    "too_many_calls": "too many calls were under way",
    "too_old": "it was older than the connection allows",
    "translation_failed": "the translation failed with an error, which the log of the bridge has",
    "unanswered": "a call was not answered",
    "unasked": "the peer sent it unasked, and the connection asks for events",
    "unexpected_source": "it came from a sender that the connection does not take",
    "refused": "its sender might not command, or not in that state; of a goal, nobody wanted it",
    "unreadable": "it could not be decoded",
    "unknown": "neither the component nor a connection takes it",
    "dropped by the kernel": "the sockets of the bridge had no room for it",
    "lost in queue": "it came faster than the bridge took it, and the queue was full",
    "missed": "it was published, and never taken",
    "lost on the way": "the report of an event never arrived, by the gaps in the numbers",
    "out of order": "it arrived after a newer one",
    "too old": "it waited in the queue for too long",
}
"""Why a message was not passed on, by its counter. They stand in docs/how-to/deploy.md too."""


@dataclass(frozen=True)
class Explanation:
    """Sentences, and the messages on both sides as lines.

    Attributes:
        at: The time that is explained: that of the last drop, if there is one.
    """

    at: float
    counter: tuple[str, ...]
    state: tuple[str, ...]
    ros: tuple[str, ...]
    jaus: tuple[str, ...]


def explained(
    system: RecordedSystem, model: Model | None, key: tuple[str, str], at: float
) -> Explanation:
    """Returns why a connection did not pass on what it dropped last, up to a time.

    Args:
        system: The recording.
        model: What says which messages the connection takes and gives.
        key: Bridge and name of the connection.
    """
    drops = [
        each
        for each in system.marks
        if each.subject == key and each.kind == "drop" and each.time <= at
    ]
    # All that was counted in one status has one time.
    risen = [each for each in drops if each.time == drops[-1].time]
    moment = risen[0].time if risen else at
    state = system.state(moment, model)
    connection = state.connections.get(key)
    sides = _sides(system, model, connection, moment, risen)
    if connection is None or connection.told is None:
        return Explanation(moment, (_untold(system, key),), (), *sides)
    counters, told = _counters(connection, risen, at), _states(state, connection, moment)
    return Explanation(moment, tuple(counters), tuple(told), *sides)


def _untold(system: RecordedSystem, key: tuple[str, str]) -> str:
    name = f"{key[1]} of {key[0]}"
    if system.sources.get("ROS"):
        return (
            f"The recording cannot tell what {name} did not pass on: {NO_ROS}. "
            "Record with ROS and the model of the system."
        )
    return f"No bridge has told anything of {name} up to then, so its counters are not known."


def meaning(counter: str) -> str:
    """Returns why messages are counted so, empty where nobody has said."""
    if counter.startswith("stale_join_"):
        return f"{MEANINGS['stale_join']}: {counter.removeprefix('stale_join_')}"
    found = MEANINGS.get(counter) or MEANINGS.get(counter.removesuffix(", at most"))
    return found or MEANINGS.get(counter.partition(" ")[0], "")


def _counters(connection: ConnectionState, risen: list[Mark], at: float) -> Iterator[str]:
    name = shown_name(connection)
    if not risen:
        yield f"Up to {at:.1f} s, no counter of {name} rose while it was recorded."
        if connection.drops:
            counts = ", ".join(f"{each} {count}" for each, count in connection.drops.items())
            yield f"What it had dropped before then, the recording cannot explain: {counts}."
        return
    for each in risen:
        yield (
            f"Between {_span(each)}, {name} did not pass on {_times_of(each.count, 'message')}: "
            f"its counter \u201c{each.counter}\u201d rose from {each.before} to {each.after}."
        )
        why = meaning(each.counter)
        if not why and connection.concerns_bridge:
            yield "A message is counted there by the bridge, before it comes to a connection."
            continue
        yield (
            f"A message is counted there because {why}."
            if why
            else "What this counter means, nobody has said: the bridge is of another version, "
            "or its override counts so."
        )


def _states(state: SystemState, connection: ConnectionState, at: float) -> Iterator[str]:
    values = dict(connection.values)
    because = f": {connection.reason}" if connection.reason else ""
    what = "status" if connection.concerns_bridge else "connection"
    yield f"At {at:.1f} s, the {what} was {state_text(connection)}{because}."
    yield from _bridge(state, connection)
    for key, text in connection.peers.items():
        address = key.partition(" ")[2]
        if address:
            beside = _beside(state.components.get(address))
            yield f"To the bridge, its peer {address} was {text}; {beside}."
    if "override" in values:
        methods = values["override"]
        yield f"What it passes on, code of yours decides, which is not run here: {methods}."
    yield from _stops(values)
    limited = values.get("values limited", "0")
    if limited != "0":
        yield f"Values that it brought within what their fields carry: {limited}."
    for name, count in values.items():
        if name.startswith("out of range: ") and count.isdigit():
            policy, _, field = name.removeprefix("out of range: ").partition(" ")
            yield f"Its value {field} was out of range {_times_of(int(count), 'time')} ({policy})."


def _bridge(state: SystemState, connection: ConnectionState) -> Iterator[str]:
    """Yields how the bridge was, as it told itself or as others heard it."""
    told = state.connections.get((connection.bridge, BRIDGE))
    component = state.components.get(connection.jaus_id)
    if told is not None and component is not None:  # who may have said something since
        node = dict(told.values).get("node", "unknown")
        yield (
            f"The bridge {connection.jaus_id} was {node} and in {component.state or 'no state'}, "
            f"controlled by {_nobody(component.controller or '')}."
        )
        return
    if component is None or component.told is None:
        yield (
            f"In which state the bridge {connection.jaus_id} was, the recording does not tell: "
            "nobody asked it."
        )
        return
    yield f"The bridge {connection.jaus_id} was in {component.state or 'an unknown state'}" + (
        f", controlled by {_nobody(component.controller or '')}."
        if component.controller is not None
        else "; who controlled it, nobody asked."
    )


def _nobody(controller: str) -> str:
    return controller if controller not in ("", "none") else "nobody"


def _beside(component: ComponentState | None) -> str:
    """Returns what a peer said of itself."""
    texts = [f"in {component.state}"] if component is not None and component.state else []
    if component is not None and component.controller is not None:
        texts.append(f"controlled by {_nobody(component.controller)}")
    return f"it was {', '.join(texts)}" if texts else "of itself it said nothing"


def _stops(values: Mapping[str, str]) -> Iterator[str]:
    stops = [
        f"{name.removeprefix('stopped: ')} ({_times_of(int(count), 'time')})"
        for name, count in values.items()
        if name.startswith("stopped: ") and count.isdigit()
    ]
    if stops:
        yield f"What it commands had been stopped: {', '.join(stops)}."
    if "when lost" in values:
        yield f"When its source is lost: {values['when lost']}."


# ---- the message ------------------------------------------------------------------------------

Lines = tuple[str, ...]


def _sides(
    system: RecordedSystem,
    model: Model | None,
    connection: ConnectionState | None,
    at: float,
    risen: Sequence[Mark],
) -> tuple[Lines, Lines]:
    """Returns the message that was dropped, else the last up to a time, and that on the other side.

    Those of ROS come first.
    """
    several = () if model is None or connection is None else ways_of(system, model, connection)
    if model is None or connection is None or not several:
        is_status = connection is not None and connection.concerns_bridge
        text = (_OF_A_BRIDGE if is_status else _NOT_MODELLED,)
        return text, text
    ways, dropped = several[0], None
    if risen:
        ways, dropped = dropped_message(system, model, connection, several, risen)
    if dropped is not None and dropped.call is not None:
        return _sides_of_call(system, ways, *dropped.call)
    moment = at if dropped is None else dropped.time
    taken = tuple(_source_lines(system, ways, risen, moment, dropped))
    others = " or ".join(_giving_alike(model, connection))
    head = f"The last on this side, of this connection or {others}: " if others else _LAST
    given = tuple(_message_at(system, ways.target, moment, head, ways.events_of_target))
    return (given, taken) if ways.is_to_ros else (taken, given)


_LAST = "The last on this side: "
_NOT_MODELLED = "Which messages it takes and gives says the model, which has no such connection."
_OF_A_BRIDGE = "This is a status of the bridge itself, which carries no messages."


def _giving_alike(model: Model, connection: ConnectionState) -> Iterator[str]:
    """Yields the connections of the same bridge whose messages stand where those of this one do."""
    own = connection.declaration
    for each in declarations_of(model) if own is not None else ():
        if own is None or each.bridge != own.bridge or each.name == own.name:
            continue
        is_shared = (
            each.message == own.message
            if own.direction == "to JAUS"
            else not {*each.topics}.isdisjoint(own.topics)
        )
        if is_shared and each.direction == own.direction:
            yield each.name


def _sides_of_call(
    system: RecordedSystem, ways: Ways, by: CallEnd, call: RecordedCall
) -> tuple[Lines, Lines]:
    """Returns a call that failed as both sides have it: its request, and what answered it."""
    asked, end = call.asked, call.answered or call.asked + AROUND
    request, answer = (RECEIVED, ANSWERED) if by.serves else (SENT, GOT)
    lines = ["This call failed, and no response to it is in the recording."]
    if call.answered is not None:
        why = f": {call.reason}" if call.reason else ""
        lines = [f"This call failed, as its response says{why}."]
    lines += _message_at(system, [by.topic], asked, "Its request: ", request)
    if call.answered is not None:
        lines += _message_at(system, [by.topic], end, "Its response: ", answer)
    if not by.serves:
        return tuple(lines), tuple(_message_at(system, ways.source, asked, "It was made of: "))
    passed = [*events_of(system, ways.target, asked - NEAR, end, None)]
    if not passed:
        return tuple(lines), ("Nothing of it was passed on.",)
    first = min(at for at, _ in passed)
    made = [*_message_at(system, ways.target, first, "It was passed on as: ")]
    if any(True for _ in events_of(system, ways.answers, first, end, None)):
        made += _message_at(system, ways.answers, end, "What answered it: ")
    return tuple(lines), tuple(made)


def _source_lines(
    system: RecordedSystem,
    ways: Ways,
    risen: Sequence[Mark],
    at: float,
    dropped: Dropped | None,
) -> Iterator[str]:
    if risen:
        count = len(times(system, ways, risen[0].since, risen[0].time))
        yield f"{_times_of(count, 'message')} came between {_span(risen[0])}."
    if dropped is not None and dropped.guess:
        yield (
            "By its time, nothing on the other side follows this one, which was most likely not "
            f"passed on. Its content does not tell it: {dropped.guess}."
        )
    elif dropped is not None and dropped.reason:
        yield f"This one was not passed on, since the translation refuses it: {dropped.reason}."
    elif dropped is not None:
        yield "This one was not passed on: what it becomes is not on the other side."
    elif risen and ways.missing:
        yield f"Which it was is not known: {ways.missing}."
    elif risen and count > 1:
        yield "Which of them was not passed on, the recording does not tell; this is the last."
    yield from _message_at(system, ways.source, at, "", ways.events_of_source)


def _message_at(
    system: RecordedSystem,
    topics: Sequence[str],
    at: float,
    head: str,
    event: int | None = None,
) -> Iterator[str]:
    found = [
        (*last, each)
        for each in topics
        if each in system.recording.topics and (last := last_of(system, each, at, event))
    ]
    if not found:
        names = " or ".join(topics) or "such a message"
        yield f"Up to {at:.3f} s, {names} is not in the recording."
        return
    time, message, topic = max(found, key=lambda each: each[0])
    yield f"{head}{topic} at {time:.3f} s"
    try:
        yield from message_lines(system, message)
    except RecordingError as error:
        yield str(error)


def _times_of(count: int, word: str) -> str:
    return f"{count} {word}" if count == 1 else f"{count} {word}s"


def _span(mark: Mark) -> str:
    return f"{mark.since:.1f} s and {mark.time:.1f} s"


def message_lines(system: RecordedSystem, found: Found) -> list[str]:
    """Returns the fields of a message as lines."""
    value = system.recording.value_of(found)
    if kind_of(found) is not None:
        value = next((value[each][0] for each in ("request", "response") if value[each]), {})
        return value_lines(value)[:MOST_LINES] or ["(no fields)"]
    fields: dict[str, Any] = value
    if found[1].topic.startswith(JAUS_TOPICS) and isinstance(value.get("fields"), dict):
        fields = value["fields"]
        head = [f"from {value.get('source')} to {value.get('destination')}"]
        return [*head, *value_lines(fields)][:MOST_LINES] if fields else [*head, "(no fields)"]
    return value_lines(fields)[:MOST_LINES]
