"""JAUS through the node manager of the host, which owns the port (Junior's local protocol)."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from ..port_holder import MANAGER
from ..transport import Transport
from .client import NodeManagerClient

if TYPE_CHECKING:
    from ...base.address import JausAddress
    from ...base.loop import Loop, Timer
    from ...base.settings import TransportSettings
    from ..delivery import Receive, Take
    from ..packets.messenger import Messenger

_WATCH_INTERVAL_S = 1.0


class NodeManagerTransport(Transport):
    """Components of this process as clients of the node manager of their host.

    The manager has the network: it finds peers, sends and receives for its clients, and passes
    messages on between them. Each component is a client of its own, which acknowledges and
    repeats by itself. A manager that ends or restarts is noticed, and the components attach
    again, less and less often while there is none.
    """

    def __init__(self, settings: TransportSettings, loop: Loop) -> None:
        """Prepare a transport; ``open`` begins to look for the manager."""
        super().__init__(settings, loop)
        self._folder = Path(settings.node_manager_directory or tempfile.gettempdir())
        self._clients: dict[JausAddress, NodeManagerClient] = {}
        self._watch: Timer | None = None
        self._is_open = False

    def open(self) -> None:
        """Attach the components; those that come later are attached when they come.

        Raises:
            OSError: The folder of the local sockets cannot be used, or a component of the same
                address is attached by another process.
        """
        if not self._folder.is_dir():
            raise OSError(f"there is no folder {self._folder} for the node manager's sockets")
        with self.loop.lock:
            self._is_open = True
            self._plan_watch()
            try:
                for client in self._clients.values():
                    client.open()
            except OSError:
                self.close()
                raise

    def close(self) -> None:
        """Take leave of the manager; messages that wait are reported as lost."""
        with self.loop.lock:
            self._is_open = False
            if self._watch is not None:
                self._watch.cancel()
                self._watch = None
            for client in self._clients.values():
                client.close()

    def is_attached(self, address: JausAddress) -> bool:
        """Return whether the manager accepted a component."""
        client = self._clients.get(address)
        return client is not None and client.is_attached

    def _attach(self, address: JausAddress, receive: Receive, take: Take | None) -> None:
        if address in self._clients:
            raise ValueError(f"{address} is attached already")
        client = NodeManagerClient(
            self._settings, self.loop, self._folder, MANAGER, address, self.quirks
        )
        client.messenger.inbox.attach(address, receive, take)
        if self._is_open:
            client.open()
        # Copied, not changed: send() reads it on other threads without a lock.
        self._clients = {**self._clients, address: client}

    def _detach(self, address: JausAddress) -> None:
        client = self._clients.get(address)
        self._clients = {known: each for known, each in self._clients.items() if known != address}
        if client is not None:
            client.close()

    def _messenger_of(self, source: JausAddress) -> Messenger[str] | None:
        client = self._clients.get(source)
        return None if client is None else client.messenger

    def _plan_watch(self) -> None:
        self._watch = self.loop.call_later(_WATCH_INTERVAL_S, self._look_after)

    def _look_after(self) -> None:
        """Notice a manager that ended or restarted even when nobody sends."""
        for client in self._clients.values():
            client.check()
        self._plan_watch()
