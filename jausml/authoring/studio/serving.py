"""The application of the studio, and the session of a project that it serves."""

from __future__ import annotations

import asyncio
import logging
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from starlette.applications import Starlette
from starlette.routing import WebSocketRoute

from jausml.authoring.studio.language_socket import LanguageSocket
from jausml.live.serving import server
from jausml.live.serving.security import Token
from jausml.live.serving.server import Sockets, routes_of
from jausml.live.serving.sockets import PageSocket

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable

    from starlette.types import ASGIApp
    from starlette.websockets import WebSocket

    from jausml.authoring.studio.session import Session
    from jausml.live.serving.security import Served


PAGE = Path(__file__).resolve().parent / "page"
"""Where the built page lies; `make studio` builds it."""


def serve(session: Session, host: str, port: int, opened: Callable[[Studio], None]) -> None:
    """Serves a session until SIGINT, SIGTERM or SIGHUP comes; the main thread calls it.

    `opened`: is called as soon as the address can be opened. `OSError`: the port cannot be had.
    """
    # It tells of texts that it cannot understand at length, and its editor is told anyway.
    logging.getLogger("pygls").setLevel(logging.CRITICAL)
    studios: list[Studio] = []

    def app(served: Served) -> ASGIApp:
        studios.append(Studio(session, served, PAGE))
        return studios[0].app()

    server.serve(host, port, app, lambda: opened(studios[0]))


@dataclass
class Studio:
    """What is served."""

    session: Session
    served: Served
    page: Path
    token: Token = field(default_factory=Token)
    _sockets: Sockets = field(default_factory=Sockets)

    @property
    def address(self) -> str:
        """The address to open; the token stands where browsers send it to nobody."""
        return f"http://{self.served.authority}/#token={self.token.text}"

    def app(self) -> ASGIApp:
        """Returns the application."""
        index, files = routes_of(self.page)
        sockets = [
            WebSocketRoute("/socket", self._page_socket),
            WebSocketRoute("/language", self._language_socket),
        ]
        return Starlette(routes=[index, *sockets, files], lifespan=self._lifespan)

    @asynccontextmanager
    async def _lifespan(self, _: Starlette) -> AsyncIterator[None]:
        async with self.session.running():
            yield

    async def _page_socket(self, socket: WebSocket) -> None:
        async with self._sockets.accepted(socket) as is_accepted:
            if is_accepted:
                await PageSocket(socket, self.session).run(self.token)

    async def _language_socket(self, socket: WebSocket) -> None:
        await asyncio.to_thread(import_module, "jausml.authoring.editor.server")  # it takes a while
        async with self._sockets.accepted(socket) as is_accepted:
            if is_accepted:
                await LanguageSocket(socket, self.session.root).run(self.token)
