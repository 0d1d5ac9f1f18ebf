"""The page of the studio with the session of a project, and what serves its two sockets."""

from __future__ import annotations

import asyncio
import logging
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from jausml.authoring.studio.language_socket import LanguageSocket
from jausml.live.serving.server import Site, Sockets
from jausml.live.serving.sockets import PageSocket

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Mapping
    from contextlib import AbstractAsyncContextManager

    from starlette.websockets import WebSocket

    from jausml.authoring.studio.session import Session


PAGE = Path(__file__).resolve().parent / "page"
"""Where the built page lies; `make studio` builds it."""


class Studio(Site):
    """What is served."""

    def __init__(self, session: Session) -> None:
        """Serves a session."""
        super().__init__(PAGE)
        self._session = session
        self._accepting = Sockets()
        # It tells of texts that it cannot understand at length, and its editor is told anyway.
        logging.getLogger("pygls").setLevel(logging.CRITICAL)

    @property
    def sockets(self) -> Mapping[str, Callable[[WebSocket], Awaitable[None]]]:
        """The socket of the page, and that of its editor."""
        return {"/socket": self._serve_page, "/language": self._serve_editor}

    def running(self) -> AbstractAsyncContextManager[None]:
        """Looks after the project as long as the context lasts."""
        return self._session.running()

    async def _serve_page(self, socket: WebSocket) -> None:
        async with self._accepting.accepted(socket) as is_accepted:
            if is_accepted:
                await PageSocket(socket, self._session).run(self.token)

    async def _serve_editor(self, socket: WebSocket) -> None:
        await asyncio.to_thread(import_module, "jausml.authoring.editor.server")  # it takes a while
        async with self._accepting.accepted(socket) as is_accepted:
            if is_accepted:
                await LanguageSocket(socket, self._session.root).run(self.token)
