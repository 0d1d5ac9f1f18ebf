"""Calls: what the two connections of ROS services have in common.

A call is a request and what becomes of it. Many are under way at once; all of them run on the loop,
or with its lock.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any, Generic, TypeVar

from ...base.address import JausAddress
from ...base.counters import Counters
from ...transports.packets.packet import Priority
from ...wire.message import EncodeError, Message
from ..connections.connection import NOT_READY
from ..connections.translations import (
    Form,
    Transcode,
    override_of,
    ros_decoder,
    ros_encoder,
    transcoder,
    uses_ros_classes,
)
from ..ends import parameters
from ..ends.ends import Ends
from ..ends.topics import Parameter, RosService
from ..light_message import LightMessage
from ..reports.diagnostics import FILTERED, ConnectionStatus, Limiting, Statistics
from ..reports.states import Facts, Standing, StateLog, StopReason, judge

CallT = TypeVar("CallT", bound="Call")
AskingT = TypeVar("AskingT")


class CallFailedError(Exception):
    """A half of a call that could not be translated, which is counted already."""


class CallTranslation(Limiting):
    """Translates requests, or responses."""

    def __init__(
        self,
        name: str,
        translate: Callable[[Any], Any],
        *,
        message: type[Message],
        type: type[LightMessage],  # noqa: A002 - the word of the model
        to_ros: bool,
    ) -> None:
        """Prepares the translation; a call for which it makes None fails."""
        super().__init__()
        self.name = name
        self.statistics = Statistics()
        self.message = message
        self.type = type
        self.to_ros = to_ros
        self.translate = translate
        self._transcode: Transcode

    def open(self, ends: Ends) -> None:
        """Finds out how both messages are read and written."""
        self.counters = ends.component.counters
        self._is_open = True
        real = uses_ros_classes(self.translate)
        decode = self.message.decode if self.to_ros else ros_decoder(ends.ros, self.type, real=real)
        encode = ros_encoder(ends.ros, self.type) if self.to_ros else _encode
        self._transcode = transcoder(
            self.translate, decode, encode, self.note_blocking, ends.loop.stopwatch
        )

    def translated(self, data: bytes) -> bytes:
        """Returns the translation of an encoded message."""
        try:
            target = self._transcode(data)
        except Exception as error:
            self.fail(error)
            raise CallFailedError(str(error) or repr(error)) from error
        self.statistics.arrivals += 1
        if target is None:
            self.drop(FILTERED)
            raise CallFailedError("the message is filtered out")
        self.statistics.passed += 1
        return target

    def describe(self) -> list[tuple[str, str]]:
        """Names and values of its counts, for diagnostics."""
        counts = self.statistics
        half = self.name.rpartition("_")[2]
        return [
            *(
                (f"{half} out of range: {policy} {field}", str(n))
                for (policy, field), n in sorted(counts.out_of_range.items())
            ),
            *((f"{half} dropped: {reason}", str(n)) for reason, n in sorted(counts.drops.items())),
        ]


def _encode(message: Message) -> bytes:
    return message.encode()


MOST_CALLS = 64  # calls of one connection that are under way at most; further ones are refused
TOO_MANY = "too_many_calls"
TIMED_OUT = "timed_out"
NOT_ASKED = "not_asked"
REJECTED = "rejected"
ENDED = "ended"
FAILED = "answer_not_delivered"
NOT_TRANSLATED = "not_translated"
UNANSWERED = "unanswered"


class Call:
    """A call that is under way."""

    def __init__(self) -> None:
        self.forget: Callable[[], None] = lambda: None


class Calls(Generic[CallT, AskingT]):
    """The part of a connection that keeps its calls, counts them and tells of them."""

    counters: Counters

    def __init__(
        self,
        name: str,
        *,
        service: RosService,
        request: AskingT,
        response: CallTranslation | type[Message] | None,
        # Seconds after which a call without an answer has failed, once it was sent.
        timeout: float = 1.0,
        is_command: bool = False,
        priority: Priority = Priority.STANDARD,
    ) -> None:
        """Prepares the connection; nothing is exchanged before `open`.

        Args:
            request: The translation of what asks, or such a message, whose defaults are asked for.
            response: The translation of responses, or the JAUS message that answers without one;
                None where nothing answers.
        """
        self.name = name
        self.service = service
        self.timeout = timeout
        self.statistics = Statistics()
        self.is_command = is_command
        self.form = Form.LIGHT
        self._request = request
        self._response = response
        self._priority = priority
        self._under_way: dict[CallT, None] = {}
        self._halt: StopReason | None = None
        self._reported = 0
        self._log = StateLog(name)
        self._ends: Ends

    # ------------------------------------------------------------------ for the kinds

    def open(self, ends: Ends) -> None:
        """Opens the ends of the connection."""
        self._ends = ends
        self.counters = ends.component.counters
        for translation in self._translations():
            translation.open(ends)
        text = f"ROS service of {self.name}."
        parameter = Parameter(f"{self.name}.service", self.service.name, text)
        self.service = replace(self.service, name=ends.ros.parameter(parameter))
        self.timeout = ends.ros.parameter(
            parameters.TIMEOUT.of(self.timeout, self.name), self._set_timeout
        )

    def abandon(self, call: CallT, reason: str, text: str) -> None:
        """Tells whoever asked that a call came to nothing."""
        raise NotImplementedError

    def describe_peers(self) -> list[tuple[str, str]]:
        """Names and states of the other ends, for diagnostics."""
        raise NotImplementedError

    def fault(self) -> str:
        """Why calls cannot be carried now, empty when they can."""
        raise NotImplementedError

    # ------------------------------------------------------------------ calls

    def _begin(self, call: CallT) -> bool:
        """Counts a call; False when it was refused, and whoever asked was told."""
        counts = self.statistics
        counts.arrivals += 1
        counts.last_arrival = self._ends.loop.now()
        if self._halt is not None:
            self._fail(call, NOT_READY, self._halt.value)
        elif len(self._under_way) >= MOST_CALLS:
            self._fail(call, TOO_MANY, f"{MOST_CALLS} calls are under way")
        else:
            self._under_way[call] = None
            return True
        return False

    def _translated(self, half: object, data: bytes, default: Callable[[], bytes]) -> bytes:
        """Returns what a message becomes, or the default where nothing translates it."""
        if isinstance(half, CallTranslation):
            return half.translated(data)
        try:
            return default()
        except EncodeError as error:
            raise CallFailedError(str(error)) from error

    def _send(self, payload: bytes, peer: JausAddress, *, acknowledge: bool = False) -> None:
        component = self._ends.component
        component.transport.send(
            component.address, peer, payload, priority=self._priority, acknowledge=acknowledge
        )

    def _done(self, call: CallT) -> None:
        """Counts a call that was answered."""
        self._under_way.pop(call, None)
        self.statistics.passed += 1

    def _fail(self, call: CallT, reason: str, text: str) -> None:
        """Counts a call that came to nothing, and tells whoever asked."""
        self._under_way.pop(call, None)
        call.forget()
        self.drop(reason, text)
        try:
            self.abandon(call, reason, text)
        except Exception as error:
            self.drop(FAILED, repr(error), error)

    def drop(self, reason: str, detail: str = "", error: Exception | None = None) -> None:
        """Counts a call that came to nothing."""
        self.statistics.drops[reason] += 1
        self.counters.count(f"bridge.{self.name}.{reason}", detail, error=error)

    def _set_timeout(self, seconds: float) -> None:
        with self._ends.loop.lock:
            self.timeout = seconds

    def _translations(self) -> Iterator[CallTranslation]:
        for translation in (self._request, self._response):
            if isinstance(translation, CallTranslation):
                yield translation

    # ------------------------------------------------------------------ as a connection

    def watch(self) -> None:
        """Calls are watched one by one."""

    def follow(self, standing: Standing, lost: StopReason | None) -> bool:
        """Ends commands while the bridge may not command, and all calls of an inactive one."""
        if self.is_command or not standing.is_active:
            self._halt = standing.halt
            return self._end_all(lost or standing.halt)
        self._halt = None
        return False

    def lose(self, reason: StopReason) -> bool:  # noqa: ARG002 - the time of calls is the loop's
        """A simulation that stands still ends no call."""
        return False

    def end(self) -> bool:
        """Ends all calls for good; whether there were any."""
        self._halt = StopReason.END
        return self._end_all(StopReason.END)

    def _end_all(self, reason: StopReason | None) -> bool:
        ended = () if reason is None else tuple(self._under_way)
        for call in ended:
            self._fail(call, ENDED, reason.value if reason is not None else "")
        return bool(ended)

    @property
    def when_lost(self) -> str:
        """What happens when the bridge may not command any more."""
        return "calls under way end"

    def measure_latency(self, wanted: bool) -> None:  # noqa: FBT001
        """Calls are rare: their latency is not measured."""

    def close_account(self) -> list[tuple[str, int]]:
        """Returns what became of all calls; nothing gets lost that was not counted at once."""
        counts = self.statistics
        return [
            ("calls taken", counts.arrivals),
            ("calls answered", counts.passed),
            *((f"failed: {reason}", n) for reason, n in sorted(counts.drops.items())),
        ]

    # ------------------------------------------------------------------ diagnostics

    def status(self) -> ConnectionStatus:
        """Returns the state since the last call, for `/diagnostics`."""
        counts = self.statistics
        failures = sum(counts.drops.values()) + sum(
            sum(translation.statistics.drops.values()) for translation in self._translations()
        )
        is_new, self._reported = failures > self._reported, failures
        judged = judge(
            Facts(
                lacking=self.fault(),
                forbidden="" if self._halt is None else self._halt.value,
                refusal=self.refusal(),
                complaint="calls fail" if is_new else "",
            )
        )
        self._log.note(judged, self._ends.loop.now())
        values = (("state", judged.phase.value), *self._values())
        own = str(self._ends.settings.address)
        return ConnectionStatus(self.name, judged.level, judged.reason, own, values)

    def refusal(self) -> str:
        """Why nobody who is asked obeys, empty while somebody does or need not."""
        return ""

    def _values(self) -> tuple[tuple[str, str], ...]:
        counts = self.statistics
        last = counts.last_arrival
        age = "never" if last is None else f"{self._ends.loop.now() - last:.3f}"
        return (
            ("service", self.service.name),
            ("translation", self.form.value),
            *override_of(*(translation.translate for translation in self._translations())),
            ("calls taken", str(counts.arrivals)),
            ("calls answered", str(counts.passed)),
            ("calls under way", str(len(self._under_way))),
            ("age (s)", age),
            *((f"failed: {reason}", str(n)) for reason, n in sorted(counts.drops.items())),
            *(pair for translation in self._translations() for pair in translation.describe()),
            *self.describe_peers(),
        )


def codes_of(messages: Sequence[type[Message]]) -> dict[int, type[Message]]:
    """Returns messages by their codes."""
    return {message.CODE: message for message in messages}
