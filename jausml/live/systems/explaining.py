"""Explanations, in sentences, why a bridge dropped a message: its counter, and the state then."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from jausml.language.model import Model
from jausml.live.systems.playback import NO_ROS, Mark, RecordedSystem
from jausml.live.systems.recorded_facts import BRIDGE
from jausml.live.systems.state import ComponentState, ConnectionState, SystemState
from jausml.live.systems.tables import shown_name, state_text

# Reasons of drops by the counters of bridges. The documentation page of the counters has them, too.
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


@dataclass(frozen=True)
class Explanation:
    """Sentences about the last drop of a connection.

    Attributes:
        at: Time of the last drop, in seconds since the beginning of the recording; the given time
            if there is no drop.
        counter: Sentences about the counters that rose.
        state: Sentences about the state at that time.
    """

    at: float
    counter: tuple[str, ...]
    state: tuple[str, ...]


def explained(
    system: RecordedSystem, model: Model | None, key: tuple[str, str], at: float
) -> Explanation:
    """Returns the reasons for the last drop of a connection up to a time.

    Args:
        system: The recording.
        model: The model of the system, for its declared components and connections.
        key: Bridge and name of the connection.
        at: Seconds since the beginning of the recording.
    """
    drops = [
        mark
        for mark in system.marks
        if mark.subject == key and mark.kind == "drop" and mark.time <= at
    ]
    # All counters of one status have the same time.
    last_drops = [drop for drop in drops if drop.time == drops[-1].time]
    moment = last_drops[0].time if last_drops else at
    state = system.state(moment, model)
    connection = state.connections.get(key)
    if connection is None or connection.told is None:
        return Explanation(moment, (_without_counters(system, key),), ())
    counters, sentences = _counters(connection, last_drops, at), _states(state, connection, moment)
    return Explanation(moment, tuple(counters), tuple(sentences))


def _without_counters(system: RecordedSystem, key: tuple[str, str]) -> str:
    name = f"{key[1]} of {key[0]}"
    if system.sources.get("ROS"):
        return (
            f"The recording cannot tell what {name} did not pass on: {NO_ROS}. "
            "Record with ROS and the model of the system."
        )
    return f"No bridge has told anything of {name} up to then, so its counters are not known."


def meaning(counter: str) -> str:
    """Returns the reason of a drop by its counter; empty for an unknown counter."""
    if counter.startswith("stale_join_"):
        return f"{MEANINGS['stale_join']}: {counter.removeprefix('stale_join_')}"
    reason = MEANINGS.get(counter) or MEANINGS.get(counter.removesuffix(", at most"))
    return reason or MEANINGS.get(counter.partition(" ")[0], "")


def _counters(connection: ConnectionState, last_drops: list[Mark], at: float) -> Iterator[str]:
    name = shown_name(connection)
    if not last_drops:
        yield f"Up to {at:.1f} s, no counter of {name} rose while it was recorded."
        if connection.drops:
            counts = ", ".join(f"{counter} {count}" for counter, count in connection.drops.items())
            yield f"What it had dropped before then, the recording cannot explain: {counts}."
        return
    for mark in last_drops:
        yield (
            f"Between {_span(mark)}, {name} did not pass on {_times_of(mark.count, 'message')}: "
            f"its counter \u201c{mark.counter}\u201d rose from {mark.before} to {mark.after}."
        )
        why = meaning(mark.counter)
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
            own_state = _own_state(state.components.get(address))
            yield f"To the bridge, its peer {address} was {text}; {own_state}."
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
    """Yields a sentence on the state of the bridge, by its own status or by answers over JAUS."""
    bridge_state = state.connections.get((connection.bridge, BRIDGE))
    component = state.components.get(connection.jaus_id)
    if bridge_state is not None and component is not None:  # its answers may be later than it
        node = dict(bridge_state.values).get("node", "unknown")
        yield (
            f"The bridge {connection.jaus_id} was {node} and in {component.state or 'no state'}, "
            f"controlled by {_controller_text(component.controller or '')}."
        )
        return
    if component is None or component.told is None:
        yield (
            f"In which state the bridge {connection.jaus_id} was, the recording does not tell: "
            "nobody asked it."
        )
        return
    yield f"The bridge {connection.jaus_id} was in {component.state or 'an unknown state'}" + (
        f", controlled by {_controller_text(component.controller or '')}."
        if component.controller is not None
        else "; who controlled it, nobody asked."
    )


def _controller_text(controller: str) -> str:
    return controller if controller not in ("", "none") else "nobody"


def _own_state(component: ComponentState | None) -> str:
    """Returns the state that a peer reported of itself, in words."""
    texts = [f"in {component.state}"] if component is not None and component.state else []
    if component is not None and component.controller is not None:
        texts.append(f"controlled by {_controller_text(component.controller)}")
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


def _times_of(count: int, word: str) -> str:
    return f"{count} {word}" if count == 1 else f"{count} {word}s"


def _span(mark: Mark) -> str:
    return f"{mark.since:.1f} s and {mark.time:.1f} s"
