"""Two hosts with real sockets, between which datagrams are lost by a seeded chance.

The clock is turned by the test, so that a minute takes no minute and the same seed loses the same.
"""

from __future__ import annotations

import random
import socket
from collections.abc import Callable
from types import TracebackType
from typing import Any

from ports import free_port

from jausml.runtime import ComponentSettings, Guard, JausComponent, ServiceIdentity, Status
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.loop import Loop
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.messages import SetTime
from jausml.runtime.transports.udp.judp import JudpTransport

CORE = tuple(
    ServiceIdentity(f"urn:jaus:jss:core:{name}", 1, 1)
    for name in ("Transport", "Events", "AccessControl", "Management")
)
VEHICLE = JausAddress(1, 1, 1)
OPERATOR = JausAddress(2, 1, 1)
STEP = 0.005


class LossyTransport(JudpTransport):
    """Loses a share of what its sockets receive."""

    def __init__(self, settings: TransportSettings, loop: Loop, share: float, seed: int) -> None:
        super().__init__(settings, loop)
        self.share = share
        self.late_share = 0.0
        self._random = random.Random(seed)

    def _reader(self, sock: socket.socket, *, by_multicast: bool) -> Callable[[], None]:
        return super()._reader(LossySocket(self, sock), by_multicast=by_multicast)

    def loses(self) -> bool:
        """Returns whether the next datagram is lost; it is counted then."""
        is_lost = self._random.random() < self.share
        if is_lost:
            self.counters.add("lost")
        return is_lost

    def holds_back(self) -> bool:
        """Returns whether the next datagram lets the one after it pass."""
        return self._random.random() < self.late_share


class LossySocket:
    """A socket that reads past what its transport loses, and some of it in another order."""

    def __init__(self, transport: LossyTransport, sock: socket.socket) -> None:
        self._transport = transport
        self._sock = sock
        self._held: Any = None
        self._late: Any = None

    def getsockopt(self, *arguments: int) -> Any:
        """Returns what the kernel says of the socket."""
        return self._sock.getsockopt(*arguments)

    def recvfrom(self, size: int) -> Any:
        """Returns the next datagram that is not lost."""
        while True:
            if self._late is not None:
                late, self._late = self._late, None
                return late
            received = self._sock.recvfrom(size)
            if self._transport.loses():
                continue
            if self._held is None and self._transport.holds_back():
                self._held = received
                continue
            self._late, self._held = self._held, None
            return received


class LossyNetwork:
    """A vehicle and an operator on two hosts; usable as a context.

    Attributes:
        vehicle: Obeys SetTime in Ready.
        operator: Has no session yet.
        obeyed: When the vehicle obeyed a command.
        times: What these commands said.
        uncontrolled: When the vehicle was not in Ready and controlled, at each step.
    """

    def __init__(self, share: float, seed: int, **settings: Any) -> None:
        self.time = 1000.0
        self.loop = Loop(clock=lambda: self.time)
        ports = [free_port(), free_port()]
        places = {VEHICLE: ("127.0.0.1", ports[0]), OPERATOR: ("127.0.0.1", ports[1])}
        self._transports = [
            LossyTransport(
                TransportSettings(port=port, address_book=places), self.loop, share, seed + number
            )
            for number, port in enumerate(ports)
        ]
        self._settings = ComponentSettings(**{"register_services": False, **settings})
        self.vehicle = self._vehicle()
        self.operator = self._component(1, OPERATOR, ())
        self.obeyed: list[float] = []
        self.times: list[Any] = []
        self.uncontrolled: list[float] = []

    def __enter__(self) -> LossyNetwork:
        for transport in self._transports:
            transport.open()
        self.vehicle.start()
        self.operator.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        for transport in self._transports:
            transport.close()
        self.loop.stop()

    def restart_vehicle(self) -> None:
        """Ends the vehicle without a word and starts a new one in its place."""
        self._transports[0].detach(VEHICLE)
        self.vehicle = self._vehicle()
        self.vehicle.start()

    def _vehicle(self) -> JausComponent:
        made = self._component(0, VEHICLE, CORE)
        made.handle(SetTime, self._obey, when=Guard.READY)
        return made

    def _obey(self, message: SetTime, _sender: JausAddress) -> None:
        self.obeyed.append(self.time)
        self.times.append(message.time_stamp)

    def _component(
        self, host: int, address: JausAddress, services: tuple[ServiceIdentity, ...]
    ) -> JausComponent:
        return JausComponent(
            self._transports[host],
            address,
            name=str(address),
            services=services,
            settings=self._settings,
        )

    def lose(self, share: float) -> None:
        """Changes the share that is lost."""
        for transport in self._transports:
            transport.share = share

    def delay(self, share: float) -> None:
        """Changes the share of the vehicle's datagrams that come after the next one."""
        self._transports[0].late_share = share

    def settle(self) -> None:
        """Lets everything happen that is due now."""
        while self.loop.run_once(0):
            pass

    def run(self, seconds: float) -> None:
        """Lets time pass."""
        self.settle()
        for _ in range(round(seconds / STEP)):
            self.time += STEP
            self.settle()
            if self.vehicle.controller != OPERATOR or self.vehicle.status is not Status.READY:
                self.uncontrolled.append(self.time)

    def longest_gap(self, since: float = 0.0) -> float:
        """Returns the longest time that the vehicle was not in Ready and controlled in one go."""
        longest = run = 0.0
        last = float("-inf")
        for moment in self.uncontrolled:
            if moment < since:
                continue
            run = run + STEP if moment - last < 1.5 * STEP else STEP
            last, longest = moment, max(longest, run)
        return longest
