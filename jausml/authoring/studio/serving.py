"""The application, the session of a project that it serves, and the server of both."""

from __future__ import annotations

import asyncio
import logging
import signal
import socket
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

import uvicorn
from starlette.applications import Starlette
from starlette.responses import FileResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles

from jausml.authoring.studio.security import Guard, Served, Token
from jausml.authoring.studio.sockets import LARGEST_MESSAGE, LanguageSocket, PageSocket

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable, Iterator

    from starlette.requests import Request
    from starlette.types import ASGIApp
    from starlette.websockets import WebSocket

    from jausml.authoring.studio.operating.seats import Seat
    from jausml.authoring.studio.session import Session


PAGE = Path(__file__).resolve().parent / "page"
"""Where the built page lies; `make studio` builds it."""

_SECONDS_TO_END = 2

MOST_SOCKETS = 32
"""Sockets that are served at once."""

KEPT_SOCKETS = 8
"""Further ones, for pages that may command."""

_TRY_AGAIN_LATER = 1013


class PageMissingError(Exception):
    """The page was not built."""


def require_page() -> None:
    """Looks whether the page is there."""
    if not (PAGE / "index.html").is_file():
        raise PageMissingError(
            "the page of the studio is missing: run `make studio` in the checkout of jausml,"
            " or install the wheel that `make wheel` builds there"
        )


def serve(session: Session, host: str, port: int, opened: Callable[[Studio], None]) -> None:
    """Serves a session until SIGINT or SIGTERM comes; the main thread calls it.

    `opened`: is called as soon as the addresses can be opened. `OSError`: the port cannot be had.
    """
    if not host:
        raise ValueError("an empty host would be all addresses")
    host.encode("idna")
    # It tells of texts that it cannot understand at length, and its editor is told anyway.
    logging.getLogger("pygls").setLevel(logging.CRITICAL)
    with socket.create_server((host, port), family=_family(host)) as listener:
        bound, taken = listener.getsockname()[:2]
        served = Served(host, taken, bound)
        studio = Studio(session, served, PAGE)
        config = uvicorn.Config(
            studio.app(),
            http="h11",
            ws="websockets-sansio",
            ws_max_size=LARGEST_MESSAGE,
            ws_per_message_deflate=False,
            lifespan="on",
            access_log=False,
            log_level="warning",
            proxy_headers=False,
            server_header=False,
            timeout_graceful_shutdown=_SECONDS_TO_END,
        )
        server = uvicorn.Server(config)
        with _ended_by_signals(server):
            opened(studio)
            server.run(sockets=[listener])


def _family(host: str) -> socket.AddressFamily:
    return socket.AF_INET6 if ":" in host else socket.AF_INET


@contextmanager
def _ended_by_signals(server: uvicorn.Server) -> Iterator[None]:
    """Has signals end the server: before it looks for them, and when it raises them again."""

    def end(*_: object) -> None:
        server.should_exit = True

    signals = (signal.SIGINT, signal.SIGTERM)
    before = [signal.signal(signal_number, end) for signal_number in signals]
    try:
        yield
    finally:
        for signal_number, handler in zip(signals, before, strict=True):
            signal.signal(signal_number, handler)


@dataclass
class Studio:
    """What is served."""

    session: Session
    served: Served
    page: Path
    token: Token = field(default_factory=Token)
    _sockets: dict[WebSocket, Seat | None] = field(default_factory=dict)

    @property
    def address(self) -> str:
        """The address to open; the token stands where browsers send it to nobody."""
        return f"http://{self.served.authority}/#token={self.token.text}"

    @property
    def commanding_address(self) -> str:
        """The address of those who may command too; empty where nobody may."""
        powers = self.session.operating.powers
        return f"{self.address}&command={powers.token.text}" if powers is not None else ""

    def app(self) -> ASGIApp:
        """Returns the application."""
        routes = [
            Route("/", self._index),
            WebSocketRoute("/socket", self._page_socket),
            WebSocketRoute("/language", self._language_socket),
            WebSocketRoute("/operate", self._operator_socket),
            Mount("/", StaticFiles(directory=self.page)),
        ]
        return Guard(Starlette(routes=routes, lifespan=self._lifespan), self.served)

    @asynccontextmanager
    async def _lifespan(self, _: Starlette) -> AsyncIterator[None]:
        async with self.session.running():
            yield

    async def _index(self, _: Request) -> Response:
        return FileResponse(self.page / "index.html", headers={"Cache-Control": "no-cache"})

    async def _page_socket(self, socket: WebSocket) -> None:
        async with self._accepted(socket) as is_accepted:
            if is_accepted:
                await PageSocket(socket, self.session).run(self.token)

    async def _language_socket(self, socket: WebSocket) -> None:
        await asyncio.to_thread(import_module, "jausml.authoring.editor.server")  # it takes a while
        async with self._accepted(socket) as is_accepted:
            if is_accepted:
                await LanguageSocket(socket, self.session.root).run(self.token)

    async def _operator_socket(self, socket: WebSocket) -> None:
        seat = await asyncio.to_thread(self.session.operating.seat)
        async with self._accepted(socket, seat) as is_accepted:
            if is_accepted:
                await PageSocket(socket, seat).run(self.token)

    @asynccontextmanager
    async def _accepted(self, socket: WebSocket, seat: Seat | None = None) -> AsyncIterator[bool]:
        """Accepts a socket unless there are too many; yields whether it did."""
        await socket.accept()
        if not await self._has_place(seat):
            await socket.close(_TRY_AGAIN_LATER)
            yield False
            return
        self._sockets[socket] = seat
        try:
            yield True
        finally:
            self._sockets.pop(socket, None)

    async def _has_place(self, seat: Seat | None) -> bool:
        """Tells whether there is a place, which another one may have to give.

        The kept ones go to pages of the operator unit, which say only then whether they may
        command. Those that have not said so give way to the next one, the first one first.
        """
        if len(self._sockets) < MOST_SOCKETS:
            return True
        if seat is None or len(self._sockets) < MOST_SOCKETS + KEPT_SOCKETS:
            return seat is not None
        seats = self._sockets.items()
        looking = next(
            (web_socket for web_socket, held in seats if held and not held.may_command), None
        )
        if looking is None:
            return False
        del self._sockets[looking]
        await looking.close(_TRY_AGAIN_LATER)
        return True
