"""The transports to choose from."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from .jtcp import JtcpTransport
from .judp import JudpTransport
from .node_manager import NodeManagerTransport
from .settings import TransportKind
from .transport import Transport

if TYPE_CHECKING:
    from .loop import Loop
    from .settings import TransportSettings


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
