"""The page of the operator unit: its sockets, its start and its end."""

from __future__ import annotations

import asyncio
import gc
import sys
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from contextlib import asynccontextmanager, suppress
from itertools import count
from pathlib import Path

from starlette.websockets import WebSocket, WebSocketDisconnect

from jausml.live.operating.knowledge import Knowledge, Learning
from jausml.live.operating.seats import Seat
from jausml.live.operating.unit import OperatorUnit, Powers
from jausml.live.peers.network import Network
from jausml.live.serving.server import MOST_SOCKETS, TRY_AGAIN_LATER, Site, Sockets
from jausml.live.serving.sockets import PageSocket
from jausml.live.serving.subscribers import Subscribers

# Folder of the built page; `make studio` builds it.
PAGE = Path(__file__).resolve().parent / "page"

KEPT_SOCKETS = 8  # sockets beyond `MOST_SOCKETS` before a page without commands is closed

_SWITCH = 0.001  # seconds for which a thread keeps the interpreter while others wait

# Seconds to wait until a page that gives way has closed its socket.
_SECONDS_TO_CLOSE = 0.5


class UnitSockets(Sockets):
    """Sockets of pages; of too many, the oldest page that may not command gives way."""

    def __init__(self) -> None:
        super().__init__()
        self.seats: dict[WebSocket, Seat] = {}

    async def _make_place(self, socket: WebSocket) -> bool:
        if len(self._sockets) <= MOST_SOCKETS + KEPT_SOCKETS:
            return True
        others = (other for other in self._sockets if other is not socket)
        first = next((other for other in others if not self.seats[other].may_command), None)
        if first is None:
            return False
        self._sockets.remove(first)
        # It may just have closed itself, or no longer read: the new page does not wait for it.
        with suppress(WebSocketDisconnect, RuntimeError, asyncio.TimeoutError):
            await asyncio.wait_for(first.close(TRY_AGAIN_LATER), _SECONDS_TO_CLOSE)
        return True


class OperatorSite(Site):
    """The web site of the operator unit, with a seat for each opened page."""

    def __init__(
        self, knowledge: Knowledge, learning: Learning, network: Network, powers: Powers | None
    ) -> None:
        """Creates the unit without pages (`ValueError`: a stop of `powers` is not valid)."""
        super().__init__(PAGE)
        self.learning = learning
        self._subscribers = Subscribers()
        self.unit = OperatorUnit(knowledge, network, powers, self._subscribers.notify)
        self._accepting = UnitSockets()
        self._numbers = count(1)

    @property
    def commanding_address(self) -> str:
        """The address of pages that may command; empty where none may."""
        powers = self.unit.powers
        return f"{self.address}&command={powers.token.text}" if powers is not None else ""

    @property
    def sockets(self) -> Mapping[str, Callable[[WebSocket], Awaitable[None]]]:
        """The socket of pages, by its path."""
        return {"/socket": self._serve_page}

    @asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        """Runs the unit as long as the context lasts."""
        self.unit.system.start()
        # A garbage collection of all present objects would delay a stop, so they are frozen, and
        # `OperatorUnit` collects while nobody commands.
        gc.collect()
        gc.freeze()
        gc.disable()
        # Threads of loops get the interpreter sooner.
        before = sys.getswitchinterval()
        sys.setswitchinterval(_SWITCH)
        try:
            self.learning.follow(self.unit.learn, self._note_end_of_learning)
            yield
        finally:
            try:
                await asyncio.to_thread(self.unit.system.stop)
            finally:
                sys.setswitchinterval(before)
                gc.unfreeze()
                gc.enable()

    def _note_end_of_learning(self) -> None:
        self.unit.journal.note("unit", "changes of the models are not seen any more")

    async def _serve_page(self, socket: WebSocket) -> None:
        seats = self._accepting.seats
        seats[socket] = Seat(self.unit, self._subscribers, next(self._numbers))
        try:
            async with self._accepting.accepted(socket) as is_accepted:
                if is_accepted:
                    await PageSocket(socket, seats[socket]).run(self.token)
        finally:
            del seats[socket]
