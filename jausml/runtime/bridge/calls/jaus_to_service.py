"""Connection of JAUS messages that ask with a ROS service that answers."""

from __future__ import annotations

from functools import partial
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from ...clients.peer_search import PeerBinding
from ...services.definitions import Guard
from ...transports.packets.packet import Priority
from ..connections.to_ros import UNEXPECTED
from ..ends import parameters
from ..ends.by_sender import Taker
from .calls import (
    FAILED,
    NOT_TRANSLATED,
    REJECTED,
    TIMED_OUT,
    UNANSWERED,
    Call,
    CallFailedError,
    Calls,
    CallTranslation,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ...base.address import JausAddress
    from ...clients.peer_search import PeerSearch
    from ...wire.message import Message
    from ..ends.ends import Ends
    from ..ends.topics import RosService, ServiceClient

NO_SERVICE = "no_service"


class AskedCall(Call):
    """A message of a JAUS component that asks."""

    def __init__(self, sender: JausAddress) -> None:
        super().__init__()
        self.sender = sender


class JausToRosService(Calls[AskedCall, "CallTranslation | type[Message]"]):
    """Calls a ROS service for each message that asks, and answers with what it says.

    Where something goes wrong the answer is a rejection, or nothing where there is none.
    """

    def __init__(
        self,
        name: str,
        *,
        service: RosService,
        request: CallTranslation | type[Message],
        response: CallTranslation | type[Message] | None,
        peers: Sequence[JausAddress] | PeerSearch = (),
        rejections: Sequence[type[Message]] = (),
        when: Guard | Callable[[Any], Guard] = Guard.ANY,
        is_command: bool = False,
        priority: Priority = Priority.STANDARD,
        timeout: float = 1.0,
    ) -> None:
        """Prepares the connection.

        Args:
            request: The translation of messages that ask, or such a message: the request has its
                defaults then.
            response: The translation of responses, or the message that answers with its defaults;
                None where nothing answers.
            peers: JAUS components that may ask, or how they are found; none means anybody.
            rejections: The first of these messages answers when a call came to nothing.
            timeout: Seconds after which a call without a response has failed.
        """
        super().__init__(
            name,
            service=service,
            request=request,
            response=response,
            timeout=timeout,
            is_command=is_command,
            priority=priority,
        )
        self._peers = PeerBinding(peers)
        self._rejections = tuple(rejections)
        self._when = when
        self._client: ServiceClient

    def open(self, ends: Ends) -> None:
        """Makes the client, then takes what asks."""
        super().open(ends)
        self._peers = parameters.peers(ends.ros, self.name, self._peers)
        self._peers.follow(ends.component.find_peers, lambda _: None, lambda _: None)
        self._client = ends.ros.service_client(self.service)
        asking = self._request
        message = asking.message if isinstance(asking, CallTranslation) else asking
        senders = None if self._peers.is_anybody else self._peers
        ends.accept(message, Taker(self._take, senders, self._refuse_sender), self._when)

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
        request = self._made(self._request, payload, lambda: self.service.request().to_cdr())
        timer = self._ends.loop.call_later(self.timeout, partial(self._time_out, call))
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
                self._send(self._made(answer, data, self._default), call.sender)
        except CallFailedError as error:
            self._fail(call, NOT_TRANSLATED, str(error))
        else:
            self._done(call)

    def _default(self) -> bytes:
        answer = self._response
        return b"" if answer is None or isinstance(answer, CallTranslation) else answer().encode()

    def abandon(self, call: AskedCall, reason: str, text: str) -> None:  # noqa: ARG002
        """Answers with a rejection, where there is one."""
        if self._rejections:
            self._send(self._rejections[0]().encode(), call.sender)
        else:
            self.counters.add(f"bridge.{self.name}.{UNANSWERED}")

    def describe_peers(self) -> list[tuple[str, str]]:
        """What a search has found, and whether the service is there."""
        state = "there" if self._client.is_ready() else "absent"
        return [*self._peers.describe(), ("service is", state)]

    def fault(self) -> str:
        """Whether nobody serves, or nobody is found who may ask."""
        if self._peers.is_lacking:
            return f"searching {self._peers.search}"
        return "" if self._client.is_ready() else f"nobody serves {self.service.name}"
