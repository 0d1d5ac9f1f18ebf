"""The web application of the operator unit: its page, its sockets, its start and its end."""

from __future__ import annotations

import asyncio
import gc
import sys
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING

from starlette.applications import Starlette
from starlette.routing import WebSocketRoute
from starlette.websockets import WebSocketDisconnect

from jausml.live.operating.seats import Seat
from jausml.live.operating.unit import OperatorUnit
from jausml.live.serving import server
from jausml.live.serving.security import Token
from jausml.live.serving.server import MOST_SOCKETS, TRY_AGAIN_LATER, Sockets, routes_of
from jausml.live.serving.sockets import PageSocket
from jausml.live.serving.subscribers import Subscribers

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable

    from starlette.types import ASGIApp
    from starlette.websockets import WebSocket

    from jausml.live.operating.knowledge import Knowledge, Learning
    from jausml.live.operating.unit import Powers
    from jausml.live.peers.network import Network
    from jausml.live.serving.security import Served

PAGE = Path(__file__).resolve().parent / "page"
"""Where the built page lies; `make studio` builds it."""

KEPT_SOCKETS = 8
"""Further sockets, for pages that may command."""

_SWITCH = 0.001
"""Seconds for which a thread keeps the interpreter from others that want it."""

_SECONDS_TO_CLOSE = 0.5
"""Seconds in which the page that gives way must have taken that it is closed."""


class Operating:
    """The operator unit, and a seat for each page."""

    def __init__(self, knowledge: Knowledge, network: Network, powers: Powers | None) -> None:
        """Begins with nobody (`ValueError`: a declared stop is none)."""
        self.powers = powers
        self.subscribers = Subscribers()
        self.unit = OperatorUnit(knowledge, network, powers, self.subscribers.notify)
        self._numbers = count(1)

    def seat(self) -> Seat:
        """Returns a place for a page."""
        return Seat(self.unit, self.subscribers, next(self._numbers))


class UnitSockets(Sockets):
    """Sockets of pages; some places are kept for pages that may command.

    Where all places are taken, the page that only looks and came first is closed for the next one.
    """

    def __init__(self) -> None:
        super().__init__()
        self.seats: dict[WebSocket, Seat] = {}

    async def _has_place(self, socket: WebSocket) -> bool:
        if len(self._sockets) <= MOST_SOCKETS + KEPT_SOCKETS:
            return True
        others = (other for other in self._sockets if other is not socket)
        first = next((other for other in others if not self.seats[other].may_command), None)
        if first is None:
            return False
        self._sockets.remove(first)
        # It may just have closed itself, or read nothing any more: who comes does not wait for it.
        with suppress(WebSocketDisconnect, RuntimeError, asyncio.TimeoutError):
            await asyncio.wait_for(first.close(TRY_AGAIN_LATER), _SECONDS_TO_CLOSE)
        return True


@dataclass
class Unit:
    """The operator unit as an application of a web server."""

    operating: Operating
    learning: Learning
    served: Served
    page: Path
    token: Token = field(default_factory=Token)
    _sockets: UnitSockets = field(default_factory=UnitSockets)

    @property
    def address(self) -> str:
        """The address to look; the token stands where browsers send it to nobody."""
        return f"http://{self.served.authority}/#token={self.token.text}"

    @property
    def commanding_address(self) -> str:
        """The address of those who may command too; empty where nobody may."""
        powers = self.operating.powers
        return f"{self.address}&command={powers.token.text}" if powers is not None else ""

    def app(self) -> ASGIApp:
        """Returns the application."""
        index, files = routes_of(self.page)
        socket = WebSocketRoute("/socket", self._socket)
        return Starlette(routes=[index, socket, files], lifespan=self._lifespan)

    @asynccontextmanager
    async def _lifespan(self, _: Starlette) -> AsyncIterator[None]:
        unit = self.operating.unit
        unit.start()
        self.learning.follow(unit.learn, self._unlearnt)
        # What is there stays, and is looked at no more: a collection of it takes long, and a stop
        # waited for it. `OperatorUnit` collects while nobody commands.
        gc.collect()
        gc.freeze()
        gc.disable()
        # Loops that wait for the interpreter have it soon.
        before = sys.getswitchinterval()
        sys.setswitchinterval(_SWITCH)
        try:
            yield
        finally:
            await asyncio.to_thread(unit.stop)
            sys.setswitchinterval(before)
            gc.unfreeze()
            gc.enable()

    def _unlearnt(self) -> None:
        self.operating.unit.journal.note("unit", "changes of the models are not seen any more")

    async def _socket(self, socket: WebSocket) -> None:
        seat = self._sockets.seats[socket] = self.operating.seat()
        try:
            async with self._sockets.accepted(socket) as is_accepted:
                if is_accepted:
                    await PageSocket(socket, seat).run(self.token)
        finally:
            del self._sockets.seats[socket]


def serve(
    operating: Operating,
    learning: Learning,
    host: str,
    port: int,
    opened: Callable[[Unit], None],
) -> None:
    """Serves the unit until SIGINT, SIGTERM or SIGHUP comes; the main thread calls it.

    Args:
        opened: Is called as soon as the addresses can be opened.

    Raises:
        OSError: The port cannot be had.
    """
    units: list[Unit] = []

    def app(served: Served) -> ASGIApp:
        units.append(Unit(operating, learning, served, PAGE))
        return units[0].app()

    server.serve(host, port, app, lambda: opened(units[0]))
