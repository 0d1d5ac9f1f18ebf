"""Publishes diagnostics in time, a few connections in each turn of the loop."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from .ends.ends import Ends
from .reports.accounting import Accounting
from .reports.diagnostic_array import DiagnosticArray
from .reports.diagnostics import (
    double_status,
    greeting_status,
    guardian_status,
    socket_status,
    state_status,
    traffic_status,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ..base.loop import Loop, Timer
    from .connections.carried import Carried
    from .ends.simulation import Simulation
    from .reports.diagnostics import ConnectionStatus
    from .reports.stops import Standing

_JAUS_AREAS = frozenset(["component", "judp", "jtcp", "transport"])
_UNKNOWN = "component.unknown_message"

SLICE = 4
"""Connections that are looked at in one turn: messages must not wait for all of them."""


class Diagnosed(Ends, Protocol):
    """A bridge as its diagnostics see it."""

    connections: list[Carried]
    simulation: Simulation | None
    standing: Standing


class Diagnosing:
    """Looks at all connections once each period."""

    def __init__(self, bridge: Diagnosed, period: float) -> None:
        """Does nothing before `start`.

        Args:
            period: Seconds from one report to the next.
        """
        self._bridge = bridge
        self._loop: Loop = bridge.loop
        self._period = period
        self._next = 0.0
        self._array: DiagnosticArray
        self._waiting: Sequence[Carried] = ()
        self._kernel_drops = 0
        self._dropped: Mapping[str, int] = {}
        self._accounting = Accounting(bridge.component)
        self._timer: Timer | None = None

    def start(self) -> None:
        """Begins; the first report comes after a period."""
        self._next = self._loop.now() + self._period
        self._timer = self._loop.call_at(self._next, self._begin)

    def stop(self) -> None:
        """Ends."""
        self._waiting = ()
        if self._timer is not None:
            self._timer.cancel()

    def _begin(self) -> None:
        self._next = max(self._next + self._period, self._loop.now())
        self._timer = self._loop.call_at(self._next, self._begin)
        if self._waiting:
            return  # connections are many and the period is short: this report ends first
        self._array = DiagnosticArray(self._bridge.ros.name)
        self._waiting = tuple(self._bridge.connections)
        self._go_on()

    def _go_on(self) -> None:
        present, self._waiting = self._waiting[:SLICE], self._waiting[SLICE:]
        for each in present:
            self._array.add(each.status())
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
        found = [state_status(own, bridge.standing, str(controller or ""))]
        double = bridge.component.transport.double_of(bridge.settings.address)
        if double is not None:
            found.append(double_status(double, self._loop.now()))
        unanswered = bridge.component.unanswered_greetings
        if unanswered:
            found.append(greeting_status(unanswered, own))
        ward = bridge.ward
        if ward is not None and ward.is_guarding:
            found.append(guardian_status(ward.told, ward.failure, own))
        if bridge.simulation is not None:
            found.append(bridge.simulation.status(own))
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
            found.append(traffic_status(dropped, {**former, _UNKNOWN: unknown}, own))
        drops = counters.snapshot().get("judp.kernel_dropped", 0)
        if drops:
            is_new, self._kernel_drops = drops > self._kernel_drops, drops
            found.append(socket_status(drops, own, is_new=is_new))
        return [*found, *self._accounting.statuses(self._loop.now())]
