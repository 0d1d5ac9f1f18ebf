"""Connection of a bridge: takes a message, translates it, hands it over.

All of it happens on the thread on which the message arrived. What is lost is counted under a
reason; nothing that a message contains, and nothing that an overridden method does, ends the
thread.
"""

from __future__ import annotations

import logging
import time
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from ..base.counters import LOGGER
from ..conversions import ConversionError
from ..wire.message import DecodeError, EncodeError
from . import parameters
from .diagnostics import ConnectionStatus, Statistics
from .errors import AbsentFieldError, OutOfRangeError, StaleJoinError
from .limits import CLAMP, DROP_FIELD, ERROR, Clamp, DropField, DropMessage, Error
from .stops import StopReason

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from ..base.counters import Counters
    from ..base.loop import Timer
    from .ends import Ends
    from .quality import TopicFault
    from .stops import Standing

SourceT = TypeVar("SourceT")
TargetT = TypeVar("TargetT")

FILTERED = "filtered"
FAILED = "translation_failed"
NOT_READY = "not_ready"
NO_PEER = "no_peer"
OUT_OF_RANGE = "out_of_range"
STALE_JOIN = "stale_join"

_LOG_INTERVAL = 5.0
"""Seconds between two lines of the log about the silence of one connection."""

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
        is_command: Whether its messages set something in motion, which must not outlive its source.
        stopped: Why the safe value stands on the target side; None while messages of the source do.
    """

    def __init__(
        self,
        name: str,
        translate: Callable[[SourceT], TargetT | None],
        *,
        is_command: bool = False,
        silence_timeout: float = 0.0,
        safe_value: Callable[[], TargetT] | None = None,
        hold_reason: str = "",
    ) -> None:
        """Prepares a connection; nothing is exchanged before `open`.

        Args:
            name: Name of the connection in the model.
            translate: Makes the target message, or None to pass nothing on.
            is_command: Whether its messages set something in motion.
            silence_timeout: Seconds without a message that count as silence; 0 means never.
            safe_value: Makes the message that is sent once when the source is lost: the stop of a
                command.
            hold_reason: Why the last command may stand then, for one that has no safe value.
        """
        self.name = name
        self.statistics = Statistics()
        self.clamp = Clamp(self._note_out_of_range)
        self.drop_field = DropField(self._note_out_of_range)
        self.drop_message = DropMessage(self._note_out_of_range)
        self.error = Error(self._note_out_of_range)
        self.silence_timeout = silence_timeout
        self.is_command = is_command
        self.stopped: StopReason | None = None
        self._halt: StopReason | None = None
        self._hold_reason = hold_reason
        self._translate = translate
        self._safe_value = safe_value
        self._heard = 0.0
        self._next_log = 0.0
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
        if self._halt is not None:
            self._refuse_halted(self._halt)
            return
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

    def _refuse_halted(self, reason: StopReason) -> None:
        """Counts a message that comes while nothing is passed on, unless it is the end anyway."""
        if reason is not StopReason.END:
            self.drop(NOT_READY, reason.value)

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

    @property
    def is_silent(self) -> bool:
        """Whether the source has said nothing usable since the safe value was due."""
        return self.stopped is not None

    def watch(self) -> None:
        """Starts to watch for silence, which a source that never spoke also is."""
        self._heard = self._ends.loop.now()
        if self.is_command:
            self.stop(StopReason.START)
        else:
            self._arm(self.silence_timeout)

    def _arm(self, delay: float) -> None:
        if self.silence_timeout > 0:
            self._watch = self._ends.loop.call_later(delay, self._check_silence)

    def _note_usable(self) -> None:
        if self.silence_timeout > 0 or self.stopped is not None:
            loop = self._ends.loop
            # With the lock the check either sees this message, or has sent the safe value before
            # the value that arrived.
            with loop.lock:
                self._heard = loop.now()
                if self.stopped is not None and self._halt is None:
                    self.stopped = None
                    self._arm(self.silence_timeout)

    def _check_silence(self) -> None:
        """Runs on the loop, which holds its lock."""
        remaining = self._heard + self.silence_timeout - self._ends.loop.now()
        if remaining > 0:
            self._arm(remaining)
        else:
            self.stop(StopReason.SILENCE)
            if self.is_command:
                self._log_silence()

    def _set_silence_timeout(self, seconds: float) -> None:
        with self._ends.loop.lock:
            self.silence_timeout = seconds
            if self._watch is not None:
                self._watch.cancel()
            if self.stopped is None:
                self._heard = self._ends.loop.now()
                self._arm(seconds)

    # ------------------------------------------------------------------ stops

    def stop(self, reason: StopReason) -> bool:
        """Sends the safe value, once: the next message from the source ends what it stands for.

        Runs on the loop, or with its lock.

        Args:
            reason: Why the source counts no more.

        Returns:
            Whether messages of the source stood until now.
        """
        if self._watch is not None:
            self._watch.cancel()
        stood = self.stopped is None
        self.stopped = reason
        if stood:
            counts = self.statistics.stops
            counts[reason] = counts.get(reason, 0) + 1
            self.send_safe_value(self.deliver_stop)
        return stood

    def send_safe_value(self, deliver: Callable[[TargetT], bool]) -> None:
        """Hands the modelled safe value to the target side; nothing when there is none.

        Args:
            deliver: Hands it over, to all of the target side or to a part.
        """
        if self._safe_value is None:
            return
        try:
            if deliver(self._safe_value()):
                self.statistics.safe_values += 1
        except Exception as error:
            self._failed(error)

    def deliver_stop(self, target: TargetT) -> bool:
        """Hands the safe value to the target side; False when nobody is there."""
        return self.deliver(target)

    def follow(self, standing: Standing, lost: StopReason | None) -> bool:  # noqa: ARG002
        """Stops what must not go on as the JAUS side of the bridge stands.

        Args:
            standing: State and controller of the bridge.
            lost: Why what the former controller commanded must not stand.

        Returns:
            Whether something was stopped.
        """
        return False

    def halt(self, reason: StopReason | None) -> bool:
        """Passes nothing on from now on, after the stop; or again, for None.

        Args:
            reason: Why nothing is passed on.

        Returns:
            Whether something was stopped.
        """
        self._halt = reason
        return reason is not None and self.stop(reason)

    def end(self) -> bool:
        """Sends the safe value for good; whether messages of the source stood until now."""
        return self.halt(StopReason.END) if self._safe_value or self.is_command else False

    def _log_silence(self) -> None:
        """Says what silence has done, at most once in a while: it may come and go."""
        now = self._ends.loop.now()
        if now >= self._next_log:
            self._next_log = now + _LOG_INTERVAL
            LOGGER.warning("%s: %s; %s", self.name, StopReason.SILENCE.value, self.when_lost)

    @property
    def when_lost(self) -> str:
        """What happens on the target side when the source of a command is lost."""
        if self._safe_value is not None:
            return "the stop is sent"
        return f"the last message stands ({self._hold_reason or 'nobody says why'})"

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
            *((("when lost", self.when_lost),) if self.is_command else ()),
            ("safe values", str(counts.safe_values)),
            *((f"stopped: {reason.value}", str(n)) for reason, n in counts.stops.items()),
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
        if self.stopped is not None:
            return "stale", self.stopped.value
        if self.statistics.last_arrival is None:
            return "stale", StopReason.START.value
        if dropping:
            return "warning", "messages are dropped"
        if measured and rate < self.declared_rate / 2:
            return "warning", "slower than declared"
        return "ok", "running"


AnyConnection = Connection[Any, Any]
