"""The Liveness service: a heartbeat (AS5710)."""

from __future__ import annotations

from ..base.address import BROADCAST, WILDCARD_COMPONENT, WILDCARD_NODE, JausAddress
from ..base.clocks import Alarm
from ..messages import QueryHeartbeatPulse, ReportHeartbeatPulse
from .definitions import CORE, Scope
from .host import Host

UNSOLICITED = "urn:jaus:jss:iop:UnsolicitedHeartbeat"
"""Service of the IOP that promises an unrequested heartbeat."""

UNSOLICITED_RATE = 1.0  # rate in Hz of a component that provides it; the IOP leaves the rate open


class LivenessService:
    """Answers QueryHeartbeatPulse, and sends its report unasked if that is wanted."""

    urns = frozenset([CORE + "Liveness", CORE + "Liveliness"])  # v1.0 spells it both ways

    def __init__(self, component: Host) -> None:
        """Learns from settings and services of the component what it sends unasked."""
        self._component = component
        self._timer = Alarm(component.loop)
        settings, own = component.settings, component.address
        unsolicited = any(service.urn == UNSOLICITED for service in component.services)
        default = UNSOLICITED_RATE if unsolicited else 0.0
        self._rate = default if settings.heartbeat_rate is None else settings.heartbeat_rate
        subsystem = JausAddress(own.subsystem, WILDCARD_NODE, WILDCARD_COMPONENT)
        self._audience = BROADCAST if settings.heartbeat_scope is Scope.SYSTEM else subsystem
        self._speaks_first = False

    def attach(self) -> None:
        """Takes the messages of Liveness."""
        # The search for a Discovery server is heard as well.
        self._speaks_first = not self._component.settings.register_services
        self._component.provide(
            QueryHeartbeatPulse, ReportHeartbeatPulse, lambda *_: ReportHeartbeatPulse()
        )

    def start(self) -> None:
        """Begins to send unrequested heartbeats if any are wanted, or at least be heard once.

        Peers learn where a component is from what it sends, and some never forget where it was
        (Junior): one that starts again elsewhere and says nothing would not be found.
        """
        if self._rate > 0:
            self._beat()
        elif self._speaks_first:
            self._component.send(ReportHeartbeatPulse(), BROADCAST)

    def stop(self) -> None:
        """Sends no heartbeat any more."""
        self._timer.cancel()

    def _beat(self) -> None:
        self._timer.set(1.0 / self._rate, self._beat)
        self._component.send(ReportHeartbeatPulse(), self._audience)
