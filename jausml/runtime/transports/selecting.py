"""The transports to choose from."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from ..base.settings import TransportKind
from .node_manager.transport import NodeManagerTransport
from .tcp.jtcp import JtcpTransport
from .transport import Transport
from .udp.judp import JudpTransport

if TYPE_CHECKING:
    from ..base.loop import Loop
    from ..base.settings import TransportSettings


class NetworkTransport(Transport, Protocol):
    """A transport that a process opens and closes."""

    def open(self) -> None:
        """Begin to send and receive.

        Raises:
            OSError: The network cannot be used as the settings say.
        """

    def close(self) -> None:
        """End; messages that wait are reported as lost."""


def create_transport(settings: TransportSettings, loop: Loop) -> NetworkTransport:
    """Return the transport that the settings name, not yet open.

    Args:
        settings: How messages travel, and the settings of that.
        loop: Loop on which messages are received.
    """
    if settings.transport is TransportKind.JTCP:
        return JtcpTransport(settings, loop)
    if settings.transport is TransportKind.NODE_MANAGER:
        return NodeManagerTransport(settings, loop)
    return JudpTransport(settings, loop)
