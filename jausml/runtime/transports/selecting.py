"""Selection of a transport."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..base.settings import TransportKind
from .node_manager import NodeManagerTransport
from .tcp.jtcp import JtcpTransport
from .udp.judp import JudpTransport

if TYPE_CHECKING:
    from ..base.loop import Loop
    from ..base.settings import TransportSettings
    from .transport import Transport


def create_transport(settings: TransportSettings, loop: Loop) -> Transport:
    """Return the transport that the settings name, not yet open."""
    if settings.transport is TransportKind.JTCP:
        return JtcpTransport(settings, loop)
    if settings.transport is TransportKind.NODE_MANAGER:
        return NodeManagerTransport(settings, loop)
    return JudpTransport(settings, loop)
