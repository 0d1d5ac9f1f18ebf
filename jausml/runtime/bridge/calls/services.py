"""Connections between ROS services and JAUS queries or commands, in both directions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from ...base.address import JausAddress
from ...clients.exchanges import Exchanges, Unanswered
from ...clients.peer_binding import PeerBinding, Search
from ...services.definitions import Guard
from ...wire.message import DecodeError, Message
from ..connections.connection import NO_PEER, NOT_READY
from ..connections.controlled_peers import ControlledPeers
from ..connections.to_ros import UNEXPECTED
from ..ends import parameters
from ..ends.ends import Ends, Taker
from ..light_message import assign
from .calls import (
    FAILED,
    NOT_ASKED,
    NOT_TRANSLATED,
    REJECTED,
    TIMED_OUT,
    UNANSWERED,
    Call,
    CallFailedError,
    Calls,
    CallTranslation,
    codes_of,
)

if TYPE_CHECKING:
    from ..ros.services import NodeClient, NodeServices

_RESPONSE_CODES = ("response_code", "responsecode", "rejection_code")


class ServedCall(Call):
    """A request of a ROS client."""

    def __init__(self, reply: Callable[[bytes], None]) -> None:
        super().__init__()
        self.reply = reply


class RosServiceToJaus(Calls[ServedCall, "CallTranslation | Message"]):
    """Serves a ROS service: sends each request to a JAUS peer and returns the peer's answer.

    A call that failed is answered with False in the response's bool of success. A response without
    such a bool is not sent then, since it would pass for success.
    """

    def __init__(
        self,
        name: str,
        *,
        peers: Sequence[JausAddress] | Search,
        rejections: Sequence[type[Message]] = (),
        control: Guard = Guard.ANY,
        is_success_mapped: bool = False,
        **options: Any,
    ) -> None:
        """Prepares the connection. A command that has no answer succeeds when it is sent.

        Args:
            peers: JAUS components to ask, or how they are found; the first that obeys is asked.
            rejections: JAUS messages with which a peer refuses a request.
            control: Guard of the peers for their senders.
            is_success_mapped: Whether the translation itself sets the bool of success.
        """
        super().__init__(name, **options)
        self._peers = ControlledPeers(peers, control)
        self._rejections = codes_of(rejections)
        self._is_success_mapped = is_success_mapped

    def open(self, ends: Ends) -> None:
        """Finds the peers and serves the ROS service."""
        super().open(ends)
        self._peers.open(
            ends, self.name, join=self._changed, leave=self._changed, changed=self._changed
        )
        ends.component.part(Exchanges).listen(self._answers)
        ends.ros.part(node_services).serve(self.service, self._serve)

    @property
    def _answers(self) -> list[type[Message]]:
        answer = self._response
        expected = answer.message if isinstance(answer, CallTranslation) else answer
        return [*([] if expected is None else [expected]), *self._rejections.values()]

    def _serve(self, request: bytes, reply: Callable[[bytes], None]) -> None:
        call = ServedCall(reply)
        if not self._begin(call):
            return
        peer = next(filter(self._peers.obeys, self._peers.present), None)
        if peer is None:
            self._refuse(call)
            return
        try:
            message = self._translated(self._request, request, self._default)
        except CallFailedError as error:
            self._fail(call, NOT_TRANSLATED, str(error))
        else:
            self._ask(call, peer, message)

    def _default(self) -> bytes:
        request = self._request
        return b"" if isinstance(request, CallTranslation) else request.encode()

    def _refuse(self, call: ServedCall) -> None:
        """Fails a call for which there is no peer that obeys."""
        present = self._peers.present
        if present:
            why = "; ".join(f"{address}: {self._peers.reason(address)}" for address in present)
            self._fail(call, NOT_READY, f"no peer obeys ({why})")
        else:
            self._fail(call, NO_PEER, self._peers.lacking() or "no peer is there")

    def _ask(self, call: ServedCall, peer: JausAddress, payload: bytes) -> None:
        if not self._answers:
            self._send(payload, peer, acknowledge=True)
            self._succeed(call, self.service.response())
            return
        call.forget = self._ends.component.part(Exchanges).ask(
            peer,
            payload,
            self._answers,
            lambda answer: self._answered(call, peer, answer),
            timeout=self.timeout,
            is_query=not self.is_command,
            priority=self._priority,
        )

    def _answered(self, call: ServedCall, peer: JausAddress, payload: bytes | Unanswered) -> None:
        if payload is Unanswered.SILENT:
            self._fail(call, TIMED_OUT, f"{peer} did not answer within {self.timeout:g} s")
            return
        if payload is Unanswered.UNSENT:
            late = f"{peer} was not asked: answers to calls before it are due"
            self._fail(call, NOT_ASKED, f"{late} for {self.timeout:g} s")
            return
        rejection = self._rejections.get(payload[0] | payload[1] << 8)
        if rejection is not None:
            self._fail(call, REJECTED, f"{peer} answered {_described(rejection, payload)}")
            return
        answer = self._response
        if not isinstance(answer, CallTranslation):
            self._succeed(call, self.service.response())
            return
        try:
            data = answer.translated(payload)
        except CallFailedError as error:
            self._fail(call, NOT_TRANSLATED, str(error))
            return
        if self._is_success_mapped or not self.service.success:
            self._reply(call, data)
        else:
            self._succeed(call, self.service.response.from_cdr(data))

    def _succeed(self, call: ServedCall, response: Any) -> None:
        if self.service.success:
            assign(response, self.service.success, value=True)
        self._reply(call, response.to_cdr())

    def _reply(self, call: ServedCall, data: bytes) -> None:
        try:
            call.reply(data)
        except Exception as error:  # the client may be gone
            self._under_way.pop(call, None)
            self.drop(FAILED, repr(error), error)
        else:
            self._count_answered(call)

    def abandon(self, call: ServedCall, reason: str, text: str) -> None:  # noqa: ARG002
        """Responds that the call failed, and why; not at all where the response has no bool."""
        if not self.service.success:
            self.counters.add(f"bridge.{self.name}.{UNANSWERED}")
            return
        response = self.service.response()
        assign(response, self.service.success, value=False)
        if self.service.reason:
            assign(response, self.service.reason, value=text)
        call.reply(response.to_cdr())

    def describe_peers(self) -> list[tuple[str, str]]:
        """Returns the JAUS components and the state of their control."""
        return self._peers.describe()

    def fault(self) -> str:
        """Returns which peer is searched for; empty when none is."""
        lacking = self._peers.lacking()
        return f"searching {lacking}" if lacking else ""

    def refusal(self) -> str:
        """Returns that no peer obeys; empty when one does."""
        obeying = any(map(self._peers.obeys, self._peers.present))
        return "" if obeying else "no peer obeys"

    def _changed(self, peer: JausAddress) -> None:
        """Does nothing: each call looks up the peer that obeys."""


def _described(rejection: type[Message], payload: bytes) -> str:
    """Returns a rejection in words, with its code where one can be read."""
    try:
        message = rejection.decode(payload)
    except DecodeError:
        return rejection.NAME
    codes = (getattr(message, response_code, None) for response_code in _RESPONSE_CODES)
    code = next((value for value in codes if value is not None), None)
    return rejection.NAME if code is None else f"{rejection.NAME} with the code {code}"


NO_SERVICE = "no_service"


class AskedCall(Call):
    """A query or command of a JAUS component."""

    def __init__(self, sender: JausAddress) -> None:
        super().__init__()
        self.sender = sender


class JausToRosService(Calls[AskedCall, "CallTranslation | type[Message]"]):
    """Calls a ROS service for each JAUS query or command, and sends its response back.

    A call that failed is answered with a rejection, or not at all where the model has none.
    """

    def __init__(
        self,
        name: str,
        *,
        peers: Sequence[JausAddress] | Search = (),
        rejections: Sequence[type[Message]] = (),
        reason: tuple[str, int] | None = None,
        when: Guard | Callable[[Any], Guard] = Guard.ANY,
        **options: Any,
    ) -> None:
        """Prepares the connection.

        Args:
            peers: JAUS components that may call, or a search for them; none means all.
            rejections: JAUS messages of which the first answers a call that failed.
            reason: Name of the field of the rejection that says why, and its most characters.
            when: Guard of the calls: any sender, the controller, or the controller in Ready. A
                function returns it for a message.
        """
        super().__init__(name, **options)
        self._peers = PeerBinding(peers)
        self._rejections = tuple(rejections)
        self._reason = reason
        self._when = when
        self._client: NodeClient

    def open(self, ends: Ends) -> None:
        """Makes the client of the ROS service, then takes queries and commands."""
        super().open(ends)
        self._peers = parameters.peers(ends.ros, self.name, self._peers)
        self._peers.follow(ends.component, lambda _: None, lambda _: None)
        self._client = ends.ros.part(node_services).client(self.service)
        request = self._request
        message = request.message if isinstance(request, CallTranslation) else request
        senders = None if self._peers.is_anybody else self._peers
        ends.shared_messages.accept(
            message, Taker(self._take, senders, self._refuse_sender), self._when
        )

    def _refuse_sender(self, _payload: bytes, sender: JausAddress) -> None:
        self.drop(UNEXPECTED, str(sender))

    def _take(self, payload: bytes, sender: JausAddress) -> None:
        call = AskedCall(sender)
        if not self._begin(call):
            return
        try:
            self._call(call, payload)
        except CallFailedError as error:
            self._fail(call, NOT_TRANSLATED, str(error))
        except Exception as error:  # of rclpy, which nothing here may pass on
            self._fail(call, FAILED, repr(error))

    def _call(self, call: AskedCall, payload: bytes) -> None:
        if not self._client.is_ready():
            self._fail(call, NO_SERVICE, f"nobody serves {self.service.name}")
            return
        request = self._translated(self._request, payload, lambda: self.service.request().to_cdr())
        timer = self._ends.loop.call_later(self.timeout, partial(self._time_out, call))
        call.forget = timer.cancel  # for a client that raises
        forget = self._client.call(request, partial(self._answered, call))

        def end() -> None:
            timer.cancel()
            forget()

        call.forget = end

    def _time_out(self, call: AskedCall) -> None:
        text = f"{self.service.name} did not answer within {self.timeout:g} s"
        self._fail(call, TIMED_OUT, text)

    def _answered(self, call: AskedCall, data: bytes) -> None:
        if call not in self._under_way:
            return
        call.forget()
        if self.service.success or self.service.reason:
            response = self.service.response.from_cdr(data)
            if self.service.success and not attrgetter(self.service.success)(response):
                path = self.service.reason
                reason = str(attrgetter(path)(response)) if path else ""
                self._fail(call, REJECTED, reason or f"{self.service.name} refused")
                return
        answer = self._response
        try:
            if answer is not None:
                self._send(self._translated(answer, data, self._default), call.sender)
        except CallFailedError as error:
            self._fail(call, NOT_TRANSLATED, str(error))
        else:
            self._count_answered(call)

    def _default(self) -> bytes:
        answer = self._response
        return b"" if answer is None or isinstance(answer, CallTranslation) else answer().encode()

    def abandon(self, call: AskedCall, reason: str, text: str) -> None:  # noqa: ARG002
        """Answers with the rejection of the model, if any, and the text in it that says why."""
        if self._rejections:
            rejection = self._rejections[0]()
            if self._reason is not None:
                name, size = self._reason
                in_latin_1 = text.encode("latin-1", "replace").decode("latin-1")
                setattr(rejection, name, in_latin_1[:size])
            self._send(rejection.encode(), call.sender)
        else:
            self.counters.add(f"bridge.{self.name}.{UNANSWERED}")

    def describe_peers(self) -> list[tuple[str, str]]:
        """Returns the peers that were found, and whether the service is there."""
        state = "there" if self._client.is_ready() else "absent"
        return [*self._peers.describe(), ("service is", state)]

    def fault(self) -> str:
        """Returns that the service or its client is lacking; empty when both are there."""
        if self._peers.is_lacking:
            return f"searching {self._peers.search}"
        return "" if self._client.is_ready() else f"nobody serves {self.service.name}"


def node_services() -> type[NodeServices]:
    """Returns the class with the services of a node; imported late, as it needs rclpy."""
    from ..ros.services import NodeServices  # noqa: PLC0415

    return NodeServices
