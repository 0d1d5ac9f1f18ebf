"""Answers of a model to hazards: what its elements do, in which time, and why that may do."""

from __future__ import annotations

from dataclasses import dataclass

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.semantics.assignments.meanings import unknown_targets
from jausml.language.semantics.connections import stops
from jausml.language.semantics.connections.hold_reasons import is_reason
from jausml.language.semantics.connections.reports import freshness_of
from jausml.language.semantics.jaus.commands import (
    controlled_by_nobody,
    is_published,
    obeys_controller_alone,
)
from jausml.language.semantics.jaus.inheritance import with_inherited
from jausml.safety_case.elements import (
    Carrier,
    Commander,
    bridge_of,
    map_directions,
    moving_inputs,
)


@dataclass(frozen=True)
class Answer:
    """The answer of an element to a hazard.

    Attributes:
        text: What it does, in words of the document.
        seconds: Time after which it does so; 0 for none.
        reason: The reason that a person gave for it; empty without one.
    """

    text: str
    seconds: float = 0.0
    reason: str = ""


def _after(seconds: float, before: str, after: str = "") -> Answer | None:
    """Returns an answer that names its seconds between two texts; None for no time."""
    return Answer(f"{before} {seconds:g} s{after}", float(seconds)) if seconds > 0 else None


def _stop(commander: Commander) -> str:
    if isinstance(commander, bridge.RosActionConnection):
        return "cancels its goal"
    return f"sends its stop ({stops.stop_text(commander)})" if stops.has_stop(commander) else ""


def on_silence(commander: Commander) -> Answer | None:
    """Answers that a connection stops what it commands when its source is silent."""
    if not isinstance(commander, bridge.Connection) or not stops.has_stop(commander):
        return None
    return _after(stops.silence_timeout(commander), f"{_stop(commander)} after", " of silence")


def on_lapse(commander: Commander) -> Answer | None:
    """Answers that it stops what it commands when control is not renewed."""
    what, seconds = _stop(commander), int(bridge_of(commander).controlTimeout)
    return _after(seconds if what else 0, f"{what} when control is not renewed for")


def on_lost_control(commander: Commander) -> Answer | None:
    """Answers that it stops what it commands when its controller loses control."""
    what = _stop(commander)
    return Answer(f"{what} when its controller loses control") if what else None


def by_guardian(commander: Commander) -> Answer | None:
    """Answers that a guardian stops what it commands."""
    what = _stop(commander) if bridge_of(commander).guardian else ""
    return Answer(f"its guardian {what} when the bridge is dead or stands still") if what else None


def held(commander: Commander) -> Answer | None:
    """Answers that the last command may stand, as it moves nothing or by a reason."""
    if not isinstance(commander, bridge.Connection) or not stops.keeps_last_command(commander):
        return None
    message = commander.map.message
    if not message.moves:
        own = "" if is_published(message) else "its definition says so (moves false)"
        return Answer(f"{message.name} sets nothing in motion", reason=own)
    reason = stops.hold_reason(commander).strip()
    return Answer("the last command stands", reason=reason) if is_reason(reason) else None


def lapse_of_peers(commander: Commander) -> Answer | None:
    """Answers that control of those that it commands ends by itself."""
    times = [int(peer.controlTimeout) for peer in commander.peers]
    lapse = max(times) if times and all(times) and commander.control else 0
    is_external = any(peer.external for peer in commander.peers)
    said = " (external: if they do what the model says)" if is_external else ""
    return _after(lapse, "control of its peers lapses when it is not renewed for", said)


def known_peers(carrier: Carrier) -> Answer | None:
    """Answers that it takes messages of known components alone."""
    names = ", ".join(str(peer.name) for peer in carrier.peers)
    names = "components that it has found" if carrier.search is not None else names
    return Answer(f"takes messages of {names} alone") if names else None


def known_hosts(element: Carrier | bridge.Bridge) -> Answer | None:
    """Answers that it hears known hosts alone."""
    owner = element if isinstance(element, bridge.Bridge) else bridge_of(element)
    hosts = ", ".join(map(str, owner.allowedHosts))
    return Answer(f"hears {hosts} and its own host alone") if hosts else None


def freshness(connection: bridge.Connection) -> Answer | None:
    """Answers that it reports nothing old."""
    seconds = freshness_of(connection) or stops.silence_timeout(connection)
    return _after(seconds, "reports nothing older than", ", but what is safe in its place")


def told_of_loss(connection: bridge.Connection) -> Answer | None:
    """Answers that readers in ROS learn of a loss."""
    silence = stops.silence_timeout(connection) if connection.safeValue else 0.0
    topics = [topic.qos for topic in connection.topics if topic.join is None]
    deadline = min((float(qos.deadline) if qos is not None else 0.0 for qos in topics), default=0)
    answer = _after(silence, "publishes its safe value after", " of silence")
    return answer or _after(deadline, "its topic has a deadline of")


def keeps_control(connection: Commander) -> Answer | None:
    """Answers that it ends with control."""
    return Answer("sends only while it has control of the peer") if connection.control else None


def control_lapse(component: jaus.Component) -> Answer | None:
    """Answers that control of a component ends by itself."""
    lapse = float(component.controlTimeout)
    return _after(lapse, "its control lapses when it is not renewed for")


def obeys_controller(component: jaus.Component) -> Answer | None:
    """Answers that a component is moved by its controller alone."""
    is_obedient = all(obeys_controller_alone(*pair) for pair in moving_inputs(component))
    if is_obedient and not any(map(controlled_by_nobody, with_inherited(component.provides))):
        return Answer("obeys what moves it from its controller alone")
    return None


def fixed_sources(owner: bridge.Bridge) -> Answer | None:
    """Answers that nobody else can pass for a component."""
    return Answer("hears each component from one endpoint alone") if owner.fixedSources else None


def age_limit(connection: bridge.Connection) -> Answer | None:
    """Answers that nothing old passes."""
    return _after(float(connection.ageLimit), "passes no message older than")


def told_of_silence(connection: jaus.ServiceConnection) -> Answer | None:
    """Answers that who asks learns of silence."""
    return _after(float(connection.silenceTimeout), "is told after", " of silence")


def rate_cap(connection: bridge.Connection) -> Answer | None:
    """Answers that one source cannot send too much."""
    return _rate(float(connection.rateCap), "takes", " of one source")


def most_rate(connection: bridge.Connection) -> Answer | None:
    """Answers that not too much passes."""
    return _rate(float(connection.maxRate), "passes")


def _rate(rate: float, before: str, after: str = "") -> Answer | None:
    """Returns the answer of a rate in messages/s, which is no time; None for no limit."""
    return Answer(f"{before} {rate:g} messages/s{after} at most") if rate > 0 else None


def meaning(carrier: Carrier) -> Answer | None:
    """Answers that something says what is right of each number."""
    text = "rules know units, axes and names of both ends, or test vectors say what is right"
    return None if unjudged_targets(carrier) else Answer(text)


def unjudged_targets(carrier: Carrier) -> dict[str, str]:
    """Returns the targets that cannot be judged, each with the reason."""
    directions = (unknown_targets(map_, to_ros=to_ros) for map_, to_ros in map_directions(carrier))
    return {target: lack for pairs in directions for target, lack in pairs}
