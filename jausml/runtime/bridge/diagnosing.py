"""Publishes `/diagnostics` once each period: the connections, the process, the traffic of peers.

Only a few connections are asked in each turn of the loop, so that messages need not wait.
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
    """A connection as the bridge sees it. Everything runs on the loop, or with its lock."""

    name: str
    is_command: bool
    form: Form
    statistics: Statistics

    @property
    def when_lost(self) -> str:
        """The effect of lost control, in words for the log."""

    def open(self, ends: Ends) -> None:
        """Opens the JAUS and the ROS end."""

    def watch(self) -> None:
        """Begins to watch for silence of the source."""

    def follow(self, standing: Standing, lost: StopReason | None) -> bool:
        """Stops if it may not go on in a new standing; returns whether a command was stopped."""

    def lose(self, reason: StopReason) -> bool:
        """Stops a watched source, as time stands still; returns whether a command was stopped."""

    def end(self) -> bool:
        """Stops for good; returns whether a command was stopped."""

    def measure_latency(self, wanted: bool) -> None:  # noqa: FBT001
        """Begins or ends to measure the latency of messages."""

    def close_account(self) -> Sequence[tuple[str, int]]:
        """Returns the number of messages for each outcome."""

    def status(self) -> ConnectionStatus:
        """Returns its entry in `/diagnostics`."""


TYPE = "diagnostic_msgs/msg/DiagnosticArray"  # the type in ROS
_ENCODING = b"\0\1\0\0"
_LEVELS = {"ok": 0, "warning": 1, "error": 2, "stale": 3}
_LENGTH = struct.Struct("<I")
_BEGIN = struct.Struct("<iII4xI")  # stamp, empty name of a frame, number of statuses
_PADDING = (b"", b"\0\0\0", b"\0\0", b"\0")


class DiagnosticArray:
    """A `diagnostic_msgs/msg/DiagnosticArray` that is encoded (CDR) status by status.

    A bridge may have hundreds of connections, and encoding all in one go would delay messages.
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
        chunks = [*map(_encoded, texts), _LENGTH.pack(len(status.values)), *map(_encoded, pairs)]
        data = self._data
        data.append(_LEVELS[status.level])
        data += _PADDING[len(data) & 3]
        for chunk in chunks:
            data += _PADDING[len(data) & 3]
            data += chunk
        self._count += 1

    def serialized(self, stamp: Time) -> bytes:
        """Returns the encoded message."""
        _BEGIN.pack_into(self._data, 0, stamp.sec, stamp.nanosec, 1, self._count)
        return _ENCODING + self._data


def _encoded(text: str) -> bytes:
    data = text.encode() + b"\0"
    return _LENGTH.pack(len(data)) + data


LOSS_WINDOW = 10.0  # seconds over which the share of lost packets is computed
_WARNING_SHARE = 0.05  # share of lost packets above which a status warns
FEWEST_LOST = 3  # lost packets below which no status warns


class Accounting:
    """Makes the statuses of peers from the counts of transport and component, on the loop.

    A status warns if more than 5 % of the packets of a peer were lost lately, and that number is
    exact. It is not for a peer that may number its packets to all receivers in one sequence, as
    those to others look lost then.
    """

    def __init__(self, component: Accountable) -> None:
        self._component = component
        self._history: dict[JausAddress, deque[tuple[float, int, int]]] = {}

    def statuses(self, now: float) -> list[ConnectionStatus]:
        """Returns a status for each peer that packets came from, or were sent to."""
        own = str(self._component.address)
        accounts = accounts_of(self._component)
        peers = [account.traffic.peer for account in accounts]
        self._history = {peer: self._history.get(peer, deque()) for peer in peers}
        return [
            ConnectionStatus(
                f"account of {account.traffic.peer}",
                *self._recent_loss(account.traffic, now),
                own,
                tuple(account.facts()),
            )
            for account in accounts
        ]

    def _recent_loss(self, traffic: PeerTraffic, now: float) -> tuple[str, str]:
        """Returns a level, and the share of recent packets of a peer that were lost, in words."""
        history = self._history[traffic.peer]
        while len(history) > 1 and history[1][0] <= now - LOSS_WINDOW:
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
        return "warning" if share > _WARNING_SHARE and lost >= FEWEST_LOST else "ok", text


_JAUS_AREAS = frozenset(["component", "judp", "jtcp", "transport"])
_UNKNOWN = "component.unknown_message"
SLICE = 4  # connections that are asked for their status in one turn of the loop


class Diagnosed(Ends, Protocol):
    """The attributes of a bridge that its diagnostics need."""

    connections: list[Carried]
    simulation: Simulation | None
    standing: Standing


class Diagnosing:
    """Asks all connections for their status once each period (in seconds)."""

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
        """Starts; the first diagnostics are published after one period."""
        self._next = self._loop.now() + self._period
        self._timer.set_at(self._next, self._begin)

    def stop(self) -> None:
        """Stops publishing."""
        self._waiting = ()
        self._timer.cancel()

    def _begin(self) -> None:
        self._next = max(self._next + self._period, self._loop.now())
        self._timer.set_at(self._next, self._begin)
        if self._waiting:
            return  # the statuses of the last period are not complete yet
        self._array = DiagnosticArray(self._bridge.ros.name)
        self._waiting = tuple(self._bridge.connections)
        self._add_connections()

    def _add_connections(self) -> None:
        if not self._timer.is_set:
            return  # stopped meanwhile
        connections, self._waiting = self._waiting[:SLICE], self._waiting[SLICE:]
        for connection in connections:
            self._array.add(connection.status())
        if self._waiting:
            self._loop.call_soon(self._add_connections)
            return
        for status in self._process_statuses():
            self._array.add(status)
        ros = self._bridge.ros
        ros.publish_diagnostics(self._array.serialized(ros.now()))

    def _process_statuses(self) -> list[ConnectionStatus]:
        """Returns the statuses of the whole bridge: its state, and present problems."""
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
            # Broadcast messages also come to a bridge that does not know them: no warning.
            statuses.append(traffic_status(dropped, {**former, _UNKNOWN: unknown}, own))
        drops = counters.snapshot().get("judp.kernel_dropped", 0)
        if drops:
            is_new, self._kernel_drops = drops > self._kernel_drops, drops
            statuses.append(socket_status(drops, own, is_new=is_new))
        return [*statuses, *self._accounting.statuses(self._loop.now())]
