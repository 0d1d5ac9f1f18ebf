"""Parameters of a bridge as its parameter file lists them: what the runtime declares, in words.

The runtime declares them (`runtime/bridge/ends/parameters.py`); tests compare both.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass

from jausml.generation.literals import printable
from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.connections.topics import policies, reliability, resolve_topic
from jausml.language.semantics.directions import is_to_ros
from jausml_generators.bridge.connections import ConnectionView
from jausml_generators.bridge.ends import JoinView
from jausml_generators.bridge.services_and_actions import ActionView, CallView
from jausml_generators.bridge.translation.places import PathError
from jausml_generators.bridge.translation.values import AssignmentError
from jausml_generators.bridge.views import BridgeView

QUEUE_AGE_LIMIT = 2.0
"""Seconds, as the runtime has them."""

LEAST_DIAGNOSTICS = 0.01
"""Least number of diagnostics each second, as the runtime has it."""

LEAST_DEPTH = 100
"""Messages that the runtime keeps at least of a topic that is not latched."""


@dataclass(frozen=True)
class ParameterLine:
    """A parameter of a bridge in its file.

    Attributes:
        about: What it is; empty when the name says it.
        is_comment: Whether the line is commented out, as its name depends on the deployment.
    """

    name: str
    value: bool | float | str | list[str]
    about: str = ""
    is_comment: bool = False


def parameter_lines(view: BridgeView) -> Iterator[ParameterLine]:
    """Yields the parameters in the file of a bridge, besides those of its transport."""
    element = view.bridge
    yield ParameterLine("jaus_id", element.address, "JAUS address of the bridge.")
    yield ParameterLine("autostart", value=True, about="Whether the node becomes active by itself.")
    yield ParameterLine(
        "jaus_allowed_hosts",
        ",".join(element.allowedHosts),
        "IPv4 addresses and networks that JAUS is taken from, with commas; empty for any.",
    )
    yield ParameterLine(
        "jaus_fixed_sources",
        bool(element.fixedSources),
        "Whether a component that is suddenly heard from another endpoint is refused.",
    )
    yield from _budget_lines(element)
    yield ParameterLine(
        "jaus_authority",
        element.authority,
        "Authority that control of JAUS components is requested with.",
    )
    yield ParameterLine(
        "jaus_digital_resources", "", "URLs of streams and files, with spaces between them."
    )
    yield ParameterLine(
        "frequency",
        float(element.frequency),
        "Messages each second (Hz) of the connections that state no rate.",
    )
    yield ParameterLine(
        "diagnostics_frequency",
        min(max(float(element.frequency), LEAST_DIAGNOSTICS), 1.0),
        "Diagnostics each second (Hz).",
    )
    yield ParameterLine(
        "queue_age_limit",
        QUEUE_AGE_LIMIT,
        "Seconds after which a message of a topic that is not latched is too old; 0 is never.",
    )
    yield ParameterLine(
        "latency", value=False, about="Whether the latency of all connections is measured."
    )
    yield ParameterLine(
        "compiled", value=True, about="Whether compiled translations are used where they are built."
    )
    # A translation that cannot be written is reported by the template that it stands in.
    with suppress(AssignmentError, PathError):
        for parameter in view.module.parameters:
            yield ParameterLine(parameter.name, parameter.value, parameter.description)
        for connection in view.connections:
            yield from _connection_lines(connection)
        for call in view.calls:
            yield from _call_lines(call)


def _budget_lines(element: bridge.Bridge) -> Iterator[ParameterLine]:
    """Yields the budgets of strangers."""
    yield ParameterLine(
        "jaus_amplification_limit",
        element.amplificationLimit,
        "Bytes to a UDP endpoint for each byte from it, until it proved its address; 0 is any.",
    )
    yield ParameterLine(
        "jaus_max_peers",
        element.maxPeers,
        "Components that are remembered, besides stated ones and the one in control.",
    )
    yield ParameterLine("jaus_max_connections", element.maxConnections, "TCP connections.")
    yield ParameterLine(
        "jaus_idle_timeout",
        float(element.idleTimeout),
        "Seconds in which a message must come over a new TCP connection; 0 is any time.",
    )
    yield ParameterLine("jaus_max_events", element.maxEvents, "JAUS events at a time.")
    yield ParameterLine(
        "jaus_event_rate_budget",
        float(element.eventRateBudget),
        "Reports of all periodic JAUS events together each second.",
    )


def _rate_line(name: str, rate: float, connection: bridge.Connection) -> ParameterLine:
    """Returns a rate; a comment where the frequency of the bridge says it."""
    if rate:
        return ParameterLine(f"{name}.rate", rate, "Messages each second (Hz).")
    owner = connection.eContainer()
    usual = float(owner.frequency) if owner is not None else 0.0
    about = "Messages each second (Hz); without it, the frequency."
    return ParameterLine(f"{name}.rate", usual, about, is_comment=True)


def _connection_lines(view: ConnectionView) -> Iterator[ParameterLine]:
    name, connection = view.model_name, view.connection
    about = " ".join(printable(connection.documentation or "").split())
    if isinstance(view, ActionView):
        yield from _action_lines(view, f"Action of {name}. {about}".strip())
    main = [topic for topic in connection.topics if topic.join is None]
    yield from _topic_lines(name, main, f"Topic of {name}. {about}".strip())
    if view.named_peers:
        yield ParameterLine(f"{name}.peers", view.named_peers)
    if view.rate is not None:
        yield _rate_line(name, view.rate, view.connection)
    if not isinstance(view, ActionView):
        yield ParameterLine(
            f"{name}.silence_timeout",
            view.longest_silence,
            "Seconds without a message that count as silence; 0 is never.",
        )
        yield from _shape_lines(view)
        about = "Whether its latency is measured."
        yield ParameterLine(f"{name}.latency", value=False, about=about)
    for join in view.joins:
        owner = f"{name}.{join.name}"
        yield ParameterLine(
            f"{owner}.freshness",
            float(join.join.freshness),
            "Seconds after which the latest message is stale.",
        )
        if isinstance(join, JoinView):
            yield from _topic_lines(owner, list(join.topics))
            continue
        if join.named_peers:
            yield ParameterLine(f"{owner}.peers", join.named_peers)
        if join.rate is not None:
            yield _rate_line(owner, join.rate, connection)
    for topic in connection.topics:
        yield from _quality_lines(connection, topic)


def _action_lines(view: ActionView, about: str) -> Iterator[ParameterLine]:
    yield ParameterLine(f"{view.model_name}.action", str(view.action.action), about)
    if not view.to_ros:
        about = "Speed at which lists are executed (m/s)."
        yield ParameterLine(f"{view.model_name}.speed", view.speed, about)


def _call_lines(view: CallView) -> Iterator[ParameterLine]:
    name, connection = view.model_name, view.connection
    about = " ".join(printable(connection.documentation or "").split())
    yield ParameterLine(
        f"{name}.service", connection.service, f"ROS service of {name}. {about}".strip()
    )
    if connection.peers and connection.search is None:
        yield ParameterLine(f"{name}.peers", [str(peer.address) for peer in connection.peers])
    yield ParameterLine(
        f"{name}.timeout",
        float(connection.timeout),
        "Seconds after which a call without an answer has failed.",
    )


def _shape_lines(view: ConnectionView) -> Iterator[ParameterLine]:
    name, own = view.model_name, view.connection
    if view.is_capped:
        yield ParameterLine(
            f"{name}.rate_cap",
            float(own.rateCap),
            "Messages each second that are taken of one source; 0 is all.",
        )
    yield ParameterLine(
        f"{name}.max_rate", float(own.maxRate), "Messages that pass each second at most; 0 is all."
    )
    yield ParameterLine(
        f"{name}.decimation", int(own.decimation), "Every how many messages one passes."
    )
    yield ParameterLine(
        f"{name}.age_limit",
        float(own.ageLimit),
        "Seconds after which a message is too old to pass; 0 is never.",
    )


def _topic_lines(
    owner: str, topics: list[bridge.Topic], about: str = ""
) -> Iterator[ParameterLine]:
    if len(topics) == 1:
        yield ParameterLine(f"{owner}.topic", topics[0].name, about)
    elif topics:
        yield ParameterLine(f"{owner}.topics", [topic.name for topic in topics], about)


def _quality_lines(connection: bridge.Connection, topic: bridge.Topic) -> Iterator[ParameterLine]:
    owner = connection.eContainer()
    namespace, node = (owner.namespace or "", owner.name) if owner is not None else ("", "")
    kind = "publisher" if is_to_ros(connection) else "subscription"
    name = f"qos_overrides.{resolve_topic(topic.name, namespace, node)}.{kind}"
    own = policies(topic.qos)
    durability, depth = own["durability"], own["depth"]
    if kind == "subscription" and durability == "volatile":
        depth = max(depth, LEAST_DEPTH)
    stated = {"reliability": reliability(connection, topic), "durability": durability}
    for policy, value in (*stated.items(), ("depth", depth)):
        yield ParameterLine(f"{name}.{policy}", value, is_comment=True)
