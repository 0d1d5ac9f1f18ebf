"""The socket of a page, for requests and events."""

from __future__ import annotations

import asyncio
import logging
import math
from collections.abc import AsyncIterator, Callable, Collection, Coroutine
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass
from typing import Protocol

from starlette.websockets import WebSocket, WebSocketDisconnect

from jausml.live.serving import rpc
from jausml.live.serving.rpc import Request, RpcError, TypedError, typed
from jausml.live.serving.security import Token

LARGEST_MESSAGE = 8 * 1024 * 1024
"""Bytes of a message that a page sends; a text of a file is the longest."""

_SECONDS_TO_GREET = 10.0
_MOST_AT_ONCE = 64  # requests of a page that wait for their answers

_POLICY_VIOLATION = 1008
_LOG = logging.getLogger(__name__)

_MOST_UNSENT = 1024

PACE = 100.0
"""Requests each second that a page of the models, or its editor, may go on with."""

_AHEAD = 10.0  # seconds whose requests may come at once, as at the beginning of a page

_OCTETS_OF_A_REQUEST = 65536  # length for which a request, or what it is answered, counts once more

_TRY_AGAIN_LATER = 1013


@dataclass(frozen=True)
class Hello:
    """Parameters of the first request."""

    token: str


async def greeted(socket: WebSocket, token: Token) -> Request | None:
    """Returns the first request of a socket; None, and the socket is closed, without the token."""
    try:
        text = await asyncio.wait_for(socket.receive_text(), _SECONDS_TO_GREET)
        request = rpc.parsed(text)
        hello = typed(Hello, request.params)()
    except (WebSocketDisconnect, asyncio.TimeoutError, KeyError, RpcError, TypedError):
        request, hello = None, None
    if request is not None and hello is not None:
        if request.method == "hello" and token.fits(hello.token):
            return request
        refused = RpcError(rpc.UNAUTHORIZED, "the token is that of another session")
        with suppress(WebSocketDisconnect, RuntimeError):
            await socket.send_text(rpc.refusal(refused, request.id))
    with suppress(WebSocketDisconnect, RuntimeError):
        await socket.close(_POLICY_VIOLATION)
    return None


async def received(socket: WebSocket) -> AsyncIterator[str | None]:
    """Yields the messages of a socket until it is closed; None for one without text."""
    with suppress(WebSocketDisconnect):
        while (message := await socket.receive())["type"] != "websocket.disconnect":
            yield message.get("text")


class Asked(Protocol):
    """The interface of whatever answers a page."""

    @property
    def revision(self) -> int:
        """The revision of what answers are about."""

    @property
    def urgent(self) -> Collection[str]:
        """Methods that are answered however many requests wait."""

    def subscribed(self, listener: Callable[[str], None]) -> AbstractContextManager[None]:
        """Reports events to a listener as long as the context lasts."""

    @property
    def pace(self) -> float:
        """Requests each second that a page may go on with."""

    async def answer(self, request: Request) -> object:
        """Returns the result of a request."""


class Pace:
    """The number of requests that a page may make: some each second, and those of a while ahead."""

    def __init__(self) -> None:
        self._paid = -math.inf

    def wait(self, now: float, requests_each_second: float, octets: int) -> float:
        """Returns the seconds for which a page is read no further, after so much came or went.

        Args:
            now: The time in seconds of any steady clock.
        """
        cost = (1 + octets / _OCTETS_OF_A_REQUEST) / requests_each_second
        self._paid = max(self._paid, now - _AHEAD) + cost
        return max(0.0, self._paid - now)


class PageSocket:
    """A page and its requests."""

    def __init__(self, socket: WebSocket, session: Asked) -> None:
        self._socket = socket
        self._session = session
        self._loop = asyncio.get_running_loop()
        self._outgoing = Outgoing(socket)
        self._answering: set[asyncio.Task[None]] = set()
        self._pace = Pace()

    async def run(self, token: Token) -> None:
        """Serves the page until it goes."""
        hello = await greeted(self._socket, token)
        if hello is None:
            return
        sending = asyncio.create_task(self._outgoing.send_all())
        with self._session.subscribed(self._notify_soon):
            self._start(self._answer(Request("hello", {}, hello.id)))
            receiving = asyncio.create_task(self._receive_all())
            await asyncio.wait((sending, receiving), return_when=asyncio.FIRST_COMPLETED)
        for task in (sending, receiving, *self._answering):
            task.cancel()
        await asyncio.gather(sending, receiving, *self._answering, return_exceptions=True)

    async def _receive_all(self) -> None:
        async for text in received(self._socket):
            self._take(text)
            await asyncio.sleep(self._charge(text or ""))

    def _charge(self, text: str) -> float:
        return self._pace.wait(self._loop.time(), self._session.pace, len(text))

    def _take(self, text: str | None) -> None:
        try:
            if text is None:
                raise RpcError(rpc.PARSE_ERROR, "messages are text")
            request = rpc.parsed(text)
            is_urgent = request.method in self._session.urgent
            if len(self._answering) >= _MOST_AT_ONCE and not is_urgent:
                raise RpcError(rpc.BUSY, "too many requests wait", id_=request.id)
        except RpcError as error:
            self._outgoing.send(rpc.refusal(error))
        else:
            self._start(self._answer(request))

    def _start(self, work: Coroutine[None, None, None]) -> None:
        task = asyncio.create_task(work)
        self._answering.add(task)
        task.add_done_callback(self._answering.discard)

    async def _answer(self, request: Request) -> None:
        try:
            before = self._session.revision
            result = await self._session.answer(request)
            # Where something changed meanwhile nobody knows of which revision its refs are.
            revision = before if self._session.revision == before else None
            message = rpc.answer(request.id, result, revision)
        except RpcError as error:
            message = rpc.refusal(error, request.id)
        except Exception as error:
            _LOG.exception("%s failed", request.method)
            reason = f"{type(error).__name__}: {error}"
            text = f"this is a fault of jausml ({reason}); the history has it under Faults"
            fault = RpcError(rpc.INTERNAL_ERROR, text)
            message = rpc.refusal(fault, request.id)
        if not request.is_notification:
            self._charge(message)
            self._outgoing.send(message)

    # What is told

    def _notify_soon(self, message: str) -> None:
        """Tells a message from any thread."""
        with suppress(RuntimeError):  # the loop has ended meanwhile
            self._loop.call_soon_threadsafe(self._outgoing.send, message)


class Outgoing:
    """The messages to a socket."""

    def __init__(self, socket: WebSocket) -> None:
        self._socket = socket
        self._unsent: asyncio.Queue[str] = asyncio.Queue(_MOST_UNSENT)

    def send(self, text: str) -> None:
        """Has a message sent, on the thread of the event loop."""
        with suppress(asyncio.QueueFull):
            self._unsent.put_nowait(text)

    async def send_all(self) -> None:
        """Sends messages until the page leaves, or takes none any more."""
        with suppress(WebSocketDisconnect, RuntimeError):
            while not self._unsent.full():
                await self._socket.send_text(await self._unsent.get())
            await self._socket.close(_TRY_AGAIN_LATER)
