"""The server of a page: where it is bound, how many sockets it serves, and what ends it."""

from __future__ import annotations

import socket
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from pathlib import Path

import uvicorn
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import FileResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.websockets import WebSocket

from jausml.live.serving.security import Guard, Served, Token
from jausml.live.serving.sockets import LARGEST_MESSAGE
from jausml.live.signals import ended_by_signals

_SECONDS_TO_END = 2

MOST_SOCKETS = 32
"""Sockets that are served at once."""

TRY_AGAIN_LATER = 1013


class PageMissingError(Exception):
    """The page was not built."""


class Site:
    """A page with its sockets, for browsers that have the token of its address.

    Attributes:
        authority: Host and port of the address; empty before it is served.
    """

    def __init__(self, page: Path) -> None:
        """Is served to nobody yet (`page`: where the built page lies)."""
        self.token = Token()
        self.authority = ""
        self.page = page

    @property
    def address(self) -> str:
        """The address to open; the token is in a part that browsers do not send."""
        return f"http://{self.authority}/#token={self.token.text}"

    @property
    def sockets(self) -> Mapping[str, Callable[[WebSocket], Awaitable[None]]]:
        """The functions that serve sockets, by path."""
        raise NotImplementedError

    def running(self) -> AbstractAsyncContextManager[None]:
        """Looks after what is served as long as the context lasts."""
        raise NotImplementedError

    def app(self) -> Starlette:
        """Returns the application of a web server."""

        async def index(_: Request) -> Response:
            return FileResponse(self.page / "index.html", headers={"Cache-Control": "no-cache"})

        sockets = [WebSocketRoute(path, serve) for path, serve in self.sockets.items()]
        files = Mount("/", StaticFiles(directory=self.page))
        routes = [Route("/", index), *sockets, files]
        return Starlette(routes=routes, lifespan=lambda _: self.running())


def serve(host: str, port: int, site: Site, opened: Callable[[], None]) -> None:
    """Serves a site until SIGINT, SIGTERM or SIGHUP comes; the main thread calls it.

    Args:
        opened: Is called as soon as the address can be opened.

    Raises:
        PageMissingError: The page was not built.
        OSError: The port cannot be had.
    """
    if not (site.page / "index.html").is_file():
        raise PageMissingError(
            "the page is missing: run `make studio` in the checkout of jausml,"
            " or install the wheel that `make wheel` builds there"
        )
    if not host:
        raise ValueError("an empty host would be all addresses")
    host.encode("idna")
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.create_server((host, port), family=family) as listener:
        bound, taken = listener.getsockname()[:2]
        served = Served(host, taken, bound)
        site.authority = served.authority
        config = uvicorn.Config(
            Guard(site.app(), served),
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
        # Before the server looks for them, and when it raises them again.
        with ended_by_signals(lambda: setattr(server, "should_exit", True)):
            opened()
            server.run(sockets=[listener])


class Sockets:
    """The sockets that are served at present."""

    def __init__(self) -> None:
        """Serves none."""
        self._sockets: list[WebSocket] = []

    @asynccontextmanager
    async def accepted(self, socket: WebSocket) -> AsyncIterator[bool]:
        """Accepts a socket unless there are too many; yields whether it did."""
        await socket.accept()
        # It counts from here on: others may come while one that gives way is closed.
        self._sockets.append(socket)
        try:
            is_served = await self._make_place(socket)
            if not is_served:
                await socket.close(TRY_AGAIN_LATER)
            yield is_served
        finally:
            if socket in self._sockets:
                self._sockets.remove(socket)

    async def _make_place(self, socket: WebSocket) -> bool:  # noqa: ARG002 - of those who keep some
        """Returns whether the socket that came last can be served."""
        return len(self._sockets) <= MOST_SOCKETS
