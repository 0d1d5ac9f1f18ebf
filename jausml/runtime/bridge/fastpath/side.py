"""Both directions of the fast path of one bridge."""

from __future__ import annotations

import time
from functools import partial
from typing import TYPE_CHECKING

from ...transports.udp.judp import JudpTransport
from .library import Library, NoFastPathError
from .receiving import FastReceiver
from .sending import FastSubscriber, SharedNumbers

if TYPE_CHECKING:
    from ctypes import CDLL

    from ...base.fast_path import FastSending
    from ...component.component import JausComponent


class FastSide:
    """Lets a compiled core have the usual messages of a bridge alone."""

    def __init__(self, core: CDLL, component: JausComponent) -> None:
        """Begins to receive with the core.

        Raises:
            NoFastPathError: Messages cannot pass a core alone here.
        """
        transport = component.transport
        if not isinstance(transport, JudpTransport) or component.loop.now is not time.monotonic:
            raise NoFastPathError("the network or the clock is not that of the system")
        self._library = Library(core)
        self._transport = transport
        transport.count_by(partial(SharedNumbers, self._library))
        self._receiver = FastReceiver(self._library, transport, component)
        transport.receive_by(self._receiver.receiver)

    def subscriber(self, subscription: int, path: FastSending) -> FastSubscriber | None:
        """Returns what takes the messages of a subscription; None where they cannot go alone."""
        try:
            return FastSubscriber(self._library, subscription, path)
        except LookupError:
            return None

    def close(self) -> None:
        """Has Python receive again."""
        self._transport.receive_by(None)
        self._receiver.close()
