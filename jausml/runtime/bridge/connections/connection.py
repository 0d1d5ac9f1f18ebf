"""Connection of a bridge: takes a message, translates it, delivers it.

Messages are bytes on both sides. Each one goes through `take`: it is refused or kept while the
connection is halted, dropped if it is too old, thinned out if there are too many, and otherwise
translated, delivered and counted (`pass_on`, which each kind of connection has). The compiled core
may do all that without Python while `is_direct`; `handling_changed` tells it that this changes.

Everything runs on the thread of the loop, or with its lock. Each lost message is counted under a
reason. No content of a message, and no error of an overridden method, ends the thread.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Generic, TypeVar

from ..ends import parameters
from ..ends.ends import Ends
from ..light_message import is_light
from ..messages.compiled import compiled_of
from ..reports.diagnostics import Age, Latency
from ..reports.states import StopReason
from .reporting import Reporting
from .shaping import Backlog, Shape, Shaping
from .translations import (
    Form,
    Joined,
    Transcode,
    compiled_first,
    override_of,
    transcoder,
    uses_ros_classes,
    with_joins,
)

Take = Callable[[bytes, Any], None]

SourceT = TypeVar("SourceT")
TargetT = TypeVar("TargetT")

INACTIVE = "inactive"
NOT_READY = "not_ready"
NO_PEER = "no_peer"

_PLAIN = Shape()  # passes every message at once


class Connection(Reporting, Generic[SourceT, TargetT]):
    """Base class of the connections of both directions."""

    _type: type[Any]  # class of the ROS messages: a light one, or that of rclpy

    def __init__(
        self,
        name: str,
        translate: Callable[..., TargetT | None],
        *,
        shape: Shape = _PLAIN,
        **when_lost: Any,
    ) -> None:
        super().__init__(name, **when_lost)
        self._shaping = Shaping(shape, self.statistics, self.drop)
        self._backlog = Backlog(self.statistics, self.drop, self.seconds_waited)
        self._translate = translate
        self._transcode: Transcode
        self._latest: tuple[bytes, Any] | None = None
        self._wants_latency = self._all_want_latency = False

    # ------------------------------------------------------------------ for the kinds

    def open(self, ends: Ends) -> None:
        """Makes the publishers and subscriptions of the connection."""
        super().open(ends)
        self.counters = ends.component.counters
        self._is_open = True
        self._transcode = self._make_transcode()
        age = self.age_function()
        if age is not None:
            self._shaping.open(
                self.name, ends, age, self._pass, self.handling_changed, self.judge_silence
            )

    def declare(self, ends: Ends) -> None:
        """Declares the parameters of the connection, and reads their values."""
        super().declare(ends)
        self._wants_latency = ends.ros.parameter(
            parameters.LATENCY.of(value=False, owner=self.name), self._set_wants_latency
        )

    def decoder(self) -> Callable[[bytes], SourceT]:
        """Returns the function that decodes source messages for the translation in Python."""
        raise NotImplementedError

    def pass_on(self, data: bytes, origin: Any) -> None:
        """Translates and delivers a message, and counts the outcome.

        Where the translation succeeds, the source counts as heard, and a stop ends.
        """
        raise NotImplementedError

    def age(self, data: bytes, origin: Any) -> float | None:
        """Returns the age in seconds of a message that arrives now; None without a stamp."""
        raise NotImplementedError

    def seconds_waited(self, origin: Any) -> float | None:  # noqa: ARG002
        """Returns the seconds since a message was sent; None if they are unknown."""
        return None

    def age_function(self) -> Age | None:
        """Returns the function for the age of a message; None where messages are not shaped."""
        return None

    def join(self, joined: Sequence[Joined]) -> None:
        """Gives the translation the latest messages of open joins from now on."""
        self._joined = tuple(joined)
        if joined:
            is_compiled = self.form is Form.COMPILED
            self._transcode = with_joins(self._transcode, joined, is_compiled=is_compiled)

    @property
    def is_latched(self) -> bool:
        """Whether the latest message stays valid until the next one, however old it is."""
        return False

    # ------------------------------------------------------------------ messages

    def take(self, data: bytes, origin: Any = None) -> None:
        """Takes a message.

        Args:
            origin: The JAUS ID of its sender, or the nanoseconds at which ROS published it.
        """
        if self._halt is not None:
            self._take_halted(self._halt, data, origin)
        elif self._backlog.is_active and not self._backlog.admits(origin):
            pass  # it is counted: a command of long ago must not be obeyed
        elif self._shaping.is_plain:
            self._pass(data, origin)
        else:
            self._shaping.take(data, origin)

    def _take_halted(self, reason: StopReason, data: bytes, origin: Any) -> None:
        """Keeps a latched message of an inactive bridge, or refuses the message."""
        if reason is StopReason.INACTIVE and self.is_latched:
            self._latest = data, origin
            return
        # At the end nothing is refused any more, so nothing counts as taken either.
        self.statistics.arrivals += reason is not StopReason.END
        self.refuse_halted(reason)

    def _pass(self, data: bytes, origin: Any) -> None:
        """Passes a message on, and measures its latency if that is wanted."""
        if self._latency is None:
            self.pass_on(data, origin)
        else:
            self._latency.measure(self.pass_on, data, origin, self.statistics)

    @property
    def is_direct(self) -> bool:
        """Whether every message is passed on at once: no stop, no shaping, no measurement."""
        passes = self.stopped is None and self._halt is None
        is_shaped = self._backlog.is_active or not self._shaping.is_plain
        return passes and self._latency is None and not is_shaped

    def watch(self) -> None:
        """Starts to watch the source, and to measure latency if that is wanted."""
        super().watch()
        if self.is_command:
            self._backlog.open(self._ends, self.silence_timeout, self._backlog_changed)
        self._measure()

    def _backlog_changed(self) -> None:
        """Sends the stop that is due after a standstill before any message that waited."""
        self.judge_silence()
        self.handling_changed()

    def _set_silence_timeout(self, seconds: float) -> None:
        with self._ends.loop.lock:
            super()._set_silence_timeout(seconds)
            self._backlog.change(seconds)

    def end(self) -> bool:
        """Sends the safe value for good; returns whether a message of the source was in effect."""
        self._backlog.close()
        # Nothing that waits or was kept passes after the end, nor when the bridge is opened again.
        self._latest = None
        if self._shaping.withdraw() is not None:
            self._shaping.thin()
        return super().end()

    def stop(self, reason: StopReason) -> bool:
        """Sends the safe value, once; drops the message that waits for its time to pass."""
        # Withdrawn before the stop is sent, which must be the last word.
        waiting = self._shaping.withdraw()
        if waiting is not None and reason is StopReason.INACTIVE and self.is_latched:
            # Its source will not repeat it: it is passed on when the bridge is active.
            self._latest = waiting.data, waiting.origin
        elif waiting is not None:
            self._shaping.thin()
        return super().stop(reason)

    def _make_transcode(self) -> Transcode:
        is_real = uses_ros_classes(self._translate) or not is_light(self._type)
        self.form = Form.ROS_CLASSES if is_real else Form.LIGHT
        self.override = override_of(self._translate)
        transcode = transcoder(
            self._translate,
            self.decoder(),
            self.encode,
            self.note_blocking,
            self._ends.loop.stopwatch,
        )
        compiled = compiled_of(self._translate)
        function = (
            None if compiled is None else self._ends.compiled(compiled, self.drop_field.unknown)
        )
        if compiled is None or function is None:
            return transcode
        self.form = Form.COMPILED
        return compiled_first(function, compiled.joins, transcode)

    def _fast_translation(self) -> Any:
        """Returns the translation that the core can run without Python; None if it cannot."""
        compiled = compiled_of(self._translate)
        if compiled is None or self._joined or not self.is_translated_alone:
            return None
        return self._ends.fast_translation(compiled)

    @property
    def is_translated_alone(self) -> bool:
        """Whether only the translation needs the message."""
        return True

    def _note_unknown(self, left_out: int) -> None:
        """Counts the fields that the core has left out; `left_out` has a bit for each."""
        compiled = compiled_of(self._translate)
        for path in () if compiled is None else compiled.paths_of(left_out):
            self.drop_field.unknown(path)

    def halt(self, reason: StopReason | None) -> bool:
        """Sends the stop and passes no message on for a reason, until it is called with None.

        Then the latched message that was kept is passed on, as its source will not repeat it.
        """
        stopped = super().halt(reason)
        if reason is None and self._latest is not None:
            latest, self._latest = self._latest, None
            self.take(*latest)
        return stopped

    def refuse_halted(self, reason: StopReason) -> None:
        """Counts a message that comes during a halt, unless the bridge ends.

        It is not logged for an inactive bridge, which is meant to drop messages.
        """
        if reason is StopReason.INACTIVE:
            self.statistics.drops[INACTIVE] += 1
        elif reason is not StopReason.END:
            self.drop(NOT_READY, reason.value)

    # ------------------------------------------------------------------ latency

    def measure_latency(self, wanted: bool) -> None:  # noqa: FBT001
        """Measures latency while `wanted`; otherwise the parameter of the connection decides."""
        self._all_want_latency = wanted
        self._measure()

    def _set_wants_latency(self, wanted: bool) -> None:  # noqa: FBT001
        with self._ends.loop.lock:
            self._wants_latency = wanted
            self._measure()

    def _measure(self) -> None:
        wanted = self._wants_latency or self._all_want_latency
        # Only a change begins anew, so that earlier measurements stay.
        if wanted is not (self._latency is not None):
            self._latency = Latency(self.age, self._ends.loop.stopwatch) if wanted else None
            self.handling_changed()


AnyConnection = Connection[Any, Any]
