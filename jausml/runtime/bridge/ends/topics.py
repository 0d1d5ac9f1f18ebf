"""Topics, services and parameters of ROS, without rclpy; faults of topics, such as unfit QoS.

ROS connects a publisher and a subscription only if the publisher offers all that the subscription
requests, by the rules of DDS. `system_default` leaves a policy to the middleware, and is taken to
fit.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any

from ...base.api import JausError
from ..light_message import LightMessage


@dataclass(frozen=True)
class Qos:
    """Quality of service in the words of ROS 2; the defaults are those of a plain publisher.

    Attributes:
        reliability: `reliable`, `best_effort` or `system_default`.
        durability: `volatile`, `transient_local` or `system_default`.
        history: `keep_last`, `keep_all` or `system_default`. A publisher keeps 5000 messages for
            `keep_all`: it must not wait for a reader that stands still.
        depth: Messages kept with `keep_last`.
        deadline: Longest expected time between messages in seconds; 0 means none.
        lifespan: Seconds after which a message is stale; 0 means never.
        liveliness: `automatic`, `manual_by_topic` or `system_default`.
        lease_duration: Seconds within which liveliness must be shown; 0 means none.
    """

    reliability: str = "reliable"
    durability: str = "volatile"
    history: str = "keep_last"
    depth: int = 10
    deadline: float = 0.0
    lifespan: float = 0.0
    liveliness: str = "automatic"
    lease_duration: float = 0.0


@dataclass(frozen=True)
class Published:
    """Topic, type and QoS of a publisher."""

    topic: str
    type: str
    qos: Qos


@dataclass(slots=True)
class TopicCounts:
    """Counts of the messages of a subscription."""

    taken: int = 0  # messages taken from its queue
    # Messages that were overwritten in the queue, or whose lifespan ended there, as the bridge was
    # too slow to take them. Known only with a listener, not with a wait set.
    lost: int = 0
    # Messages that were published and never taken, those of `lost` included. Known only while there
    # is a single publisher, as the numbers of messages do not name their publisher.
    missed: int = 0
    too_old: int = 0  # messages taken and dropped because they had waited too long


@dataclass(frozen=True)
class Topic:
    """A topic of a connection."""

    name: str  # relative ones are resolved in the namespace of the node
    qos: Qos = Qos()


@dataclass(frozen=True)
class RosService:
    """A service of ROS."""

    name: str
    type_name: str  # its type, e.g. `std_srvs/srv/SetBool`
    request: type[LightMessage]
    response: type[LightMessage]
    success: str = ""  # path of the bool of the response for success; empty without one
    reason: str = ""  # path of the text of the response for a failure; empty without one


class ParameterError(JausError):
    """A parameter of the node has a value with which the bridge cannot run."""


@dataclass(frozen=True)
class Parameter:
    """A parameter of the node."""

    name: str
    default: Any
    description: str
    limits: tuple[float, float] | None = None
    # Raises ValueError for a value that is not allowed; None allows all.
    check: Callable[[Any], object] | None = None

    def converted(self, value: Any) -> Any:
        """Returns a value in the type of the parameter, e.g. 10.0 for 10.

        Raises:
            ValueError: The value is not allowed, or is None, as rclpy has it for an empty list. The
                text names parameter, value and cure.
        """
        if isinstance(self.default, float) and type(value) is int:
            value = float(value)
        if type(value) is not type(self.default) or (isinstance(value, list) and not value):
            raise ValueError(f"{self.name} is {_as_yaml(value)}: {self._cure(value)}")
        if self.limits is not None and not self.limits[0] <= value <= self.limits[1]:
            low, high = self.limits
            raise ValueError(f"{self.name} is {value!r}; it must lie in {low:g}..{high:g}")
        try:
            if self.check is not None:
                self.check(value)
        except ValueError as error:
            raise ValueError(f"{self.name} is {_as_yaml(value)}: {error}") from error
        return value

    def _cure(self, value: Any) -> str:
        """Returns what to write instead of a value of another type."""
        if isinstance(self.default, bool):
            return "write true or false"
        if isinstance(self.default, list):
            return "write one text or more in brackets, such as [a, b]"
        if isinstance(self.default, str):
            word = "y" if value is True else "n" if value is False else value
            quoted = "" if value is None else f"; YAML needs quotes here, {self.name}:='\"{word}\"'"
            return f"write a text{quoted}"
        kind = (
            "an integer, such as 10" if isinstance(self.default, int) else "a number, such as 0.5"
        )
        return f"write {kind}" + ", without quotes" * isinstance(value, str)


def _as_yaml(value: Any) -> str:
    """Returns a value in the notation of YAML."""
    if value is None:
        return "[]"
    return str(value).lower() if isinstance(value, bool) else str(value)


INCOMPATIBLE = "incompatible_qos"
OTHER_TYPE = "other_type"
DEADLINE = "deadline_missed"
LIVELINESS = "liveliness_lost"
LARGE = "too_large_for_best_effort"
SEVERAL = "several_publishers"

_UNKNOWN = "_NODE_NAME_UNKNOWN_"  # in rclpy: a node that is found later than its publisher
LOSS_WINDOW = 10.0  # seconds for which a loss is reported


@dataclass(frozen=True)
class TopicFault:
    """Why a topic of a connection does not work as it should."""

    kind: str
    text: str


@dataclass(frozen=True)
class Conflict:
    """A policy of which a publisher offers less than a subscription requests."""

    policy: str
    offered: str | float
    requested: str | float


def conflicts(offered: Qos, requested: Qos) -> list[Conflict]:
    """Returns the policies by which a publisher and a subscription do not connect."""
    mismatches = []
    if offered.reliability == "best_effort" and requested.reliability == "reliable":
        mismatches.append(Conflict("reliability", "best_effort", "reliable"))
    if offered.durability == "volatile" and requested.durability == "transient_local":
        mismatches.append(Conflict("durability", "volatile", "transient_local"))
    if _limit(offered.deadline) > _limit(requested.deadline):
        mismatches.append(Conflict("deadline", offered.deadline, requested.deadline))
    if offered.liveliness == "automatic" and requested.liveliness == "manual_by_topic":
        mismatches.append(Conflict("liveliness", "automatic", "manual_by_topic"))
    if _limit(offered.lease_duration) > _limit(requested.lease_duration):
        mismatches.append(
            Conflict("liveliness_lease_duration", offered.lease_duration, requested.lease_duration)
        )
    return mismatches


def _limit(seconds: float) -> float:
    return seconds if seconds > 0 else math.inf


@dataclass
class EndpointHealth:
    """The state of a publisher or a subscription of the bridge, and its faults.

    ROS reports an incompatible end of another node once, when it appears. From then on `faults`
    looks up the ends of other nodes, until the incompatible one has gone.

    Attributes:
        publishes: Whether this is a publisher.
        entity: `publisher` or `subscription`, as names of parameters have it.
        others: Returns the names of nodes with the opposite ends of the topic, and their QoS.
        strangers: Returns names and types of nodes whose opposite ends have another type, while
            there are no other ends: ROS does not connect these, and reports nothing.
        counts: Counts of a subscription whose messages may be of any size; None for others.
        count: Returns the number of connected opposite ends.
    """

    publishes: bool
    topic: str
    qos: Qos
    entity: str
    others: Callable[[], Iterable[tuple[str, Qos]]]
    clock: Callable[[], float] = time.monotonic
    strangers: Callable[[], Iterable[tuple[str, str]]] = tuple
    counts: TopicCounts | None = None
    count: Callable[[], int] = lambda: 0
    _lost_before_queue: int = field(default=0, init=False)
    _last_loss: float = field(default=-math.inf, init=False)
    _incompatible_policy: str = field(default="", init=False)
    _was_seen: bool = field(default=False, init=False)
    _missed: float = field(default=-math.inf, init=False)
    _lost: float = field(default=-math.inf, init=False)

    def parameter(self, policy: str) -> str:
        """Returns the name of the parameter that changes a policy."""
        return f"qos_overrides.{self.topic}.{self.entity}.{policy}"

    def note_incompatible(self, policy: str) -> None:
        """Notes that an opposite end with an incompatible policy has appeared."""
        self._incompatible_policy, self._was_seen = policy, False

    def note_missed_deadline(self) -> None:
        """Notes that no message came, or was published, within the deadline."""
        self._missed = self.clock()

    def note_lost_liveliness(self) -> None:
        """Notes that no publisher has asserted its liveliness within the lease."""
        self._lost = self.clock() if self.publishes else math.inf

    def note_liveliness(self) -> None:
        """Notes that a publisher has asserted its liveliness."""
        self._lost = -math.inf

    def faults(self, *, alone: bool = False) -> list[TopicFault]:
        """Returns the present faults.

        A missed deadline, and a lost liveliness of an own publisher, end with the next message. ROS
        does not report that message, but each further period without one.

        Args:
            alone: Whether a second publisher of the topic is a fault.
        """
        faults = self._incompatible() if self._incompatible_policy else []
        ends = self.others() if alone and self.count() > 1 else ()
        names = sorted({name for name, _ in ends if not name.endswith(_UNKNOWN)})
        if len(names) > 1:
            text = f"{' and '.join(names)} publish on {self.topic}: the report jumps between them"
            faults.append(TopicFault(SEVERAL, text))
        faults += [
            TopicFault(OTHER_TYPE, self._type_text(*stranger)) for stranger in self.strangers()
        ]
        now = self.clock()
        if now - self._missed < self.qos.deadline + 1.0:
            verb = "was published on" if self.publishes else "came on"
            text = f"nothing {verb} {self.topic} within the deadline of {self.qos.deadline:g} s"
            faults.append(TopicFault(DEADLINE, text))
        if now - self._lost < self.qos.lease_duration + 1.0:
            lease = f"within the lease of {self.qos.lease_duration:g} s"
            text = f"no publisher of {self.topic} showed that it is alive {lease}"
            faults.append(TopicFault(LIVELINESS, text))
        if self._loses_large(now):
            cure = (
                f"set qos: {{ reliability: reliable }} or {self.parameter('reliability')}:=reliable"
            )
            text = f"messages of {self.topic} are lost on the way: it is best_effort, which loses"
            faults.append(TopicFault(LARGE, f"{text} what is larger than 512 kB; {cure}"))
        return faults

    def _loses_large(self, now: float) -> bool:
        """Returns whether messages of a reliable publisher were lost before the queue lately."""
        if self.counts is None or self.qos.reliability != "best_effort":
            return False
        lost = self.counts.missed - self.counts.lost
        if lost > self._lost_before_queue:
            self._lost_before_queue, self._last_loss = lost, now
        is_recent = now - self._last_loss < LOSS_WINDOW
        return is_recent and any(qos.reliability == "reliable" for _, qos in self.others())

    def _incompatible(self) -> list[TopicFault]:
        faults = [
            TopicFault(INCOMPATIBLE, self._conflict_text(name, conflict))
            for name, qos in self.others()
            for conflict in self._conflicts(qos)
        ]
        if faults:
            self._was_seen = True
        elif self._was_seen:
            self._incompatible_policy = ""
        else:
            other = "a subscription" if self.publishes else "a publisher"
            text = (
                f"{other} of {self.topic} does not fit by its {self._incompatible_policy.lower()}"
            )
            faults.append(TopicFault(INCOMPATIBLE, text))
        return faults

    def _type_text(self, name: str, kind: str) -> str:
        verb = "subscribes to" if self.publishes else "publishes"
        cure = "give the map that type, or remap one of them to another topic"
        return f"{name} {verb} {self.topic} as {kind}, which is another type: {cure}"

    def _conflicts(self, other: Qos) -> list[Conflict]:
        return conflicts(self.qos, other) if self.publishes else conflicts(other, self.qos)

    def _conflict_text(self, name: str, conflict: Conflict) -> str:
        offered, requested = (_shown(value) for value in (conflict.offered, conflict.requested))
        if self.publishes:
            head = f"{name} gets nothing from {self.topic}: it requests"
            text = f"{head} {conflict.policy} {requested}, offered is {offered}"
            cure = conflict.requested
        else:
            head = f"nothing comes from {name} on {self.topic}: it offers"
            text = f"{head} {conflict.policy} {offered}, requested is {requested}"
            cure = conflict.offered
        if conflict.policy not in ("reliability", "durability"):
            return text
        parameter = self.parameter(conflict.policy)
        return f"{text}; set qos: {{ {conflict.policy}: {cure} }} or {parameter}:={cure}"


def _shown(value: str | float) -> str:
    if isinstance(value, str):
        return value
    return f"{value:g} s" if value > 0 else "none"


def nearest(name: str, known: Iterable[str]) -> str:
    """Returns the known name that is most like a misspelt one; empty when none is like it."""
    from difflib import get_close_matches  # noqa: PLC0415 - rarely needed, and takes memory

    return next(iter(get_close_matches(name, list(known), n=1)), "")
