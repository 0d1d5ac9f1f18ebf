"""Parameters of a bridge, by which a deployment changes it without generating again.

A parameter has the value of the model unless a parameter file, the command line or, for those that
may change at run time, `ros2 param set` gives another one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from ...base.address import JausAddress
from ...base.settings import LIMITS, OPTIONS, option_values
from ...clients.peer_binding import PeerBinding
from ...services.definitions import MAX_EVENT_RATE, server_type
from .ends import BridgeSettings
from .ros_side import RosSide
from .topics import Parameter, Topic

T = TypeVar("T")

LEAST = 1e-9  # least value of a number that is above 0
GREATEST = 1.7976931348623157e308  # greatest number
GREATEST_SPEED = 327.67  # metres per second that a speed of AS6009 can say
LONGEST_TIME = 3600.0  # longest time in seconds that a parameter takes

LONGEST_FRESHNESS = 1e9  # longest freshness in seconds: for ever, where a message holds a state
SHORTEST_TIME = 0.001  # shortest freshness, and shortest time of a call, in seconds
LEAST_RATE = 0.02  # least rate in hertz of an event or a query
LEAST_MAX_RATE = 0.001  # least rate in hertz above which messages are thinned out, besides 0
GREATEST_DECIMATION = 1_000_000  # most messages of which one passes
LEAST_DIAGNOSTICS = 0.01  # least number of diagnostics each second

# Seconds that a ROS message may wait in the queue of the bridge: far more than in normal operation,
# also while the bridge starts. After a longer stall older commands must not be obeyed.
QUEUE_AGE_LIMIT = 2.0


@dataclass(frozen=True)
class AttributeParameter:
    """A parameter that sets an attribute of the bridge, also while it runs."""

    name: str
    attribute: str
    description: str
    is_positive: bool = False  # whether a number is above 0

    def of(self, value: Any) -> Parameter:
        """Returns the parameter of the node, with the present value of the attribute."""
        lowest = LEAST if self.is_positive else -GREATEST
        limits = (lowest, GREATEST) if isinstance(value, float) else None
        return Parameter(self.name, value, self.description, limits)


def network(model: BridgeSettings) -> tuple[Parameter, ...]:
    """Returns the parameters of address and transport, with the names of command line options."""
    values = option_values(model.transport)
    options = {name: option for group in OPTIONS.values() for name, option in group.items()}
    return (
        Parameter("jaus_id", str(model.address), "JAUS address of the bridge.", check=address),
        *(
            Parameter(
                f"jaus_{name}", values[name], f"{_description(option)}.", LIMITS.get(name), check
            )
            for name, option in options.items()
            if name not in _OPTIONS_ONLY
            for check in (_choice(option["choices"]) if "choices" in option else None,)
        ),
    )


_OPTIONS_ONLY = ("peer", "node_manager_directory")  # options that are no parameters


def _description(option: Mapping[str, Any]) -> str:
    """Returns the help of an option with a capital letter, without its default."""
    text: str = option["help"].partition(" (default")[0]
    return text[:1].upper() + text[1:]


def _choice(words: Sequence[str]) -> Callable[[str], None]:
    def check(word: str) -> None:
        if word not in words:
            raise ValueError(f"{word} is none of {', '.join(words)}")

    return check


def digital_resources(urls: Sequence[str]) -> Parameter:
    """Returns the parameter with the URLs of the bridge for Digital Resource Discovery."""

    def check(text: str) -> None:
        for word in text.split():
            server_type(word)

    text = "URLs of streams and files, such as rtsp://10.0.0.7/front, with spaces between them."
    return Parameter("jaus_digital_resources", " ".join(urls), text, check=check)


@dataclass(frozen=True)
class Template:
    """A parameter without its value and the connection that it belongs to."""

    name: str  # `{}` stands for the connection, or the connection and join
    description: str
    limits: tuple[float, float] | None = None
    check: Callable[[Any], object] | None = None

    def of(self, value: Any, owner: str = "") -> Parameter:
        """Returns the parameter of the node, or of a connection."""
        text = self.description.format(owner)
        return Parameter(self.name.format(owner), value, text, self.limits, self.check)


def _check_rate(hertz: float) -> None:
    if 0 < hertz < LEAST_MAX_RATE:
        raise ValueError(f"{hertz:g} Hz is neither 0 nor {LEAST_MAX_RATE:g} Hz or more")


MAX_EVENTS = Template("jaus_max_events", "JAUS events at a time.", (1, 255))
EVENT_RATE_BUDGET = Template(
    "jaus_event_rate_budget",
    "Reports of all periodic JAUS events together each second.",
    (1.0, 255 * MAX_EVENT_RATE),
)
AUTHORITY = Template(
    "jaus_authority", "Authority that control of JAUS components is requested with.", (0, 255)
)
DIAGNOSTICS_FREQUENCY = Template(
    "diagnostics_frequency", "Diagnostics published each second (Hz).", (LEAST_DIAGNOSTICS, 100.0)
)
FREQUENCY = Template(
    "frequency",
    "Messages each second of the connections that state no rate (Hz).",
    (0.0, MAX_EVENT_RATE),
)
AUTOSTART = Template(
    "autostart", "Whether the node becomes active by itself; if not, it waits unconfigured."
)
QUEUE_AGE = Template(
    "queue_age_limit",
    "Seconds after which a message of a topic that is not latched is too old to be taken.",
    (0.0, LONGEST_TIME),
)
COMPILED = Template("compiled", "Whether compiled translations are used where they are built.")

RATE = Template(
    "{}.rate", "Messages of the connection {} each second (Hz).", (LEAST_RATE, MAX_EVENT_RATE)
)
SILENCE_TIMEOUT = Template(
    "{}.silence_timeout",
    "Seconds without a message that count as silence of the source of {}.",
    (0.0, LONGEST_TIME),
)
MAX_RATE = Template(
    "{}.max_rate",
    "Messages of {} that pass each second at most (Hz); 0 is all.",
    (0.0, GREATEST),
    _check_rate,
)
RATE_CAP = Template(
    "{}.rate_cap",
    "Messages of {} that are taken of one source each second (Hz); 0 is all.",
    (0.0, GREATEST),
    _check_rate,
)
DECIMATION = Template(
    "{}.decimation", "Every how many messages of {} one passes.", (1, GREATEST_DECIMATION)
)
AGE_LIMIT = Template(
    "{}.age_limit",
    "Seconds after which a message of {} is too old to pass; 0 is never.",
    (0.0, LONGEST_TIME),
)
LATENCY = Template("{}.latency", "Whether the latency of {} is measured.")
ALL_LATENCY = Template("latency", "Whether the latency of all is measured.")
FRESHNESS = Template(
    "{}.freshness",
    "Seconds after which the latest message of {} is stale.",
    (SHORTEST_TIME, LONGEST_FRESHNESS),
)
SPEED = Template(
    "{}.speed", "Speed at which the lists of {} are executed (m/s).", (0.0, GREATEST_SPEED)
)
TIMEOUT = Template(
    "{}.timeout",
    "Seconds after which a call of {} without an answer has failed.",
    (SHORTEST_TIME, LONGEST_TIME),
)


def lift_emergency(check: Callable[[str], None]) -> Parameter:
    """Returns the parameter by which a person at the robot lifts emergencies of a client."""
    text = "JAUS address of clients that set an emergency and are gone; setting it lifts theirs."
    return Parameter("lift_emergency", "", text, check=check)


def topics(ros: RosSide, owner: str, modelled: Sequence[Topic]) -> tuple[Topic, ...]:
    """Returns the topics of a connection, or of its join, with their names from parameters."""
    if not modelled:
        return ()
    if len(modelled) == 1:
        name = ros.parameter(Parameter(f"{owner}.topic", modelled[0].name, f"Topic of {owner}."))
        return (replace(modelled[0], name=name),)

    def check(names: Sequence[str]) -> None:
        if len(names) != len(modelled):
            raise ValueError(f"{owner} has {len(modelled)} topics, not {len(names)}")
        _each_once(names)

    default = [topic.name for topic in modelled]
    text = f"Topics of {owner}, in the order of the model."
    names = ros.parameter(Parameter(f"{owner}.topics", default, text, check=check))
    return tuple(replace(topic, name=name) for topic, name in zip(modelled, names, strict=True))


def peers(ros: RosSide, connection: str, modelled: PeerBinding) -> PeerBinding:
    """Returns the peers of a connection: a search, or named ones, which a parameter may change."""
    if not modelled.present:
        return modelled
    text = f"JAUS components at the other end of {connection}."
    default = [str(peer) for peer in modelled.present]
    parameter = Parameter(f"{connection}.peers", default, text, check=addresses)
    return PeerBinding(addresses(ros.parameter(parameter)))


def address(text: str) -> JausAddress:
    """Returns the address of one component; raises ValueError for no address or a wildcard."""
    component_address = JausAddress.parse(text)
    if not component_address.is_concrete:
        raise ValueError(f"{text} does not name one component")
    return component_address


def addresses(texts: Iterable[str]) -> Sequence[JausAddress]:
    """Returns addresses of components; raises ValueError as `address`, or for two equal ones."""
    return _each_once(tuple(map(address, texts)))


def _each_once(values: Sequence[T]) -> Sequence[T]:
    """Returns values; raises ValueError if one is there twice, as messages would pass twice."""
    for place, value in enumerate(values):
        if value in values[:place]:
            raise ValueError(f"{value} is there twice")
    return values
