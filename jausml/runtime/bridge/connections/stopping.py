"""What a connection does when its source is lost: safe values, silence and halts."""

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
    """The part of a connection that minds its source.

    All of it runs on the loop, or with its lock.

    Attributes:
        silence_timeout: Seconds without a message after which the safe value is sent; 0: never.
        is_command: Whether its messages set something in motion, which must not outlive its source.
        stopped: Why the safe value stands on the target side; None while messages of the source do.
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
        """Minds nothing before `watch`.

        A stop is what the model states for the safe value, each as `thrust = 0`; none means zeros.
        A reason to hold says why the last command may stand where there is no safe value.
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
        self._guarded: Any = None  # what arms the stop, where there is a guardian
        self._ends: Ends

    def open(self, ends: Ends) -> None:
        """Begins a life, in which nothing was stopped yet."""
        self._ends = ends
        self._halt = self.stopped = self._guarded = None  # of an earlier life
        self.declare(ends)

    def declare(self, ends: Ends) -> None:
        """Declares the parameters of the connection, and reads what they say."""
        self.silence_timeout = ends.ros.parameter(
            parameters.SILENCE_TIMEOUT.of(self.silence_timeout, self.name),
            self._set_silence_timeout,
        )

    # ------------------------------------------------------------------ for the kinds

    def deliver(self, payload: bytes) -> bool:
        """Hands a message to the target side; False when it was dropped and counted."""
        raise NotImplementedError

    def deliver_stop(self, payload: bytes) -> bool:
        """Hands the safe value to the target side; False when nobody is there."""
        return self.deliver(payload)

    def guarded_stops(self, payload: bytes) -> dict[str, Any]:
        """Returns the `topics` or `datagrams` that the guardian says, of a stop for its moment."""
        raise NotImplementedError

    def encode(self, target: Any) -> bytes:
        """Encodes what a translation or the safe value makes."""
        raise NotImplementedError

    def note_case(self) -> None:
        """Tells a core, which passes usual messages alone, and the guardian that the case changed.

        To be called whenever something changes that decides what becomes of messages.
        """
        self._ends.loop.revision.changed()
        # What stands from now on is for the guardian to end.
        if self.stopped is None and self._halt is None and self._guarded is not None:
            self._guarded.arm(True)  # noqa: FBT003

    # ------------------------------------------------------------------ silence

    @property
    def is_silent(self) -> bool:
        """Whether the source has said nothing usable since the safe value was due."""
        return self.stopped is not None

    def watch(self) -> None:
        """Starts to watch for silence, which a source that never spoke also is."""
        self.statistics.heard = self._ends.clock.now()
        if self.is_command:
            # A life before, which may have crashed, can have left a command behind.
            self.stop(StopReason.START)
        else:
            self._arm(self.silence_timeout)

    def note_usable(self) -> None:
        """Notes that the source has said something: one that sends nothing usable is silent."""
        self.statistics.heard = self._ends.clock.now()
        # While it is halted the stop stands, whatever the source says.
        if self.stopped is not None and self._halt is None:
            self.stopped = None
            self._arm(self.silence_timeout)
            self.note_case()

    def _arm(self, delay: float) -> None:
        if self.silence_timeout > 0:
            self._watch = self._ends.clock.call_later(delay, self._check_silence)

    def _check_silence(self) -> None:
        # The timer is not set anew by each message: it looks how much is left.
        remaining = self.statistics.heard + self.silence_timeout - self._ends.clock.now()
        if remaining > 0:
            self._arm(remaining)
        else:
            self.stop(StopReason.SILENCE)
            if self.is_command:
                self._log_silence()

    def judge_silence(self) -> None:
        """Does what is due when the source is silent, without waiting for the timer.

        To be called before what the source said is used again: when the process stood still, other
        timers may be earlier.
        """
        is_minded = self.silence_timeout > 0 and self.stopped is None
        if is_minded and self.statistics.heard + self.silence_timeout <= self._ends.clock.now():
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
        """Says what silence has done, at most once in a while: it may come and go."""
        now = self._ends.clock.now()
        if now >= self._next_log:
            self._next_log = now + _LOG_INTERVAL
            LOGGER.warning("%s: %s; %s", self.name, StopReason.SILENCE.value, self.when_lost)

    # ------------------------------------------------------------------ stops

    def stop(self, reason: StopReason) -> bool:
        """Sends the safe value, once: the next message from the source ends what it stands for.

        Returns whether messages of the source stood until now.
        """
        if self._watch is not None:
            self._watch.cancel()
        stood = self.stopped is None
        # What stands already stands for its own reason: a bridge begins inactive.
        if stood or reason is not StopReason.INACTIVE:
            self.stopped = reason
        # First the core is stopped, so that no older command follows the stop.
        self.note_case()
        if stood:
            self.statistics.stops[reason] += 1
            self.send_safe_value(self.deliver_stop)
        # Only after the stop was sent: until then the guardian must say it if this process dies.
        if self._guarded is not None:
            self._guarded.arm(False)  # noqa: FBT003
        return stood

    def guard(self) -> None:
        """Has the guardian say the stop when the bridge cannot, if there are both."""
        ward = self._ends.ward
        if ward is not None and self.is_command and self._safe_value is not None:
            self._guarded = ward.guard(self._handed_over)

    def _handed_over(self) -> dict[str, Any]:
        """Returns what the guardian is to say, and after which silence."""
        patience = max(_LEAST_PATIENCE, self.silence_timeout)
        content: dict[str, Any] = {"patience": patience, "topics": [], "datagrams": []}
        try:
            # At a moment that is found again in the octets, where the guardian puts the present.
            with self._ends.at(self._ends.ward.moment):
                payload = self.encode(self._safe_value() if self._safe_value else None)
            content |= self.guarded_stops(payload)
        except Exception as error:  # of what the user has overridden
            self.fail(error)
        return content

    def send_safe_value(self, deliver: Callable[[bytes], bool]) -> None:
        """Hands the modelled safe value to the target side; nothing when there is none."""
        if self._safe_value is None:
            return
        try:
            if deliver(self.encode(self._safe_value())):
                self.statistics.safe_values += 1
        except Exception as error:
            self.fail(error)

    def follow(self, standing: Standing, lost: StopReason | None) -> bool:  # noqa: ARG002
        """Stops what must not go on as the bridge stands; here, whatever passes while inactive.

        What the former controller commanded may be lost for a reason. Returns whether something was
        stopped.
        """
        return self.halt(None if standing.is_active else StopReason.INACTIVE)

    def lose(self, reason: StopReason) -> bool:
        """Stops what is watched, as its time does not pass any more; whether messages stood."""
        is_watched = self.is_command or self.silence_timeout > 0
        return is_watched and self.stopped is None and self.stop(reason)

    def halt(self, reason: StopReason | None) -> bool:
        """Passes nothing on after the stop, or again for None; whether something was stopped."""
        self._halt = reason
        self.note_case()
        return reason is not None and self.stop(reason)

    def end(self) -> bool:
        """Sends the safe value for good; whether messages of the source stood until now."""
        return self.halt(StopReason.END) if self._safe_value or self.is_command else False

    @property
    def when_lost(self) -> str:
        """What happens on the target side when the source of a command is lost."""
        if self._safe_value is not None:
            return f"the stop is sent ({self._stop})" if self._stop else "the stop is sent"
        return f"the last message stands ({self._hold_reason or 'nobody says why'})"
