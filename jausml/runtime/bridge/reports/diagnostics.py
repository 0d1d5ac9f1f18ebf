"""Counts, latencies and statuses of the connections of a bridge, and statuses of the bridge."""

from __future__ import annotations

import logging
from collections import Counter, deque
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

from ...base.address import JausAddress
from ...base.counters import Counters
from ...conversions import ConversionError
from ...services.definitions import Status
from ...services.host import GREETING_PATIENCE
from ...transports.delivery import Double
from ...wire.message import DecodeError, EncodeError
from ..messages import limits
from .states import Standing, StopReason

Take = Callable[[bytes, Any], None]
Age = Callable[[bytes, Any], "float | None"]  # seconds of a message and its origin, if known

# Reasons of losses.
LOST_IN_QUEUE = "lost_in_queue"  # messages of a topic that overflowed the queue of a subscription
MISSED = "missed"  # messages of a topic that were published and never arrived
TOO_OLD = "too_old"  # messages that waited too long in the queue, or came too late
LOST_ON_THE_WAY = "lost_on_the_way"  # reports of an event that never arrived
OUT_OF_ORDER = "out_of_order"  # reports of an event that arrived after newer ones, and were dropped
UNHEARD = "unheard"  # messages that were published on a topic without subscribers
THINNED = "thinned"  # messages that were left out, as the model or parameters limit their rate
NOT_LOST = frozenset([UNHEARD, THINNED])  # those that are no faults

DOUBLE_LIFETIME = 10.0  # seconds for which a component with the same address is an error
_LEVELS = {Status.EMERGENCY: "warning", Status.FAILURE: "error"}


@dataclass(slots=True)
class Statistics:
    """Counts of one connection. Times are those of a steady clock."""

    arrivals: int = 0
    passed: int = 0
    alone: int = 0  # of `passed`, those by the compiled core without Python
    thinned: int = 0  # left out, as the model or parameters limit the rate
    safe_values: int = 0  # sent because the source was lost
    stops: Counter[StopReason] = field(default_factory=Counter)
    limited: int = 0
    # Values that did not fit their target field, by policy and field.
    out_of_range: Counter[tuple[str, str]] = field(default_factory=Counter)
    errors: int = 0
    drops: Counter[str] = field(default_factory=Counter)
    # The first error of each reason for which a message could not be translated.
    failures: dict[str, str] = field(default_factory=dict)
    # Messages that were passed on to other peers only, by the peer that did not obey.
    withheld: Counter[JausAddress] = field(default_factory=Counter)
    last_arrival: float | None = None  # seconds, None before the first message
    heard: float = 0.0  # time of the last usable message, or of the begin of the watch for silence


@dataclass(frozen=True, slots=True)
class ConnectionStatus:
    """State of a connection for `/diagnostics`."""

    name: str
    level: str  # `ok`, `warning`, `error` or `stale`
    message: str
    hardware_id: str
    values: tuple[tuple[str, str], ...]


def state_status(hardware_id: str, standing: Standing, controller: str) -> ConnectionStatus:
    """Returns the status of the bridge itself; `controller` is empty without one."""
    node, jaus = ("active" if standing.is_active else "inactive"), standing.status.name.lower()
    level = _LEVELS.get(standing.status, "ok" if standing.is_active else "stale")
    values = (("node", node), ("jaus", jaus), ("controller", controller or "none"))
    return ConnectionStatus("jaus state", level, f"{node}, {jaus}", hardware_id, values)


def double_status(double: Double, now: float) -> ConnectionStatus:
    """Returns the status of a bridge whose address another component uses too."""
    age = now - double.last_heard
    values = (("place", double.place), ("age (s)", f"{age:.3f}"))
    level = "error" if age < DOUBLE_LIFETIME else "warning"
    return ConnectionStatus("jaus id", level, str(double), str(double.address), values)


def greeting_status(unanswered: Mapping[JausAddress, int], hardware_id: str) -> ConnectionStatus:
    """Returns the status of greetings, by the number of unanswered ones to each peer."""
    silent = [str(peer) for peer, tries in unanswered.items() if tries >= GREETING_PATIENCE]
    message = f"no answer of {', '.join(silent)}" if silent else "running"
    values = tuple((f"greetings to {peer}", str(tries)) for peer, tries in unanswered.items())
    level = "warning" if silent else "ok"
    return ConnectionStatus("jaus greetings", level, message, hardware_id, values)


def guardian_status(description: str, failure: str, hardware_id: str) -> ConnectionStatus:
    """Returns the status of the guardian of a bridge; `failure` is empty while it runs."""
    level, message = ("error", f"it {failure}") if failure else ("ok", description)
    return ConnectionStatus("guardian", level, message, hardware_id, ())


def traffic_status(
    counts: Mapping[str, int], former: Mapping[str, int], hardware_id: str
) -> ConnectionStatus:
    """Returns the status of messages dropped before any connection: present and former counts."""
    new = [name for name, count in counts.items() if count > former.get(name, 0)]
    level, message = ("warning", ", ".join(new)) if new else ("ok", "running")
    values = tuple((f"dropped: {name}", str(count)) for name, count in counts.items())
    return ConnectionStatus("jaus traffic", level, message, hardware_id, values)


def socket_status(drops: int, hardware_id: str, *, is_new: bool) -> ConnectionStatus:
    """Returns the status of datagrams that the kernel dropped, as its buffer was full."""
    level, message = ("warning", "datagrams are lost") if is_new else ("ok", "running")
    values = (("dropped by the kernel", str(drops)),)
    return ConnectionStatus("jaus socket", level, message, hardware_id, values)


WINDOW = 1000  # number of messages for percentiles


class Latency:
    """Ages and handling times of the latest messages.

    The age of a message is the time from the stamp of its source until the bridge takes it, by the
    clocks of both computers. The handling time is that from then until it was delivered.
    """

    def __init__(self, age: Age, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._age = age
        self._ages: deque[float] = deque(maxlen=WINDOW)
        self._handling: deque[float] = deque(maxlen=WINDOW)

    def measure(self, pass_on: Take, data: bytes, origin: Any, counts: Statistics) -> None:
        """Calls `pass_on` with a message, and records age and time if the message was passed."""
        start, passed = self._clock(), counts.passed
        pass_on(data, origin)
        handling = self._clock() - start
        if counts.passed > passed:
            self._handling.append(handling)
            age = self._age(data, origin)
            if age is not None:
                self._ages.append(age - handling)

    def describe(self) -> list[tuple[str, str]]:
        """Returns names and values for diagnostics; none before the first message."""
        return [
            *_percentiles("source to bridge", self._ages),
            *_percentiles("in the bridge", self._handling),
        ]


def _percentiles(name: str, seconds: Sequence[float]) -> list[tuple[str, str]]:
    ranked = sorted(seconds)
    if not ranked:
        return []
    last = len(ranked) - 1
    shown = (("p50", last * 50 // 100), ("p99", last * 99 // 100), ("max", last))
    return [(f"{name} {word} (us)", f"{ranked[rank] * 1e6:.1f}") for word, rank in shown]


T = TypeVar("T")

# Reasons of drops, and the counter of blocking translations.
BLOCKED = "blocked"
FAILED = "translation_failed"
OUT_OF_RANGE = "out_of_range"
FILTERED = "filtered"
STALE_JOIN = "stale_join"

_REASONS: tuple[tuple[type[Exception], str], ...] = (
    (limits.AbsentFieldError, "absent_field"),
    (ConversionError, "no_counterpart"),
    (EncodeError, "not_encodable"),
    (DecodeError, "not_decodable"),
)
FAILURES = frozenset([FAILED, *(reason for _, reason in _REASONS)])  # for any values


def reason_of(error: Exception) -> str:
    """Returns the name under which a message is counted whose translation raised an error."""
    if isinstance(error, limits.OutOfRangeError):
        return OUT_OF_RANGE
    if isinstance(error, limits.StaleJoinError):
        return f"{STALE_JOIN}_{error.join}"
    return next((reason for kind, reason in _REASONS if isinstance(error, kind)), FAILED)


class Limiting:
    """The limits that translations apply to values, and the counts of values that do not fit."""

    name: str
    statistics: Statistics
    counters: Counters
    filters: bool = False  # whether the policy `drop_message` is a filter, and no fault

    def __init__(self) -> None:
        """Counts in the statistics alone until the bridge is open."""
        self.clamp = limits.Clamp(self._note_out_of_range)
        self.drop_field = limits.DropField(self._note_out_of_range)
        self.drop_message = limits.DropMessage(self._note_out_of_range)
        self.error = limits.Error(self._note_out_of_range)
        self._is_open = False

    def by_name(
        self, names: Collection[str], keys: Sequence[str], values: Sequence[T], needed: str
    ) -> list[T | None]:
        """Returns values in the order of names; raises AbsentFieldError for a missing one."""
        return limits.by_name(names, keys, values, needed)

    def drop(self, reason: str, detail: str = "", error: Exception | None = None) -> None:
        """Counts a message that is not passed on."""
        self.statistics.drops[reason] += 1
        self.counters.count(f"bridge.{self.name}.{reason}", detail, error=error)

    def refuse(self, reason: str, detail: str = "") -> None:
        """Counts a message that is refused unread."""
        self.statistics.arrivals += 1
        self.drop(reason, detail)

    def _note_out_of_range(self, policy: str, field: str, reason: str) -> None:
        """Counts a value that does not fit its target field.

        An omitted field is not logged, since ROS marks unknown values like this. Clamping is logged
        once, and at the end of the process. A dropped message is logged.
        """
        self.statistics.out_of_range[policy, field] += 1
        self.statistics.limited += policy == limits.CLAMP
        if not self._is_open:  # a translation in a test
            return
        name = f"bridge.{self.name}.{OUT_OF_RANGE}.{policy}.{field}"
        if policy == limits.DROP_FIELD:
            self.counters.add(name)
        else:
            level = logging.ERROR if policy == limits.ERROR else logging.WARNING
            self.counters.count(name, reason, level=level, once=policy == limits.CLAMP)

    def note_blocking(self, seconds: float) -> None:
        """Counts a translation that blocked the loop."""
        detail = f"the translation took {seconds:.1f} s; nothing was received meanwhile"
        self.counters.count(f"bridge.{self.name}.{BLOCKED}", detail)

    def _refuse(self, error: limits.OutOfRangeError) -> None:
        """Counts a message that is dropped because of a value."""
        drops = self.statistics.drops
        if self.filters and error.policy == limits.DROP_MESSAGE:
            drops[FILTERED] += 1
            return
        drops[OUT_OF_RANGE] += 1
        self.statistics.errors += error.policy == limits.ERROR
        self._note_out_of_range(error.policy, error.field, str(error))

    def fail(self, error: Exception) -> None:
        """Counts a message that could not be translated or delivered."""
        if isinstance(error, limits.OutOfRangeError):
            self._refuse(error)
            return
        if isinstance(error, limits.StaleJoinError):
            self.drop(reason_of(error), str(error))
            return
        reason = reason_of(error)
        text = repr(error) if reason == FAILED else str(error)
        self.statistics.failures.setdefault(reason, text)
        self.drop(reason, text, error if reason == FAILED else None)
