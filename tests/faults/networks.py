"""Networks between the bridge and its JAUS peers, which can fail."""

import json
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

from ports import free_port

from tests.live.bridge_support import Process, wait_for

FOLDER = Path(__file__).resolve().parent
MANAGER = FOLDER.parent / "runtime" / "junior_manager.py"
ADDRESSES = {"vehicle": "10.1.1", "operator": "20.1.1", "bridge": "10.1.9"}
SEED = 7


class Network:
    """A network with a process of its own, or with none.

    Attributes:
        ports: Port of each JAUS role.
        first: The role that starts first and is waited for.
    """

    first = ""

    def __init__(self, logs: Path) -> None:
        self.logs = logs
        self.ports = {role: free_port() for role in ADDRESSES}
        self._peers: dict[str, list[str]] = {role: [] for role in ADDRESSES}
        self._process: Process | None = None
        self._begin()

    def _begin(self) -> None:
        """Starts the process, if there is one."""

    def options(self, role: str) -> list[str]:
        """Returns what the command line of a role says of the network."""
        return ["--jaus-port", str(self.ports[role]), *self._peers[role]]

    def fare(self, **fate: float) -> None:
        """Says how what is sent fares from now on, and waits until it does."""
        assert self._process is not None
        known = len(self._process.of_kind("counts"))
        self._process.tell(json.dumps(fate))
        wait_for(lambda: len(self._process.of_kind("counts")) > known, "answer of the proxy")

    def close(self) -> None:
        """Ends the process."""
        if self._process is not None:
            self._process.close()

    def _know(self, who: str, whom: str, port: int) -> None:
        self._peers[who] += ["--jaus-peer", f"{ADDRESSES[whom]}=127.0.0.1:{port}"]

    def _proxy(self, program: str, arguments: Iterable[str]) -> None:
        line = [str(FOLDER / program), *arguments]
        self._process = Process(line, [], self.logs / "proxy.log", stdin=True)


class Udp(Network):
    """JUDP by way of a proxy; see proxy.py."""

    def _begin(self) -> None:
        routes = []
        for role in ("vehicle", "operator"):
            seen_by_bridge, seen_by_role = free_port(), free_port()
            routes.append(f"{seen_by_bridge}={self.ports[role]}:{seen_by_role}")
            routes.append(f"{seen_by_role}={self.ports['bridge']}:{seen_by_bridge}")
            self._know("bridge", role, seen_by_bridge)
            self._know(role, "bridge", seen_by_role)
        self._proxy("proxy.py", [str(SEED), *routes])

    def truths(self) -> dict[str, dict[str, int]]:
        """Returns what became of the packets of each pair until `fare`."""
        assert self._process is not None
        return self._process.of_kind("counts")[-1]["pairs"]


class OnePort(Network):
    """JUDP at one port, as the programs of one host have it; the vehicle owns it."""

    first = "vehicle"

    def _begin(self) -> None:
        self.ports = dict.fromkeys(ADDRESSES, free_port())


class Tcp(Network):
    """JTCP by way of a proxy; see tcp_proxy.py."""

    def _begin(self) -> None:
        routes = []
        for role in ("vehicle", "operator"):
            for who, whom in (("bridge", role), (role, "bridge")):
                port = free_port()
                routes.append(f"{port}={self.ports[whom]}")
                self._know(who, whom, port)
        self._proxy("tcp_proxy.py", routes)

    def options(self, role: str) -> list[str]:
        """Returns what the command line of a role says of the network."""
        return ["--jaus-transport", "jtcp", *super().options(role)]


class NodeManager(Network):
    """The programs of one host attached to a node manager, which can end."""

    def _begin(self) -> None:
        self._folder = self.logs.parent / "manager"
        self._folder.mkdir()
        self._log = (self.logs / "manager.log").open("ab")
        self.fare()

    def fare(self, **fate: float) -> None:
        """Ends the manager where `cut` says so, and starts it else."""
        if fate.get("cut"):
            self._end()
            return
        line = [str(MANAGER), str(self._folder), str(free_port()), "-"]
        self._manager = subprocess.Popen(
            [sys.executable, *line], stdout=self._log, stderr=self._log
        )
        wait_for((self._folder / "JuniorRTE").exists, "socket of the manager")

    def _end(self) -> None:
        self._manager.kill()
        self._manager.wait()

    def options(self, role: str) -> list[str]:
        """Returns what the command line of a role says of the network."""
        del role
        folder = str(self._folder)
        return ["--jaus-transport", "node-manager", "--jaus-node-manager-directory", folder]

    def close(self) -> None:
        """Ends the manager."""
        self._end()
        self._log.close()
