"""Connection of a bridge: takes a message, translates it, hands it over.

All of it happens on the thread on which the message arrived. What is lost is counted under a
reason; nothing that a message contains, and nothing that an overridden method does, ends the
thread.
"""

from __future__ import annotations

import logging
import time
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from ..conversions import ConversionError
from ..wire.message import DecodeError, EncodeError
from . import parameters
from .diagnostics import ConnectionStatus, Statistics
from .errors import AbsentFieldError, OutOfRangeError, StaleJoinError
from .limits import CLAMP, DROP_FIELD, ERROR, Clamp, DropField, DropMessage, Error

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from ..base.counters import Counters
    from ..base.loop import Timer
    from .ends import Ends
    from .quality import TopicFault

SourceT = TypeVar("SourceT")
TargetT = TypeVar("TargetT")

FILTERED = "filtered"
FAILED = "translation_failed"
NOT_READY = "not_ready"
NO_PEER = "no_peer"
OUT_OF_RANGE = "out_of_range"
STALE_JOIN = "stale_join"

_REASONS: tuple[tuple[type[Exception], str], ...] = (
    (AbsentFieldError, "absent_field"),
    (ConversionError, "no_counterpart"),
    (EncodeError, "not_encodable"),
    (DecodeError, "not_decodable"),
)


class Connection(Generic[SourceT, TargetT]):
    """What the connections of both directions have in common.

    Attributes:
        name: Name of the connection in the model.
        statistics: What happened so far.
        clamp: Moves values into the range of their target field.
        drop_field: Leaves fields out whose value is out of range.
        drop_message: Drops messages with a value out of range.
        error: Does the same, as an error.
        silence_timeout: Seconds without a message after which the safe value is sent; 0: never.
    """

    def __init__(
        self,
        name: str,
        translate: Callable[[SourceT], TargetT | None],
        *,
        silence_timeout: float = 0.0,
        safe_value: Callable[[], TargetT] | None = None,
    ) -> None:
        """Prepares a connection; nothing is exchanged before `open`.

        Args:
            name: Name of the connection in the model.
            translate: Makes the target message, or None to pass nothing on.
            silence_timeout: Seconds without a message that count as silence; 0 means never.
            safe_value: Makes the message that is sent once when the source is silent.
        """
        self.name = name
        self.statistics = Statistics()
        self.clamp = Clamp(self._note_out_of_range)
        self.drop_field = DropField(self._note_out_of_range)
        self.drop_message = DropMessage(self._note_out_of_range)
        self.error = Error(self._note_out_of_range)
        self.silence_timeout = silence_timeout
        self.is_silent = False
        self._translate = translate
        self._safe_value = safe_value
        self._heard = 0.0
        self._watch: Timer | None = None
        self._ends: Ends
        self._counters: Counters | None = None
        self._faults: list[TopicFault] = []
        self._reported: tuple[float, int, int, int, int] | None = None

    # ------------------------------------------------------------------ for the kinds

    def open(self, ends: Ends) -> None:
        """Makes the publishers and subscriptions of the connection.

        Args:
            ends: The bridge, whose two sides are there.
        """
        self._ends = ends
        self._counters = ends.component.counters
        self.silence_timeout = ends.ros.parameter(
            parameters.silence_timeout(self.name, self.silence_timeout), self._set_silence_timeout
        )

    def deliver(self, target: TargetT) -> bool:
        """Hands a message to the target side; False when it was dropped and counted."""
        raise NotImplementedError

    def describe_peers(self) -> list[tuple[str, str]]:
        """Names and states of the other ends, for diagnostics."""
        raise NotImplementedError

    def lacks_peers(self) -> str:
        """What the connection searches for and has not found, empty when it lacks nothing."""
        return ""

    def describe_joins(self) -> list[tuple[str, str]]:
        """Names and ages of the joined topics, for diagnostics."""
        return []

    def topic_faults(self) -> Iterable[TopicFault]:
        """What is wrong with the topics at present."""
        return ()

    @property
    def declared_rate(self) -> float:
        """Messages each second that the model promises; 0 when it promises none."""
        return 0.0

    # ------------------------------------------------------------------ messages

    def take(self, source: SourceT) -> None:
        """Takes one message from the source and passes its translation on."""
        started = time.monotonic_ns()
        self.statistics.arrivals += 1
        self.statistics.last_arrival = self._ends.loop.now()
        try:
            target = self._translate(source)
            # A source that sends nothing usable is as good as silent.
            self._note_usable()
            if target is None:
                self.drop(FILTERED)
            elif self.deliver(target):
                self.statistics.handled(time.monotonic_ns() - started)
        except Exception as error:
            self._failed(error)

    def drop(self, reason: str, detail: str = "", error: Exception | None = None) -> None:
        """Counts a message that is not passed on."""
        drops = self.statistics.drops
        drops[reason] = drops.get(reason, 0) + 1
        self._ends.component.counters.count(f"bridge.{self.name}.{reason}", detail, error=error)

    def _note_out_of_range(self, policy: str, field: str, reason: str) -> None:
        """Counts a value that its target field cannot carry.

        A value that is left out is ordinary traffic: ROS marks what is unknown by values that no
        JAUS field carries. One that is clamped stands for another one, of which the log tells once
        and the end of the process again. What is dropped goes into the log.
        """
        counts = self.statistics.out_of_range
        counts[policy, field] = counts.get((policy, field), 0) + 1
        self.statistics.limited += policy == CLAMP
        if self._counters is None:  # a translation that is tried before the bridge is open
            return
        name = f"bridge.{self.name}.{OUT_OF_RANGE}.{policy}.{field}"
        if policy == DROP_FIELD:
            self._counters.add(name)
        else:
            level = logging.ERROR if policy == ERROR else logging.WARNING
            self._counters.count(name, reason, level=level, once=policy == CLAMP)

    def _refuse(self, error: OutOfRangeError) -> None:
        """Counts a message that is not passed on because of one of its values."""
        drops = self.statistics.drops
        drops[OUT_OF_RANGE] = drops.get(OUT_OF_RANGE, 0) + 1
        self.statistics.errors += error.policy == ERROR
        self._note_out_of_range(error.policy, error.field, str(error))

    def _failed(self, error: Exception) -> None:
        if isinstance(error, OutOfRangeError):
            self._refuse(error)
            return
        if isinstance(error, StaleJoinError):
            self.drop(f"{STALE_JOIN}_{error.join}", str(error))
            return
        for kind, reason in _REASONS:
            if isinstance(error, kind):
                self.drop(reason, str(error))
                return
        self.drop(FAILED, repr(error), error)

    # ------------------------------------------------------------------ silence

    def watch(self) -> None:
        """Starts to watch for silence, which a source that never spoke also is."""
        self._heard = self._ends.loop.now()
        self._arm(self.silence_timeout)

    def _arm(self, delay: float) -> None:
        if self.silence_timeout > 0:
            self._watch = self._ends.loop.call_later(delay, self._check_silence)

    def _note_usable(self) -> None:
        if self.silence_timeout > 0 or self.is_silent:
            loop = self._ends.loop
            # With the lock the check either sees this message, or has sent the safe value before
            # the value that arrived.
            with loop.lock:
                self._heard = loop.now()
                if self.is_silent:
                    self.is_silent = False
                    self._arm(self.silence_timeout)

    def _check_silence(self) -> None:
        """Runs on the loop, which holds its lock."""
        remaining = self._heard + self.silence_timeout - self._ends.loop.now()
        if remaining > 0:
            self._arm(remaining)
        else:
            self.fall_silent()

    def _set_silence_timeout(self, seconds: float) -> None:
        with self._ends.loop.lock:
            self.silence_timeout = seconds
            if self._watch is not None:
                self._watch.cancel()
            if not self.is_silent:
                self.watch()

    def fall_silent(self) -> None:
        """Sends the safe value, once: the next message from the source ends the silence."""
        if self._watch is not None:
            self._watch.cancel()
        self.is_silent = True
        self.send_safe_value()

    def send_safe_value(self, deliver: Callable[[TargetT], bool] | None = None) -> None:
        """Hands the modelled safe value to the target side; nothing when there is none.

        Args:
            deliver: Hands it to a part of the target side.
        """
        if self._safe_value is None:
            return
        try:
            if (deliver or self.deliver)(self._safe_value()):
                self.statistics.safe_values += 1
        except Exception as error:
            self._failed(error)

    def on_not_ready(self) -> None:
        """The bridge left Ready; matters to connections fed by commands."""

    def on_control_lost(self) -> None:
        """The bridge's controller is another or none; matters to connections fed by commands."""

    # ------------------------------------------------------------------ diagnostics

    def status(self) -> ConnectionStatus:
        """Returns the state since the last call, for `/diagnostics`."""
        counts = self.statistics
        now = self._ends.loop.now()
        dropped = sum(counts.drops.values())
        present = (now, counts.arrivals, dropped, counts.errors, counts.limited)
        then, arrivals_then, dropped_then, errors_then, limited_then = self._reported or present
        self._reported = present
        elapsed = now - then
        rate = (counts.arrivals - arrivals_then) / elapsed if elapsed > 0 else 0.0
        level, message = self._judge(rate, measured=elapsed > 0, dropping=dropped > dropped_then)
        faults = self._told_faults()
        if faults:
            level, message = "warning", faults[0].text
        if counts.errors > errors_then:
            level, message = "error", "values out of range"
        elif counts.limited > limited_then and level == "ok":
            level, message = "warning", "values are clamped"
        age = "never" if counts.last_arrival is None else f"{now - counts.last_arrival:.3f}"
        values = [
            ("messages taken", str(counts.arrivals)),
            ("messages passed", str(counts.passed)),
            ("rate (Hz)", f"{rate:.2f}"),
            ("declared rate (Hz)", f"{self.declared_rate:.2f}"),
            ("age (s)", age),
            *self.describe_joins(),
            *((fault.kind.replace("_", " "), fault.text) for fault in faults),
            ("safe values", str(counts.safe_values)),
            ("values limited", str(counts.limited)),
            *(
                (f"out of range: {policy} {field}", str(n))
                for (policy, field), n in sorted(counts.out_of_range.items())
            ),
            *((f"dropped: {reason}", str(n)) for reason, n in sorted(counts.drops.items())),
            ("handling mean (us)", f"{counts.handling_mean / 1000:.1f}"),
            ("handling longest (us)", f"{counts.handling_longest / 1000:.1f}"),
            *self.describe_peers(),
        ]
        return ConnectionStatus(
            self.name, level, message, str(self._ends.settings.address), tuple(values)
        )

    def _told_faults(self) -> list[TopicFault]:
        """Returns the faults of the topics; the log tells of each when it begins."""
        faults = list(self.topic_faults())
        for fault in faults:
            if fault not in self._faults:
                self._ends.component.counters.count(f"bridge.{self.name}.{fault.kind}", fault.text)
        self._faults = faults
        return faults

    def _judge(self, rate: float, *, measured: bool, dropping: bool) -> tuple[str, str]:
        lacking = self.lacks_peers()
        if lacking:
            return "stale", f"searching {lacking}"
        if self.is_silent:
            return "stale", "the source is silent"
        if self.statistics.last_arrival is None:
            return "stale", "no message yet"
        if dropping:
            return "warning", "messages are dropped"
        if measured and rate < self.declared_rate / 2:
            return "warning", "slower than declared"
        return "ok", "running"


AnyConnection = Connection[Any, Any]
