"""Connection of a bridge: takes a message, translates it, hands it over.

Messages are bytes on both sides. All go one way, `take`: what must not pass now is refused or
kept, what waited too long dropped, what is too much thinned, and the rest is translated, handed
over and counted (`pass_on`, which each kind of connection has). A core may pass usual messages
alone; who changes what is usual tells it by `note_case`.

All of it happens on the thread of the loop, or with its lock. What is lost is counted under a
reason; nothing that a message contains, and nothing that an overridden method does, ends the
thread.
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


_PLAIN = Shape()  # everything passes when it comes


class Connection(Reporting, Generic[SourceT, TargetT]):
    """What the connections of both directions have in common."""

    _type: type[Any]  # light or of rclpy: the class of the ROS messages

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
        self._backlog = Backlog(self.statistics, self.drop, self.waited)
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
        self._transcode = self._made_transcode()
        age = self.make_age()
        if age is not None:
            self._shaping.open(self.name, ends, age, self._pass, self.note_case, self.judge_silence)

    def declare(self, ends: Ends) -> None:
        """Declares the parameters of the connection, and reads what they say."""
        super().declare(ends)
        self._wants_latency = ends.ros.parameter(
            parameters.LATENCY.of(value=False, owner=self.name), self._set_wants_latency
        )

    def decoder(self) -> Callable[[bytes], SourceT]:
        """Returns what makes the objects that the readable translation is given."""
        raise NotImplementedError

    def pass_on(self, data: bytes, origin: Any) -> None:
        """Translates a message, hands it over, and counts what became of it.

        The source is heard when the translation succeeds, which ends a stop.
        """
        raise NotImplementedError

    def age(self, data: bytes, origin: Any) -> float | None:
        """Returns the age of a message that arrives now in seconds, None if it has no stamp."""
        raise NotImplementedError

    def waited(self, origin: Any) -> float | None:  # noqa: ARG002
        """Returns the seconds since a message with an origin was sent; None when nobody knows."""
        return None

    def make_age(self) -> Age | None:
        """Returns what tells how old a message is; None where messages are not shaped."""
        return None

    def join(self, joined: Sequence[Joined]) -> None:
        """Has the translation given the latest messages of joins, which are open."""
        self._joined = tuple(joined)
        if joined:
            is_compiled = self.form is Form.COMPILED
            self._transcode = with_joins(self._transcode, joined, is_compiled=is_compiled)

    @property
    def is_latched(self) -> bool:
        """Whether the latest message counts until there is another, however old it is."""
        return False

    # ------------------------------------------------------------------ messages

    def take(self, data: bytes, origin: Any = None) -> None:
        """Takes a message; its origin is its sender, or when it was published in nanoseconds."""
        if self._halt is not None:
            self._take_halted(self._halt, data, origin)
        elif self._backlog.is_there and not self._backlog.admits(origin):
            pass  # it is counted: a command of long ago must not be obeyed
        elif self._shaping.is_plain:
            self._pass(data, origin)
        else:
            self._shaping.take(data, origin)

    def _take_halted(self, reason: StopReason, data: bytes, origin: Any) -> None:
        """Keeps a message that counts until there is another, or refuses it."""
        if reason is StopReason.INACTIVE and self.is_latched:
            self._latest = data, origin
            return
        # At the end nothing is refused any more, so nothing counts as taken either.
        self.statistics.arrivals += reason is not StopReason.END
        self.refuse_halted(reason)

    def _pass(self, data: bytes, origin: Any) -> None:
        """Passes a message on whose time has come; how long that takes is measured if wanted."""
        if self._latency is None:
            self.pass_on(data, origin)
        else:
            self._latency.measure(self.pass_on, data, origin, self.statistics)

    @property
    def is_usual(self) -> bool:
        """Whether all messages are passed on when they come, and nothing is to be known of them."""
        passes = self.stopped is None and self._halt is None
        is_shaped = self._backlog.is_there or not self._shaping.is_plain
        return passes and self._latency is None and not is_shaped

    def watch(self) -> None:
        """Starts to mind the source, and to measure if that is wanted."""
        super().watch()
        if self.is_command:
            self._backlog.open(self._ends, self.silence_timeout, self._backlog_changed)
        self._measure()

    def _backlog_changed(self) -> None:
        """Does first what is due after a standstill: the stop goes before whatever waited."""
        self.judge_silence()
        self.note_case()

    def _set_silence_timeout(self, seconds: float) -> None:
        with self._ends.loop.lock:
            super()._set_silence_timeout(seconds)
            self._backlog.change(seconds)

    def end(self) -> bool:
        """Sends the safe value for good; whether messages of the source stood until now."""
        self._backlog.close()
        return super().end()

    def stop(self, reason: StopReason) -> bool:
        """Sends the safe value, once; what waits for its time gives way to it."""
        # Withdrawn before the stop is sent, which must be the last word.
        waiting = self._shaping.withdraw()
        if waiting is not None and reason is StopReason.INACTIVE and self.is_latched:
            # Its source will not say it again: it is passed on when the bridge is active.
            self._latest = waiting.data, waiting.origin
        elif waiting is not None:
            self._shaping.thin()
        return super().stop(reason)

    def _made_transcode(self) -> Transcode:
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
        """Returns what a core is given to translate as this connection does; None for Python."""
        compiled = compiled_of(self._translate)
        is_plain = compiled is not None and self.is_translated_alone and not self._joined
        return self._ends.fast_translation(compiled) if compiled and is_plain else None

    @property
    def is_translated_alone(self) -> bool:
        """Whether nothing but the translation is to know of a message."""
        return True

    def _note_unknown(self, left_out: int) -> None:
        """Counts fields that a core has left out, a bit for each."""
        compiled = compiled_of(self._translate)
        for path in () if compiled is None else compiled.paths_of(left_out):
            self.drop_field.unknown(path)

    def halt(self, reason: StopReason | None) -> bool:
        """Passes nothing on from now on, after the stop; or again, for None.

        What counts until there is another is passed on then, as its source will not say it again.
        """
        stopped = super().halt(reason)
        if reason is None and self._latest is not None:
            latest, self._latest = self._latest, None
            self.take(*latest)
        return stopped

    def refuse_halted(self, reason: StopReason) -> None:
        """Counts a message that comes while nothing is passed on, unless it is the end anyway.

        The log does not tell what an inactive bridge drops, as somebody wants it so.
        """
        if reason is StopReason.INACTIVE:
            self.statistics.drops[INACTIVE] += 1
        elif reason is not StopReason.END:
            self.drop(NOT_READY, reason.value)

    # ------------------------------------------------------------------ latency

    def measure_latency(self, wanted: bool) -> None:  # noqa: FBT001
        """Measures the latency from now on, whatever the connection's own parameter says."""
        self._all_want_latency = wanted
        self._measure()

    def _set_wants_latency(self, wanted: bool) -> None:  # noqa: FBT001
        with self._ends.loop.lock:
            self._wants_latency = wanted
            self._measure()

    def _measure(self) -> None:
        wanted = self._wants_latency or self._all_want_latency
        # Only a change begins anew: what was measured so far stays.
        if wanted is not (self._latency is not None):
            self._latency = Latency(self.age, self._ends.loop.stopwatch) if wanted else None
            self.note_case()


AnyConnection = Connection[Any, Any]
