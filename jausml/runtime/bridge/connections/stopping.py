"""Stops of a connection whose source is lost: safe values, silence and halts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ...base.counters import LOGGER
from ...base.loop import Timer
from ..ends import parameters
from ..ends.ends import Ends
from ..reports.diagnostics import Limiting, Statistics
from ..reports.states import Standing, StopReason

_LEAST_PATIENCE = 0.5  # seconds for which a bridge may be starved without a stop
_LOG_INTERVAL = 5.0  # seconds between two lines of the log about the silence of one connection


class Stopping(Limiting):
    """The part of a connection that watches its source and sends the safe value, or stop.

    Everything runs on the loop, or with its lock.

    Attributes:
        silence_timeout: Seconds without a message after which the safe value is sent; 0: never.
        is_command: Whether its messages set something in motion, which has to end with its source.
        stopped: Why the safe value was the last message sent; None while one of the source is.
    """

    def __init__(
        self,
        name: str,
        *,
        is_command: bool = False,
        silence_timeout: float = 0.0,
        safe_value: Callable[[], Any] | None = None,
        stop: tuple[str, ...] = (),
        hold_reason: str = "",
    ) -> None:
        """Watches for nothing before `watch`.

        Args:
            safe_value: Makes the message that stops the target; None where there is none.
            stop: Fields of the safe value for the log, each as `thrust = 0`; none means all zero.
            hold_reason: Why the last command may stay in effect without a safe value.
        """
        super().__init__()
        self.name = name
        self.statistics = Statistics()
        self.silence_timeout = silence_timeout
        self.is_command = is_command
        self.stopped: StopReason | None = None
        self._halt: StopReason | None = None
        self._stop = ", ".join(stop)
        self._hold_reason = hold_reason
        self._safe_value = safe_value
        self._next_log = 0.0
        self._watch: Timer | None = None
        self._guarded: Any = None  # arms the stop of the guardian, if there is one
        self._ends: Ends

    def open(self, ends: Ends) -> None:
        """Begins anew, as if nothing had been stopped."""
        self._ends = ends
        self._halt = self.stopped = self._guarded = None
        self.declare(ends)

    def declare(self, ends: Ends) -> None:
        """Declares the parameters of the connection, and reads their values."""
        self.silence_timeout = ends.ros.parameter(
            parameters.SILENCE_TIMEOUT.of(self.silence_timeout, self.name),
            self._set_silence_timeout,
        )

    # ------------------------------------------------------------------ for the kinds

    def deliver(self, payload: bytes) -> bool:
        """Delivers an encoded message; returns False when it was dropped and counted."""
        raise NotImplementedError

    def deliver_stop(self, payload: bytes) -> bool:
        """Delivers the safe value; returns False when it has no receiver."""
        return self.deliver(payload)

    def guarded_stops(self, payload: bytes) -> dict[str, Any]:
        """Returns the `topics` or `datagrams` by which the guardian sends an encoded stop."""
        raise NotImplementedError

    def encode(self, target: Any) -> bytes:
        """Encodes a message of the target side."""
        raise NotImplementedError

    def handling_changed(self) -> None:
        """Tells the core and the guardian that messages are handled in another way from now on.

        To be called after each change of a stop, a halt, the shape, the backlog or measurements.
        """
        self._ends.loop.revision.changed()
        # A command may be in effect from now on, which the guardian has to stop.
        if self.stopped is None and self._halt is None and self._guarded is not None:
            self._guarded.arm(True)  # noqa: FBT003

    # ------------------------------------------------------------------ silence

    @property
    def is_silent(self) -> bool:
        """Whether no usable message of the source has come since the safe value was due."""
        return self.stopped is not None

    def watch(self) -> None:
        """Starts to watch for silence, also of a source that has never sent a message."""
        self.statistics.heard = self._ends.clock.now()
        if self.is_command:
            # An earlier process, which may have crashed, can have left a command in effect.
            self.stop(StopReason.START)
        else:
            self._arm(self.silence_timeout)

    def note_usable(self) -> None:
        """Counts the source as heard, and ends its stop, after a message could be translated."""
        self.statistics.heard = self._ends.clock.now()
        # While it is halted the stop stays, whatever the source sends.
        if self.stopped is not None and self._halt is None:
            self.stopped = None
            self._arm(self.silence_timeout)
            self.handling_changed()

    def _arm(self, delay: float) -> None:
        if self.silence_timeout > 0:
            self._watch = self._ends.clock.call_later(delay, self._check_silence)

    def _check_silence(self) -> None:
        # Messages do not restart the timer: when it fires, it waits for the rest of the time-out.
        remaining = self.statistics.heard + self.silence_timeout - self._ends.clock.now()
        if remaining > 0:
            self._arm(remaining)
        else:
            self.stop(StopReason.SILENCE)
            if self.is_command:
                self._log_silence()

    def judge_silence(self) -> None:
        """Sends the stop of a silent source if it is due, without waiting for the timer.

        To be called before a message that waited is used: after the process stood still, other
        timers may fire earlier.
        """
        is_watched = self.silence_timeout > 0 and self.stopped is None
        if is_watched and self.statistics.heard + self.silence_timeout <= self._ends.clock.now():
            self._check_silence()

    def _set_silence_timeout(self, seconds: float) -> None:
        with self._ends.loop.lock:
            self.silence_timeout = seconds
            if self._watch is not None:
                self._watch.cancel()
            if self.stopped is None:
                # The new time counts from now on: a change is no silence.
                self.statistics.heard = self._ends.clock.now()
                self._arm(seconds)

    def _log_silence(self) -> None:
        """Logs the effect of silence, at most once in `_LOG_INTERVAL`: it may come and go."""
        now = self._ends.clock.now()
        if now >= self._next_log:
            self._next_log = now + _LOG_INTERVAL
            LOGGER.warning("%s: %s; %s", self.name, StopReason.SILENCE.value, self.when_lost)

    # ------------------------------------------------------------------ stops

    def stop(self, reason: StopReason) -> bool:
        """Sends the safe value, unless it was the last message; the next one ends the stop.

        Returns whether a message of the source was in effect.
        """
        if self._watch is not None:
            self._watch.cancel()
        was_running = self.stopped is None
        # A stop keeps its reason when the bridge becomes inactive.
        if was_running or reason is not StopReason.INACTIVE:
            self.stopped = reason
        # First the core is stopped, so that no older command follows the stop.
        self.handling_changed()
        if was_running:
            self.statistics.stops[reason] += 1
            self.send_safe_value(self.deliver_stop)
        # Only after the stop was sent: if this process dies before, the guardian has to send it.
        if self._guarded is not None:
            self._guarded.arm(False)  # noqa: FBT003
        return was_running

    def guard(self) -> None:
        """Registers the stop of a command with the guardian, if there is one."""
        ward = self._ends.ward
        if ward is not None and self.is_command and self._safe_value is not None:
            self._guarded = ward.guard(self._guardian_content)

    def _guardian_content(self) -> dict[str, Any]:
        """Returns the stops for the guardian to send, and the seconds of silence before them."""
        patience = max(_LEAST_PATIENCE, self.silence_timeout)
        content: dict[str, Any] = {"patience": patience, "topics": [], "datagrams": []}
        try:
            # The guardian finds this moment in the octets and replaces it by the present.
            with self._ends.frozen_at(self._ends.ward.moment):
                payload = self.encode(self._safe_value() if self._safe_value else None)
            content |= self.guarded_stops(payload)
        except Exception as error:  # of an overridden method
            self.fail(error)
        return content

    def send_safe_value(self, deliver: Callable[[bytes], bool]) -> None:
        """Encodes and delivers the safe value of the model, if there is one."""
        if self._safe_value is None:
            return
        try:
            if deliver(self.encode(self._safe_value())):
                self.statistics.safe_values += 1
        except Exception as error:
            self.fail(error)

    def follow(self, standing: Standing, lost: StopReason | None) -> bool:  # noqa: ARG002
        """Stops the connection if it may not go on: here, while the bridge is inactive.

        Args:
            standing: Activity, status and controller of the bridge.
            lost: Why commands of the former controller end; None if they do not.

        Returns:
            Whether a message of the source was stopped.
        """
        return self.halt(None if standing.is_active else StopReason.INACTIVE)

    def lose(self, reason: StopReason) -> bool:
        """Stops a watched source whose clock stands still; returns whether that ended a message."""
        is_watched = self.is_command or self.silence_timeout > 0
        return is_watched and self.stopped is None and self.stop(reason)

    def halt(self, reason: StopReason | None) -> bool:
        """Stops and refuses messages for a reason, or ends that for None; returns as `stop`."""
        self._halt = reason
        self.handling_changed()
        return reason is not None and self.stop(reason)

    def end(self) -> bool:
        """Sends the safe value for good; returns whether a message of the source was in effect."""
        if self._watch is not None:
            self._watch.cancel()
        return self.halt(StopReason.END) if self._safe_value or self.is_command else False

    @property
    def when_lost(self) -> str:
        """The effect of a lost source on the target side, in words for the log."""
        if self._safe_value is not None:
            return f"the stop is sent ({self._stop})" if self._stop else "the stop is sent"
        return f"the last message stands ({self._hold_reason or 'nobody says why'})"
