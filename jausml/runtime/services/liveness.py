"""The Liveness service: a heartbeat for whoever asks (AS5710)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..core_messages import QueryHeartbeatPulse, ReportHeartbeatPulse

if TYPE_CHECKING:
    from ..address import JausAddress
    from ..component_base import ComponentBase
    from ..message import Message


class LivenessService:
    """Answers QueryHeartbeatPulse; clients watch it through a periodic event."""

    def __init__(self, component: ComponentBase) -> None:
        """Serve the messages of Liveness."""
        component.provide(QueryHeartbeatPulse, ReportHeartbeatPulse, _pulse)


def _pulse(_query: Message, _sender: JausAddress) -> ReportHeartbeatPulse:
    return ReportHeartbeatPulse()
