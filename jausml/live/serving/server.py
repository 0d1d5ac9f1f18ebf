"""The server of a page: where it is bound, how many sockets it serves, and what ends it."""

from __future__ import annotations

import socket
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING

import uvicorn
from starlette.responses import FileResponse
from starlette.routing import Mount, Route
from starlette.staticfiles import StaticFiles

from jausml.live.serving.security import Guard, Served
from jausml.live.serving.sockets import LARGEST_MESSAGE
from jausml.live.signals import ended_by_signals

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable
    from pathlib import Path

    from starlette.requests import Request
    from starlette.responses import Response
    from starlette.routing import BaseRoute
    from starlette.types import ASGIApp
    from starlette.websockets import WebSocket

_SECONDS_TO_END = 2

MOST_SOCKETS = 32
"""Sockets that are served at once."""

TRY_AGAIN_LATER = 1013


class PageMissingError(Exception):
    """The page was not built."""


def require_page(page: Path) -> None:
    """Looks whether a built page is there."""
    if not (page / "index.html").is_file():
        raise PageMissingError(
            "the page is missing: run `make studio` in the checkout of jausml,"
            " or install the wheel that `make wheel` builds there"
        )


def serve(
    host: str, port: int, app: Callable[[Served], ASGIApp], opened: Callable[[], None]
) -> None:
    """Serves until SIGINT, SIGTERM or SIGHUP comes; the main thread calls it.

    Args:
        app: Makes what is served, once it is known where.
        opened: Is called as soon as the addresses can be opened.

    Raises:
        OSError: The port cannot be had.
    """
    if not host:
        raise ValueError("an empty host would be all addresses")
    host.encode("idna")
    with socket.create_server((host, port), family=_family(host)) as listener:
        bound, taken = listener.getsockname()[:2]
        served = Served(host, taken, bound)
        config = uvicorn.Config(
            Guard(app(served), served),
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


def routes_of(page: Path) -> tuple[BaseRoute, BaseRoute]:
    """Returns the routes of a built page: its beginning, and all else of it as the last one."""

    async def index(_: Request) -> Response:
        return FileResponse(page / "index.html", headers={"Cache-Control": "no-cache"})

    return Route("/", index), Mount("/", StaticFiles(directory=page))


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
            is_served = await self._has_place(socket)
            if not is_served:
                await socket.close(TRY_AGAIN_LATER)
            yield is_served
        finally:
            if socket in self._sockets:
                self._sockets.remove(socket)

    async def _has_place(self, socket: WebSocket) -> bool:  # noqa: ARG002 - of those who keep some
        """Returns whether the socket that came last can be served."""
        return len(self._sockets) <= MOST_SOCKETS


def _family(host: str) -> socket.AddressFamily:
    return socket.AF_INET6 if ":" in host else socket.AF_INET
