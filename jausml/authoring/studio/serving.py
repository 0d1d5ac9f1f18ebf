"""The application, the session of a project that it serves, and the server of both."""

from __future__ import annotations

import asyncio
import logging
import os
import signal
import socket
import threading
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass, field
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

import uvicorn
from starlette.applications import Starlette
from starlette.responses import FileResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from watchfiles import awatch

from jausml.authoring.editing.layout import SUFFIXES
from jausml.authoring.studio.checking import Checking
from jausml.authoring.studio.handlers import editing, modelling, showing
from jausml.authoring.studio.handlers.showing import LiveRequests
from jausml.authoring.studio.rpc import Answering
from jausml.authoring.studio.security import Guard, Served, Token
from jausml.authoring.studio.sockets import LARGEST_MESSAGE, LanguageSocket, PageSocket
from jausml.authoring.studio.views.palette import library_entries
from jausml.language.metamodel import load_metamodels
from jausml.language.model.project import is_model_file

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable, Iterator
    from contextlib import AbstractContextManager

    from starlette.requests import Request
    from starlette.types import ASGIApp
    from starlette.websockets import WebSocket
    from watchfiles import Change

    from jausml.authoring.studio import rpc
    from jausml.authoring.studio.checking import Verdict
    from jausml.authoring.studio.context import StudioContext

_MODULES = (showing, editing, modelling)
_LOG = logging.getLogger(__name__)

DEBOUNCE_MS, STEP_MS = 50, 10
"""Milliseconds: what changes within them is told at once; how long it must have been quiet."""


class Session:
    """Answers pages, and tells them what happens."""

    def __init__(self, context: StudioContext) -> None:
        load_metamodels()  # now, for threads that ask at once would load them twice
        self._context = context
        self._live_requests = LiveRequests(context)
        context.subscribers.left = self._live_requests.leave
        methods = {
            name: each for module in _MODULES for name, each in module.methods(context).items()
        }
        self._answering = Answering({**methods, **self._live_requests.methods()})
        self._checking = Checking(
            context.verdicts, lambda: context.viewed_files.files, self._judged
        )
        context.followers.extend((self._checking.begin, self._live_requests.changed))

    @property
    def root(self) -> Path:
        """The folder that was opened, symbolic links followed."""
        return self._context.project.root

    @property
    def revision(self) -> int:
        """The revision of the project now."""
        return self._context.project.revision

    def subscribed(self, listener: Callable[[str], None]) -> AbstractContextManager[None]:
        """Tells a listener what happens as long as the context lasts; see `Subscribers`."""
        return self._context.subscribers.subscribed(listener)

    async def answer(self, request: rpc.Request) -> object:
        """Returns the result of a request."""
        return await self._answering.answer(request)

    @asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        """Looks after the project as long as the context lasts."""
        end = asyncio.Event()
        watched = asyncio.create_task(self._watch(end))
        self._checking.start()
        # Reading the library takes seconds on a busy computer: better before somebody asks for it.
        threading.Thread(target=library_entries, name="library", daemon=True).start()
        try:
            with self._context.faults.kept():
                yield
        finally:
            end.set()
            self._checking.close()
            await watched  # it may wait for its turn among the changes
            self._answering.close()
            await asyncio.to_thread(self._live_requests.stop)
            await asyncio.to_thread(self._context.trials.close)

    async def _watch(self, end: asyncio.Event) -> None:
        try:
            async for files in changes(self._context.project.root, end):
                await self._answering.in_turn(partial(self._context.refresh, files))
        except OSError:
            _LOG.exception("changes by other programs are not seen any more")

    def _judged(self, verdict: Verdict) -> None:
        self._context.subscribers.notify("problems", showing.problems(self._context, verdict))


async def changes(root: Path, end: asyncio.Event) -> AsyncIterator[list[str]]:
    """Yields model files that have changed, relative to a folder with forward slashes."""

    def is_model(_: Change, path: str) -> bool:
        file = os.path.relpath(path, root).replace(os.sep, "/")
        return is_model_file(file, root, SUFFIXES)

    watching = awatch(
        root,
        watch_filter=is_model,
        debounce=DEBOUNCE_MS,
        step=STEP_MS,
        stop_event=end,
        ignore_permission_denied=True,
    )
    async for found in watching:
        yield sorted({os.path.relpath(each, root).replace(os.sep, "/") for _, each in found})


PAGE = Path(__file__).resolve().parent / "page"
"""Where the built page lies; `make studio` builds it."""

_SECONDS_TO_END = 2

MOST_SOCKETS = 32
"""Sockets that are served at once."""

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


def serve(session: Session, host: str, port: int, opened: Callable[[str], None]) -> None:
    """Serves a session until SIGINT or SIGTERM comes; the main thread calls it.

    `opened`: is called with the address as soon as it can be opened. `OSError`: the port cannot be
    had.
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
            opened(studio.address)
            server.run(sockets=[listener])


def _family(host: str) -> socket.AddressFamily:
    return socket.AF_INET6 if ":" in host else socket.AF_INET


@contextmanager
def _ended_by_signals(server: uvicorn.Server) -> Iterator[None]:
    """Has signals end the server: before it looks for them, and when it raises them again."""

    def end(*_: object) -> None:
        server.should_exit = True

    signals = (signal.SIGINT, signal.SIGTERM)
    before = [signal.signal(each, end) for each in signals]
    try:
        yield
    finally:
        for each, handler in zip(signals, before, strict=True):
            signal.signal(each, handler)


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
        await asyncio.to_thread(import_module, "jausml.authoring.editor.server")  # it takes a while
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
