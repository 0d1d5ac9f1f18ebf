"""Counts, latencies and reports of a connection of a bridge."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from ...clients.discovery_client import PATIENCE
from ...conversions import ConversionError, Time, timestamp_to_time
from ...services.definitions import Status

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from ...base.address import JausAddress
    from ...transports.delivery import Double
    from ...wire.message import Message
    from .states import Standing, StopReason

    Take = Callable[[bytes, Any], None]
    Age = Callable[[bytes, Any], "int | None"]


LOST_IN_QUEUE = "lost_in_queue"
"""Messages of a topic that the queue of its subscription had no room for."""

MISSED = "missed"
"""Messages of a topic that were published and never arrived."""

TOO_OLD = "too_old"
"""Messages that waited too long in the queue of their subscription, or came too late."""

LOST_ON_THE_WAY = "lost_on_the_way"
"""Reports of an event that never arrived, by the gaps between sequence numbers."""

OUT_OF_ORDER = "out_of_order"
"""Reports of an event that arrived after newer ones, and were dropped."""

UNHEARD = "unheard"
"""Messages that were published while nobody subscribed to their topic."""

THINNED = "thinned"
"""Messages that gave way to others, because fewer were wanted."""

NOT_LOST = frozenset([UNHEARD, THINNED])
"""Counts that tell of no loss: of what nobody is there for, and of what nobody wants."""

DOUBLE_LIFETIME = 10.0
"""Seconds after which a component with the same address that was heard no more is history."""


_LEVELS = {Status.EMERGENCY: "warning", Status.FAILURE: "error"}


@dataclass(slots=True)
class Statistics:
    """Counts of one connection. Times are those of a steady clock.

    Attributes:
        alone: Messages of those that passed that a compiled core has passed on alone.
        thinned: Messages that gave way to others, as the model or parameters want it.
        safe_values: Safe values sent because the source was lost.
        out_of_range: Values that their target field could not carry, by policy and field.
        failures: What was wrong with the first message of each reason that no message passes for.
        withheld: Messages that were passed on to other peers, but not to one that did not obey.
        last_arrival: Seconds, None before the first message.
        heard: When the source last said something usable, or silence was last looked for.
    """

    arrivals: int = 0
    passed: int = 0
    alone: int = 0
    thinned: int = 0
    safe_values: int = 0
    stops: dict[StopReason, int] = field(default_factory=dict)
    limited: int = 0
    out_of_range: dict[tuple[str, str], int] = field(default_factory=dict)
    errors: int = 0
    drops: dict[str, int] = field(default_factory=dict)
    failures: dict[str, str] = field(default_factory=dict)
    withheld: dict[JausAddress, int] = field(default_factory=dict)
    last_arrival: float | None = None
    heard: float = 0.0


@dataclass(frozen=True, slots=True)
class ConnectionStatus:
    """State of a connection for `/diagnostics`.

    Attributes:
        level: `ok`, `warning`, `error` or `stale`.
        values: Names and values in the order in which they are shown.
    """

    name: str
    level: str
    message: str
    hardware_id: str
    values: tuple[tuple[str, str], ...]


def state_status(hardware_id: str, standing: Standing, controller: str) -> ConnectionStatus:
    """Returns the status of the bridge itself.

    Args:
        controller: JAUS address of the controller; empty without one.
    """
    node, jaus = ("active" if standing.is_active else "inactive"), standing.status.name.lower()
    level = _LEVELS.get(standing.status, "ok" if standing.is_active else "stale")
    values = (("node", node), ("jaus", jaus), ("controller", controller or "none"))
    return ConnectionStatus("jaus state", level, f"{node}, {jaus}", hardware_id, values)


def double_status(double: Double, now: float) -> ConnectionStatus:
    """Returns the status of a bridge whose address somebody else was heard with."""
    age = now - double.last_heard
    values = (("place", double.place), ("age (s)", f"{age:.3f}"))
    level = "error" if age < DOUBLE_LIFETIME else "warning"
    return ConnectionStatus("jaus id", level, str(double), str(double.address), values)


def greeting_status(unanswered: Mapping[JausAddress, int], hardware_id: str) -> ConnectionStatus:
    """Returns the status of a bridge that greets peers."""
    silent = [str(peer) for peer, tries in unanswered.items() if tries >= PATIENCE]
    message = f"no answer of {', '.join(silent)}" if silent else "running"
    values = tuple((f"greetings to {peer}", str(tries)) for peer, tries in unanswered.items())
    level = "warning" if silent else "ok"
    return ConnectionStatus("jaus greetings", level, message, hardware_id, values)


def guardian_status(told: str, failure: str, hardware_id: str) -> ConnectionStatus:
    """Returns the status of the guardian of a bridge."""
    level = "error" if failure else "ok"
    message = f"it {failure}: nothing stops the robot if this bridge dies" if failure else told
    return ConnectionStatus("guardian", level, message, hardware_id, ())


def traffic_status(
    counts: Mapping[str, int], former: Mapping[str, int], hardware_id: str
) -> ConnectionStatus:
    """Returns the status of what was dropped on the JAUS side, before any connection."""
    new = [name for name, count in counts.items() if count > former.get(name, 0)]
    level, message = ("warning", ", ".join(new)) if new else ("ok", "running")
    values = tuple((f"dropped: {name}", str(count)) for name, count in counts.items())
    return ConnectionStatus("jaus traffic", level, message, hardware_id, values)


def socket_status(drops: int, hardware_id: str, *, is_new: bool) -> ConnectionStatus:
    """Returns the status of a bridge for whose sockets the kernel had no room."""
    level, message = ("warning", "datagrams are lost") if is_new else ("ok", "running")
    values = (("dropped by the kernel", str(drops)),)
    return ConnectionStatus("jaus socket", level, message, hardware_id, values)


WINDOW = 1000
"""Latest messages of which percentiles are told."""


class Latency:
    """Ages and handling times of the latest messages.

    A message's age is the time from the stamp of its source to the bridge, by the clocks of both
    computers; its handling time is that from when the bridge takes it until the target side has it.
    """

    def __init__(self, age: Age, clock: Callable[[], float]) -> None:
        """Has measured nothing yet.

        Args:
            age: Returns the age in nanoseconds of a message that arrives now, of its bytes and
                its origin; None when its source states no time.
        """
        self._clock = clock
        self._age = age
        self._ages: deque[int] = deque(maxlen=WINDOW)
        self._handling: deque[int] = deque(maxlen=WINDOW)

    def measuring(self, take: Take, counts: Statistics) -> Take:
        """Returns what takes messages as `take` does, and measures those that are passed on."""
        clock = self._clock
        note_age, note_handling, age_of = self._ages.append, self._handling.append, self._age

        def measured(data: bytes, origin: Any = None) -> None:
            begun, passed = clock(), counts.passed
            take(data, origin)
            handling = round((clock() - begun) * 1e9)
            if counts.passed > passed:
                note_handling(handling)
                age = age_of(data, origin)
                if age is not None:
                    note_age(age - handling)

        return measured

    def describe(self) -> list[tuple[str, str]]:
        """Names and values for diagnostics; none before the first message."""
        return [
            *_percentiles("source to bridge", self._ages),
            *_percentiles("in the bridge", self._handling),
        ]


def _percentiles(name: str, nanoseconds: Sequence[int]) -> list[tuple[str, str]]:
    ranked = sorted(nanoseconds)
    if not ranked:
        return []
    last = len(ranked) - 1
    shown = (("p50", last * 50 // 100), ("p99", last * 99 // 100), ("max", last))
    return [(f"{name} {word} (us)", f"{ranked[rank] / 1000:.1f}") for word, rank in shown]


def age_of_stamp(message: Message, now: int) -> int | None:
    """Returns the age of a JAUS message in nanoseconds; None if it has no TimeStamp.

    Args:
        now: Time of day in nanoseconds since 1970.
    """
    stamp = getattr(message, "time_stamp", None)
    if stamp is None:
        return None
    try:
        sent = timestamp_to_time(stamp, near=Time(*divmod(now, 10**9)))
    except ConversionError:
        return None
    return now - sent.sec * 10**9 - sent.nanosec


def age_of_time(nanoseconds: int, now: int) -> int | None:
    """Returns the age of a ROS message in nanoseconds; None if it has no stamp.

    Args:
        nanoseconds: When its publisher has sent it, since 1970.
        now: Time of day in nanoseconds since 1970.
    """
    return now - nanoseconds if nanoseconds else None
