"""Messages to a page, which wait until it takes them; one that does not listen is left."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING

from starlette.websockets import WebSocketDisconnect

if TYPE_CHECKING:
    from starlette.websockets import WebSocket

_MOST_UNSENT = 1024
_TRY_AGAIN_LATER = 1013


class Outgoing:
    """What a socket is told."""

    def __init__(self, socket: WebSocket) -> None:
        self._socket = socket
        self._unsent: asyncio.Queue[str] = asyncio.Queue(_MOST_UNSENT)

    def tell(self, text: str) -> None:
        """Has a message sent, on the thread of the event loop."""
        with suppress(asyncio.QueueFull):
            self._unsent.put_nowait(text)

    async def send_all(self) -> None:
        """Sends what there is to tell until the page goes, or takes nothing any more."""
        with suppress(WebSocketDisconnect, RuntimeError):
            while not self._unsent.full():
                await self._socket.send_text(await self._unsent.get())
            await self._socket.close(_TRY_AGAIN_LATER)
