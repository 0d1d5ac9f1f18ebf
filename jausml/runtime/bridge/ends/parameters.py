"""Parameters of a bridge: what a deployment may change without generating again.

A parameter has the value of the model until a parameter file, the command line or, for those that
may change while the bridge runs, `ros2 param set` says otherwise.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from ...base.address import JausAddress
from ...base.settings import MAX_FRAGMENT_SIZE, TransportKind
from ...clients.peer_binding import PeerBinding
from ...services.definitions import MAX_EVENT_RATE, server_type
from .topics import Parameter

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from .ends import BridgeSettings
    from .ros_side import RosSide
    from .topics import Topic

LEAST = 1e-9
"""Least value of a number that is above 0."""

GREATEST = 1.7976931348623157e308
"""Greatest number."""

GREATEST_SPEED = 327.67
"""Metres per second that a speed of AS6009 can say."""

LONGEST_TIME = 3600.0
"""Longest time in seconds that a parameter takes."""

LONGEST_FRESHNESS = 1e9
"""Longest time in seconds in which a joined message is fresh: for ever, where it holds a state."""

SHORTEST_TIME = 0.001
"""Shortest freshness, and shortest time of a call, in seconds."""

LEAST_RATE = 0.02
"""Least rate in hertz of an event or a query."""

LEAST_MAX_RATE = 0.001
"""Least rate in hertz above which messages are thinned out, besides 0."""

GREATEST_DECIMATION = 1_000_000
"""Most messages of which one passes."""

LEAST_DIAGNOSTICS = 0.01
"""Least number of diagnostics each second."""

QUEUE_AGE_LIMIT = 2.0
"""Seconds that a ROS message may have waited in the queue of the bridge.

That is far more than a bridge that keeps up needs, also while it starts. After a longer stall the
commands of before are history: what comes next is the word.
"""


@dataclass(frozen=True)
class AttributeParameter:
    """A parameter that sets an attribute of the bridge, also while the bridge runs.

    Attributes:
        is_positive: Whether a number is above 0.
    """

    name: str
    attribute: str
    description: str
    is_positive: bool = False

    def of(self, value: Any) -> Parameter:
        """Returns the parameter of the node, with the value that the attribute has."""
        lowest = LEAST if self.is_positive else -GREATEST
        limits = (lowest, GREATEST) if isinstance(value, float) else None
        return Parameter(self.name, value, self.description, limits)


def network(model: BridgeSettings) -> tuple[Parameter, ...]:
    """Returns what says how the process takes part in JAUS, named as its options are."""
    known, kinds = model.transport, [kind.value for kind in TransportKind]

    def check(kind: str) -> None:
        if kind not in kinds:
            raise ValueError(f"{kind} is none of {', '.join(kinds)}")

    return (
        Parameter("jaus_id", str(model.address), "JAUS address of the bridge.", check=address),
        Parameter("jaus_interface", known.interface, "IPv4 address of the interface of JAUS."),
        Parameter(
            "jaus_transport", known.transport.value, f"One of {', '.join(kinds)}.", check=check
        ),
        Parameter("jaus_port", known.port, "UDP or TCP port of JAUS.", (1, 65535)),
        Parameter("jaus_multicast_group", known.multicast_group, "Multicast group of JAUS."),
        Parameter(
            "jaus_multicast_ttl",
            known.multicast_ttl,
            "Routers that a multicast of JAUS may pass.",
            (0, 255),
        ),
        Parameter(
            "jaus_fragment_size",
            known.fragment_size,
            "Bytes of a message in one packet of JAUS.",
            (2, MAX_FRAGMENT_SIZE),
        ),
        Parameter(
            "jaus_allowed_hosts",
            ",".join(known.allowed_hosts),
            "IPv4 addresses and networks that JAUS is taken from, with commas; empty for any.",
        ),
        Parameter(
            "jaus_fixed_sources",
            known.fixed_sources,
            "Whether a component that is suddenly heard from another endpoint is refused.",
        ),
        Parameter(
            "jaus_amplification_limit",
            known.amplification_limit,
            "Bytes to a UDP endpoint for each byte from it, until it proved its address; 0 is any.",
            (0, 1000),
        ),
        Parameter(
            "jaus_max_peers",
            known.max_peers,
            "Components that are remembered, besides stated ones and the one in control.",
            (16, 65535),
        ),
        Parameter("jaus_max_connections", known.max_connections, "TCP connections.", (4, 4096)),
        Parameter(
            "jaus_idle_timeout",
            float(known.idle_timeout),
            "Seconds in which a message must come over a new TCP connection; 0 is any time.",
            (0.0, 86400.0),
        ),
    )


def digital_resources(urls: Sequence[str]) -> Parameter:
    """Returns where streams and files of the bridge are, for Digital Resource Discovery."""

    def check(text: str) -> None:
        for word in text.split():
            server_type(word)

    text = "URLs of streams and files, such as rtsp://10.0.0.7/front, with spaces between them."
    return Parameter("jaus_digital_resources", " ".join(urls), text, check=check)


@dataclass(frozen=True)
class Known:
    """A parameter that is not declared yet: all of it but its value.

    Attributes:
        name: Its name; `{}` stands for the connection, or the connection and join, that it is of.
    """

    name: str
    description: str
    limits: tuple[float, float] | None = None
    check: Callable[[Any], object] | None = None

    def of(self, value: Any, owner: str = "") -> Parameter:
        """Returns the parameter of the node, or of a connection."""
        text = self.description.format(owner)
        return Parameter(self.name.format(owner), value, text, self.limits, self.check)


def _is_no_limit(hertz: float) -> None:
    if 0 < hertz < LEAST_MAX_RATE:
        raise ValueError(f"{hertz:g} Hz is neither 0 nor {LEAST_MAX_RATE:g} Hz or more")


MAX_EVENTS = Known("jaus_max_events", "JAUS events at a time.", (1, 255))
EVENT_RATE_BUDGET = Known(
    "jaus_event_rate_budget",
    "Reports of all periodic JAUS events together each second.",
    (1.0, 255 * MAX_EVENT_RATE),
)
AUTHORITY = Known(
    "jaus_authority", "Authority that control of JAUS components is requested with.", (0, 255)
)
DIAGNOSTICS_FREQUENCY = Known(
    "diagnostics_frequency", "Diagnostics published each second (Hz).", (LEAST_DIAGNOSTICS, 100.0)
)
FREQUENCY = Known(
    "frequency",
    "Messages each second of the connections that state no rate (Hz).",
    (0.0, MAX_EVENT_RATE),
)
AUTOSTART = Known(
    "autostart", "Whether the node becomes active by itself; if not, it waits unconfigured."
)
QUEUE_AGE = Known(
    "queue_age_limit",
    "Seconds after which a message of a topic that is not latched is too old to be taken.",
    (0.0, LONGEST_TIME),
)
COMPILED = Known("compiled", "Whether compiled translations are used where they are built.")

RATE = Known(
    "{}.rate", "Messages of the connection {} each second (Hz).", (LEAST_RATE, MAX_EVENT_RATE)
)
SILENCE_TIMEOUT = Known(
    "{}.silence_timeout",
    "Seconds without a message that count as silence of the source of {}.",
    (0.0, LONGEST_TIME),
)
MAX_RATE = Known(
    "{}.max_rate",
    "Messages of {} that pass each second at most (Hz); 0 is all.",
    (0.0, GREATEST),
    _is_no_limit,
)
RATE_CAP = Known(
    "{}.rate_cap",
    "Messages of {} that are taken of one source each second (Hz); 0 is all.",
    (0.0, GREATEST),
    _is_no_limit,
)
DECIMATION = Known(
    "{}.decimation", "Every how many messages of {} one passes.", (1, GREATEST_DECIMATION)
)
AGE_LIMIT = Known(
    "{}.age_limit",
    "Seconds after which a message of {} is too old to pass; 0 is never.",
    (0.0, LONGEST_TIME),
)
LATENCY = Known("{}.latency", "Whether the latency of {} is measured.")
ALL_LATENCY = Known("latency", "Whether the latency of all is measured.")
FRESHNESS = Known(
    "{}.freshness",
    "Seconds after which the latest message of {} is stale.",
    (SHORTEST_TIME, LONGEST_FRESHNESS),
)
SPEED = Known(
    "{}.speed", "Speed at which the lists of {} are executed (m/s).", (0.0, GREATEST_SPEED)
)
TIMEOUT = Known(
    "{}.timeout",
    "Seconds after which a call of {} without an answer has failed.",
    (SHORTEST_TIME, LONGEST_TIME),
)


def lift_emergency(check: Callable[[str], None]) -> Parameter:
    """Returns whose emergencies are to be lifted, by somebody at the robot."""
    text = "JAUS address of clients that set an emergency and are gone; setting it lifts theirs."
    return Parameter("lift_emergency", "", text, check=check)


def topics(ros: RosSide, owner: str, modelled: Sequence[Topic]) -> tuple[Topic, ...]:
    """Returns the topics of a connection or join under the names that parameters give them.

    Args:
        owner: Connection, or connection and join.
    """
    if not modelled:
        return ()
    if len(modelled) == 1:
        name = ros.parameter(Parameter(f"{owner}.topic", modelled[0].name, f"Topic of {owner}."))
        return (replace(modelled[0], name=name),)

    def check(names: Sequence[str]) -> None:
        if len(names) != len(modelled):
            raise ValueError(f"{owner} has {len(modelled)} topics, not {len(names)}")

    default = [topic.name for topic in modelled]
    text = f"Topics of {owner}, in the order of the model."
    names = ros.parameter(Parameter(f"{owner}.topics", default, text, check=check))
    return tuple(replace(topic, name=name) for topic, name in zip(modelled, names, strict=True))


def peers(ros: RosSide, connection: str, modelled: PeerBinding) -> PeerBinding:
    """Returns the JAUS components at the other end of a connection.

    Args:
        modelled: Those that the model names, which a parameter may change; or how they are found.
    """
    if not modelled.present:
        return modelled
    text = f"JAUS components at the other end of {connection}."
    default = [str(peer) for peer in modelled.present]
    parameter = Parameter(f"{connection}.peers", default, text, check=addresses)
    return PeerBinding(addresses(ros.parameter(parameter)))


def address(text: str) -> JausAddress:
    """Returns the address of one component.

    Raises:
        ValueError: The text names no component, or several.
    """
    component_address = JausAddress.parse(text)
    if not component_address.is_concrete:
        raise ValueError(f"{text} does not name one component")
    return component_address


def addresses(texts: Iterable[str]) -> tuple[JausAddress, ...]:
    """Returns the addresses of several components.

    Raises:
        ValueError: A text names no component, or several.
    """
    return tuple(map(address, texts))
