"""The page of the studio with the session of a project, and what serves its two sockets."""

from __future__ import annotations

import asyncio
import json
import logging
import os
from collections.abc import Awaitable, Callable, Mapping
from contextlib import AbstractAsyncContextManager
from importlib import import_module
from pathlib import Path
from typing import Any

from starlette.websockets import WebSocket

from jausml.authoring.studio.session import Session
from jausml.live.serving import rpc
from jausml.live.serving.rpc import Request, RpcError
from jausml.live.serving.security import Token
from jausml.live.serving.server import Site, Sockets
from jausml.live.serving.sockets import PACE, Outgoing, Pace, PageSocket, greeted, received

METHODS = frozenset(
    {
        "$/cancelRequest",
        "$/setTrace",
        "initialize",
        "initialized",
        "shutdown",
        "textDocument/completion",
        "textDocument/definition",
        "textDocument/didChange",
        "textDocument/didClose",
        "textDocument/didOpen",
        "textDocument/documentSymbol",
        "textDocument/formatting",
        "textDocument/hover",
        "textDocument/prepareRename",
        "textDocument/rename",
    }
)
"""The requests that a page may make; the others are about processes and files."""


class LanguageSocket:
    """A conversation with a language server of its own; messages are JSON without headers."""

    def __init__(self, socket: WebSocket, root: Path) -> None:
        # It takes longer to load than all else, and who draws only never needs it.
        from jausml.authoring.editor.server import make_server  # noqa: PLC0415

        self._socket = socket
        self._root = root
        self._server = make_server(root)
        self._server.protocol.set_writer(self, include_headers=False)
        self._outgoing = Outgoing(socket)

    async def run(self, token: Token) -> None:
        """Serves an editor until it goes."""
        hello = await greeted(self._socket, token)
        if hello is None:
            return
        self._outgoing.send(rpc.answer(hello.id, {}))
        coroutines = (self._receive_all(), self._outgoing.send_all())
        tasks = [asyncio.create_task(coroutine) for coroutine in coroutines]
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    async def _receive_all(self) -> None:
        loop, pace = asyncio.get_running_loop(), Pace()
        async for text in received(self._socket):
            self._take(text or "")
            await asyncio.sleep(pace.wait(loop.time(), PACE, len(text or "")))

    def _take(self, text: str) -> None:
        if _is_answer(text):
            return  # nothing was asked that matters
        try:
            request = rpc.parsed(text)
            self._check(request)
        except RpcError as error:
            self._outgoing.send(rpc.refusal(error))
            return
        from pygls.exceptions import JsonRpcException  # noqa: PLC0415 - as above

        protocol = self._server.protocol
        try:
            protocol.handle_message(json.loads(text, object_hook=protocol.structure_message))
        except JsonRpcException:
            return  # the server has answered
        except (AttributeError, KeyError, TypeError, ValueError):
            fault = RpcError(rpc.INVALID_PARAMS, f"{request.method} has other parameters")
            self._outgoing.send(rpc.refusal(fault, request.id))

    def _check(self, request: Request) -> None:
        """Raises RpcError for a text outside of the root."""
        if request.method not in METHODS:
            message = f"there is no method {request.method[:80]!r}"
            raise RpcError(rpc.METHOD_NOT_FOUND, message, id_=request.id)
        if request.method.startswith("textDocument/"):
            document = request.params.get("textDocument")
            uri = document.get("uri") if isinstance(document, dict) else None
            if not isinstance(uri, str) or not self._is_below(uri):
                message = "only texts of the opened folder are spoken of"
                raise RpcError(rpc.INVALID_PARAMS, message, id_=request.id)

    def _is_below(self, uri: str) -> bool:
        from pygls.uris import to_fs_path  # noqa: PLC0415 - as above

        path = to_fs_path(uri) if uri.startswith("file:///") else None
        if path is None or "\0" in path:
            return False
        return Path(os.path.realpath(path)).is_relative_to(self._root)

    # What the server writes

    def write(self, data: bytes) -> None:
        """Sends a message of the language server, errors without internal data."""
        message: dict[str, Any] = json.loads(data)
        if isinstance(message.get("error"), dict):
            message["error"].pop("data", None)
        self._outgoing.send(json.dumps(message))

    def close(self) -> None:
        """Does nothing: the socket ends when the page closes it."""


def _is_answer(text: str) -> bool:
    """Tells whether a message is an answer to the server, which needs none."""
    try:
        message = json.loads(text)
    except (ValueError, RecursionError):
        return False
    return isinstance(message, dict) and "method" not in message and "id" in message


PAGE = Path(__file__).resolve().parent / "page"
"""Where the built page lies; `make studio` builds it."""


class Studio(Site):
    """The page of the studio and its sockets."""

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
