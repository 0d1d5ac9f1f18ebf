"""The application: the page as it was built, and the two sockets that it speaks through."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from importlib import import_module
from typing import TYPE_CHECKING

from starlette.applications import Starlette
from starlette.responses import FileResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles

from jausml.authoring.studio.page_socket import PageSocket
from jausml.authoring.studio.security import Guard, Token

if TYPE_CHECKING:
    from collections.abc import AsyncIterator
    from pathlib import Path

    from starlette.requests import Request
    from starlette.types import ASGIApp
    from starlette.websockets import WebSocket

    from jausml.authoring.studio.security import Served
    from jausml.authoring.studio.session import Session

MOST_SOCKETS = 32
"""Sockets that are served at once."""

_TRY_AGAIN_LATER = 1013


@dataclass
class Studio:
    """What is served."""

    session: Session
    served: Served
    page: Path
    token: Token = field(default_factory=Token)
    _sockets: int = 0

    @property
    def address(self) -> str:
        """The address to open; the token stands where browsers send it to nobody."""
        return f"http://{self.served.authority}/#token={self.token.text}"

    def app(self) -> ASGIApp:
        """Returns the application."""
        routes = [
            Route("/", self._index),
            WebSocketRoute("/socket", self._page_socket),
            WebSocketRoute("/language", self._language_socket),
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
        # It takes longer to load than all else, and who draws only never needs it.
        await asyncio.to_thread(import_module, "jausml.authoring.studio.language")
        from jausml.authoring.studio.language import LanguageSocket  # noqa: PLC0415

        async with self._accepted(socket) as is_accepted:
            if is_accepted:
                await LanguageSocket(socket, self.session.root).run(self.token)

    @asynccontextmanager
    async def _accepted(self, socket: WebSocket) -> AsyncIterator[bool]:
        """Accepts a socket unless there are too many; yields whether it did."""
        await socket.accept()
        if self._sockets >= MOST_SOCKETS:
            await socket.close(_TRY_AGAIN_LATER)
            yield False
            return
        self._sockets += 1
        try:
            yield True
        finally:
            self._sockets -= 1
