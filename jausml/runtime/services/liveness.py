"""The Liveness service: a heartbeat (AS5710)."""

from __future__ import annotations

from ..base.address import BROADCAST, WILDCARD_COMPONENT, WILDCARD_NODE, JausAddress
from ..base.clocks import Alarm
from ..messages import QueryHeartbeatPulse, ReportHeartbeatPulse
from .definitions import CORE, Scope
from .host import Host

UNSOLICITED = "urn:jaus:jss:iop:UnsolicitedHeartbeat"
UNSOLICITED_RATE = 1.0  # in Hz, for a component that provides it; the IOP does not state a rate


class LivenessService:
    """Answers QueryHeartbeatPulse, and sends unsolicited heartbeats if the settings say so."""

    urns = frozenset([CORE + "Liveness", CORE + "Liveliness"])  # v1.0 spells it both ways

    def __init__(self, component: Host) -> None:
        """Sends nothing before `start`; rate and receivers are those of the settings."""
        self._component = component
        self._timer = Alarm(component.loop)
        settings, own = component.settings, component.address
        unsolicited = any(service.urn == UNSOLICITED for service in component.services)
        default = UNSOLICITED_RATE if unsolicited else 0.0
        self._rate = default if settings.heartbeat_rate is None else settings.heartbeat_rate
        subsystem = JausAddress(own.subsystem, WILDCARD_NODE, WILDCARD_COMPONENT)
        self._receivers = BROADCAST if settings.heartbeat_scope is Scope.SYSTEM else subsystem
        self._announces = False

    def attach(self) -> None:
        """Takes the messages of Liveness."""
        # Otherwise the search for a Discovery server announces the component.
        self._announces = not self._component.settings.register_services
        self._component.provide(
            QueryHeartbeatPulse, ReportHeartbeatPulse, lambda *_: ReportHeartbeatPulse()
        )

    def start(self) -> None:
        """Begins to send unsolicited heartbeats, or sends a single one.

        Peers learn the endpoint of a component from its packets, and some never forget it (Junior):
        they would not find a silent component that has moved.
        """
        if self._rate > 0:
            self._beat()
        elif self._announces:
            self._component.send(ReportHeartbeatPulse(), BROADCAST)

    def stop(self) -> None:
        """Stops sending heartbeats."""
        self._timer.cancel()

    def _beat(self) -> None:
        self._timer.set(1.0 / self._rate, self._beat)
        self._component.send(ReportHeartbeatPulse(), self._receivers)
