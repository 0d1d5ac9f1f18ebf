"""Calls: the common part of both connections of ROS services.

A call is a request and its outcome: a response, a rejection or a failure. Many calls are under way
at once; everything runs on the loop, or with its lock.
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
    """A request or response could not be translated; the failure is counted already."""


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
        """Prepares the translation.

        Args:
            translate: Returns the target message, or None, which fails the call.
            message: The JAUS message.
            type: The request or response of the ROS service.
            to_ros: Whether the JAUS message is the source.
        """
        super().__init__()
        self.name = name
        self.statistics = Statistics()
        self.message = message
        self.type = type
        self.to_ros = to_ros
        self.translate = translate
        self._transcode: Transcode

    def open(self, ends: Ends) -> None:
        """Chooses the decoder of the source and the encoder of the target message."""
        self.counters = ends.component.counters
        self._is_open = True
        decode: Callable[[bytes], Any] = self.message.decode
        if not self.to_ros:
            decode = ros_decoder(ends.ros, self.type, self.translate)
        encode = ros_encoder(ends.ros, self.type) if self.to_ros else _encode
        self._transcode = transcoder(
            self.translate, decode, encode, self.note_blocking, ends.loop.stopwatch
        )

    def translated(self, data: bytes) -> bytes:
        """Returns the translation of an encoded message; raises CallFailedError."""
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
        """Returns names and values of its counts, for diagnostics."""
        counts = self.statistics
        half = self.name.rpartition("_")[2]
        return [
            *(
                (f"{half} out of range: {policy} {field}", str(number))
                for (policy, field), number in sorted(counts.out_of_range.items())
            ),
            *(
                (f"{half} dropped: {reason}", str(number))
                for reason, number in sorted(counts.drops.items())
            ),
        ]


def _encode(message: Message) -> bytes:
    return message.encode()


MAX_CALLS = 64  # calls of one connection that are under way at most; further ones are refused

# Reasons of failures, as counters and diagnostics name them.
TOO_MANY = "too_many_calls"
TIMED_OUT = "timed_out"
NOT_ASKED = "not_asked"
REJECTED = "rejected"
ENDED = "ended"
FAILED = "answer_not_delivered"
NOT_TRANSLATED = "not_translated"
UNANSWERED = "unanswered"


class Call:
    """A call that is under way; `forget` cancels the request, whose answer is ignored then."""

    def __init__(self) -> None:
        self.forget: Callable[[], None] = lambda: None


class Calls(Generic[CallT, AskingT]):
    """Base class of the connections of services: keeps, counts and reports their calls."""

    counters: Counters

    def __init__(
        self,
        name: str,
        *,
        service: RosService,
        request: AskingT,
        response: CallTranslation | type[Message] | None,
        timeout: float = 1.0,
        is_command: bool = False,
        priority: Priority = Priority.STANDARD,
    ) -> None:
        """Prepares the connection; nothing is exchanged before `open`.

        Args:
            request: The translation of requests, or without one the JAUS message: the instance
                that is sent, or the class that is received.
            response: The translation of responses, or without one the JAUS message that answers;
                None where no message answers.
            timeout: Seconds after sending after which a call without an answer fails.
            is_command: Whether calls end when the bridge may not command any more.
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
        """Opens the translations, and reads the parameters of the connection."""
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
        """Answers the client that its call failed; the text says why."""
        raise NotImplementedError

    def describe_peers(self) -> list[tuple[str, str]]:
        """Returns names and states of peers and services, for diagnostics."""
        raise NotImplementedError

    def fault(self) -> str:
        """Returns why no call can be made now; empty when calls can."""
        raise NotImplementedError

    # ------------------------------------------------------------------ calls

    def _begin(self, call: CallT) -> bool:
        """Counts a call; returns False when it was refused, and its client answered."""
        counts = self.statistics
        counts.arrivals += 1
        counts.last_arrival = self._ends.loop.now()
        if self._halt is not None:
            self._fail(call, NOT_READY, self._halt.value)
        elif len(self._under_way) >= MAX_CALLS:
            self._fail(call, TOO_MANY, f"{MAX_CALLS} calls are under way")
        else:
            self._under_way[call] = None
            return True
        return False

    def _translated(self, translation: object, data: bytes, default: Callable[[], bytes]) -> bytes:
        """Returns the translation of a message, or the default where there is no translation."""
        if isinstance(translation, CallTranslation):
            return translation.translated(data)
        try:
            return default()
        except EncodeError as error:
            raise CallFailedError(str(error)) from error

    def _send(self, payload: bytes, peer: JausAddress, *, acknowledge: bool = False) -> None:
        component = self._ends.component
        component.transport.send(
            component.address, peer, payload, priority=self._priority, acknowledge=acknowledge
        )

    def _count_answered(self, call: CallT) -> None:
        self._under_way.pop(call, None)
        self.statistics.passed += 1

    def _fail(self, call: CallT, reason: str, text: str) -> None:
        """Ends and counts a call that failed, and answers its client."""
        self._under_way.pop(call, None)
        call.forget()
        self.drop(reason, text)
        try:
            self.abandon(call, reason, text)
        except Exception as error:
            self.drop(FAILED, repr(error), error)

    def drop(self, reason: str, detail: str = "", error: Exception | None = None) -> None:
        """Counts a call that failed."""
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
        """Does nothing: each call has its own time-out."""

    def follow(self, standing: Standing, lost: StopReason | None) -> bool:
        """Ends calls that command while the bridge may not, and all calls while it is inactive."""
        if self.is_command or not standing.is_active:
            self._halt = standing.halt
            return self._end_all(lost or standing.halt)
        self._halt = None
        return False

    def lose(self, reason: StopReason) -> bool:  # noqa: ARG002 - the time of calls is the loop's
        """Returns False: a simulation that stands still ends no call."""
        return False

    def end(self) -> bool:
        """Ends all calls for good; returns whether there were any."""
        self._halt = StopReason.END
        return self._end_all(StopReason.END)

    def _end_all(self, reason: StopReason | None) -> bool:
        ended = () if reason is None else tuple(self._under_way)
        for call in ended:
            self._fail(call, ENDED, reason.value if reason is not None else "")
        return bool(ended)

    @property
    def when_lost(self) -> str:
        """The effect of lost control, in words for the log."""
        return "calls under way end"

    def measure_latency(self, wanted: bool) -> None:  # noqa: FBT001
        """Does nothing: calls are rare, and their latency is not measured."""

    def close_account(self) -> list[tuple[str, int]]:
        """Returns the number of calls for each outcome."""
        counts = self.statistics
        return [
            ("calls taken", counts.arrivals),
            ("calls answered", counts.passed),
            *((f"failed: {reason}", number) for reason, number in sorted(counts.drops.items())),
        ]

    # ------------------------------------------------------------------ diagnostics

    def status(self) -> ConnectionStatus:
        """Returns the state since the last call, for `/diagnostics`."""
        counts = self.statistics
        failures = sum(counts.drops.values()) + sum(
            sum(translation.statistics.drops.values()) for translation in self._translations()
        )
        is_new, self._reported = failures > self._reported, failures
        verdict = judge(
            Facts(
                lacking=self.fault(),
                forbidden="" if self._halt is None else self._halt.value,
                refusal=self.refusal(),
                complaint="calls fail" if is_new else "",
            )
        )
        self._log.note(verdict, self._ends.loop.now())
        values = (("state", verdict.phase.value), *self._values())
        own = str(self._ends.settings.address)
        return ConnectionStatus(self.name, verdict.level, verdict.reason, own, values)

    def refusal(self) -> str:
        """Returns why no peer obeys; empty while one does, or none has to."""
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
            *(
                (f"failed: {reason}", str(number))
                for reason, number in sorted(counts.drops.items())
            ),
            *(pair for translation in self._translations() for pair in translation.describe()),
            *self.describe_peers(),
        )


def codes_of(messages: Sequence[type[Message]]) -> dict[int, type[Message]]:
    """Returns messages by their codes."""
    return {message.CODE: message for message in messages}
