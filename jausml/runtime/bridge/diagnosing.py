"""Publishes diagnostics in time, a few connections in each turn of the loop.

What goes into them besides the connections is the traffic with each peer.
"""

from __future__ import annotations

import struct
from collections import deque
from collections.abc import Mapping, Sequence
from typing import Protocol

from ..base.address import JausAddress
from ..base.clocks import Alarm
from ..base.loop import Loop
from ..conversions import Time
from ..transports.packets.messenger import PeerTraffic
from ..transports.transport import Accountable, accounts_of
from .connections.translations import Form
from .ends.ends import Ends
from .ends.simulation import Simulation
from .reports.diagnostics import (
    ConnectionStatus,
    Statistics,
    double_status,
    greeting_status,
    guardian_status,
    socket_status,
    state_status,
    traffic_status,
)
from .reports.states import Standing, StopReason


class Carried(Protocol):
    """What a bridge carries: a connection. All of it runs on the loop, or with its lock."""

    name: str
    is_command: bool
    form: Form
    statistics: Statistics

    @property
    def when_lost(self) -> str:
        """What happens when the bridge may not command any more."""

    def open(self, ends: Ends) -> None:
        """Opens both ends."""

    def watch(self) -> None:
        """Begins to look for silence."""

    def follow(self, standing: Standing, lost: StopReason | None) -> bool:
        """Stops what must not go on in another standing; whether anything was commanded."""

    def lose(self, reason: StopReason) -> bool:
        """Stops what is watched, as time stands still; whether anything was commanded."""

    def end(self) -> bool:
        """Stops for good; whether anything was commanded."""

    def measure_latency(self, wanted: bool) -> None:  # noqa: FBT001
        """Begins or ends to measure how long messages take."""

    def close_account(self) -> Sequence[tuple[str, int]]:
        """Returns what became of all messages, by name."""

    def status(self) -> ConnectionStatus:
        """Returns what `/diagnostics` says of it."""


TYPE = "diagnostic_msgs/msg/DiagnosticArray"  # the type in ROS
_ENCODING = b"\0\1\0\0"
_LEVELS = {"ok": 0, "warning": 1, "error": 2, "stale": 3}
_LENGTH = struct.Struct("<I")
# The stamp, an empty name of a frame, and the number of statuses.
_BEGIN = struct.Struct("<iII4xI")
_PADDING = (b"", b"\0\0\0", b"\0\0", b"\0")


class DiagnosticArray:
    """A `diagnostic_msgs/msg/DiagnosticArray`, written status by status as ROS encodes it (CDR).

    A bridge may have hundreds of connections: to make their message in one go lets others wait.
    """

    TYPE = TYPE

    def __init__(self, node: str) -> None:
        self._node = node
        self._count = 0
        self._data = bytearray(_BEGIN.size)

    def add(self, status: ConnectionStatus) -> None:
        """Adds a status."""
        texts = [f"{self._node}: {status.name}", status.message, status.hardware_id]
        pairs = [text for pair in status.values for text in pair]
        written = [*map(_written, texts), _LENGTH.pack(len(status.values)), *map(_written, pairs)]
        data = self._data
        data.append(_LEVELS[status.level])
        data += _PADDING[len(data) & 3]
        for chunk in written:
            data += _PADDING[len(data) & 3]
            data += chunk
        self._count += 1

    def serialized(self, stamp: Time) -> bytes:
        """Returns the message."""
        _BEGIN.pack_into(self._data, 0, stamp.sec, stamp.nanosec, 1, self._count)
        return _ENCODING + self._data


def _written(text: str) -> bytes:
    data = text.encode() + b"\0"
    return _LENGTH.pack(len(data)) + data


LATELY = 10.0  # seconds over which the share of lost packets is told
MUCH = 0.05  # share of lost packets from which on a status warns
FEWEST_LOST = 3  # lost packets below which no status warns


class Accounting:
    """Makes the statuses of peers. All of it runs on the loop.

    It reads what the transport and the component count anyway, when a status is wanted. It warns of
    a peer of which more than 5 % were lost lately, if that is exact: of one that may number for all
    whom it talks to, what it sent to others looks lost.
    """

    def __init__(self, component: Accountable) -> None:
        self._component = component
        self._history: dict[JausAddress, deque[tuple[float, int, int]]] = {}

    def statuses(self, now: float) -> list[ConnectionStatus]:
        """Returns a status for each peer that something came from, or was sent to."""
        own = str(self._component.address)
        accounts = accounts_of(self._component)
        peers = [account.traffic.peer for account in accounts]
        self._history = {peer: self._history.get(peer, deque()) for peer in peers}
        return [
            ConnectionStatus(
                f"account of {account.traffic.peer}",
                *self._lately(account.traffic, now),
                own,
                tuple(account.facts()),
            )
            for account in accounts
        ]

    def _lately(self, traffic: PeerTraffic, now: float) -> tuple[str, str]:
        """Returns a level, and which share of what a peer sent lately was lost."""
        history = self._history[traffic.peer]
        while len(history) > 1 and history[1][0] <= now - LATELY:
            history.popleft()
        came, lost = history[0][1:] if history else (0, 0)
        account = traffic.account
        history.append((now, account.came, account.lost))
        came, lost = account.came - came, account.lost - lost
        if came <= 0:
            return "ok", "nothing came lately"
        if lost <= 0:
            return "ok", "nothing was lost lately"
        share = lost / (came + lost)
        text = f"{100 * share:.1f} % were lost on the way lately"
        if not account.is_exact:
            return "ok", f"{text}, at most"
        return "warning" if share > MUCH and lost >= FEWEST_LOST else "ok", text


_JAUS_AREAS = frozenset(["component", "judp", "jtcp", "transport"])
_UNKNOWN = "component.unknown_message"
SLICE = 4  # connections that are looked at in one turn: messages must not wait for all of them


class Diagnosed(Ends, Protocol):
    """A bridge as its diagnostics see it."""

    connections: list[Carried]
    simulation: Simulation | None
    standing: Standing


class Diagnosing:
    """Looks at all connections once each period."""

    def __init__(self, bridge: Diagnosed, period: float) -> None:
        self._bridge = bridge
        self._loop: Loop = bridge.loop
        self._period = period
        self._next = 0.0
        self._array: DiagnosticArray
        self._waiting: Sequence[Carried] = ()
        self._kernel_drops = 0
        self._dropped: Mapping[str, int] = {}
        self._accounting = Accounting(bridge.component)
        self._timer = Alarm(self._loop)

    def start(self) -> None:
        """Begins; the first report comes after a period."""
        self._next = self._loop.now() + self._period
        self._timer.set_at(self._next, self._begin)

    def stop(self) -> None:
        """Ends."""
        self._waiting = ()
        self._timer.cancel()

    def _begin(self) -> None:
        self._next = max(self._next + self._period, self._loop.now())
        self._timer.set_at(self._next, self._begin)
        if self._waiting:
            return  # connections are many and the period is short: this report ends first
        self._array = DiagnosticArray(self._bridge.ros.name)
        self._waiting = tuple(self._bridge.connections)
        self._go_on()

    def _go_on(self) -> None:
        if not self._timer.is_set:
            return  # it has ended since
        present, self._waiting = self._waiting[:SLICE], self._waiting[SLICE:]
        for connection in present:
            self._array.add(connection.status())
        if self._waiting:
            self._loop.call_soon(self._go_on)
            return
        for status in self._of_the_process():
            self._array.add(status)
        ros = self._bridge.ros
        ros.publish_diagnostics(self._array.serialized(ros.now()))

    def _of_the_process(self) -> list[ConnectionStatus]:
        """Returns what concerns no connection alone: the state, and what is not well."""
        bridge = self._bridge
        own, controller = str(bridge.settings.address), bridge.component.controller
        statuses = [state_status(own, bridge.standing, str(controller or ""))]
        double = bridge.component.transport.double_of(bridge.settings.address)
        if double is not None:
            statuses.append(double_status(double, self._loop.now()))
        unanswered = bridge.component.unanswered_greetings
        if unanswered:
            statuses.append(greeting_status(unanswered, own))
        ward = bridge.ward
        if ward is not None and ward.is_guarding:
            statuses.append(guardian_status(ward.description, ward.failure, own))
        if bridge.simulation is not None:
            statuses.append(bridge.simulation.status(own))
        counters = bridge.component.counters
        dropped = {
            name: count
            for name, count in counters.drops().items()
            if name.partition(".")[0] in _JAUS_AREAS
        }
        unknown = counters.snapshot().get(_UNKNOWN, 0)
        if unknown:
            dropped[_UNKNOWN] = unknown
        if dropped:
            former, self._dropped = self._dropped, dropped
            # Whatever is broadcast reaches those too who do not know it.
            statuses.append(traffic_status(dropped, {**former, _UNKNOWN: unknown}, own))
        drops = counters.snapshot().get("judp.kernel_dropped", 0)
        if drops:
            is_new, self._kernel_drops = drops > self._kernel_drops, drops
            statuses.append(socket_status(drops, own, is_new=is_new))
        return [*statuses, *self._accounting.statuses(self._loop.now())]
