"""One bridge between a vehicle, an operator and a ROS node, with a network that can fail.

Each role is a process. The bridge and its JAUS peers have a port each, and what they exchange
passes a proxy (proxy.py); or all share one port, as the programs of one host do.
"""

from __future__ import annotations

import json
import signal
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ports import free_port

from tests.live.bridge_support import Process, wait_for

from .stamps import age

if TYPE_CHECKING:
    from collections.abc import Sequence

FOLDER = Path(__file__).resolve().parent
ROLES = ("bridge", "vehicle", "operator", "ros")
CONNECTIONS = {
    "odometry": "ros",
    "pose": "ros",
    "cruise": "ros",
    "drive": "vehicle",
    "estimate": "operator",
}
"""What the bridge carries, and who gets it."""

COMMANDS = ("drive", "cruise")
WITH_STOP = ("drive", "cruise", "odometry")
"""Those for which something stands when their source is lost."""

PATIENCE = 30.0
STALE = 2.5
"""Seconds after which a command must not be obeyed; bridges let none wait for more than two."""

SEED = 7
_ADDRESSES = {"vehicle": "10.1.1", "operator": "20.1.1", "bridge": "10.1.9"}
_PROGRAMS = {"vehicle": "vehicle.py", "operator": "operator_unit.py", "ros": "ros_node.py"}


class System:
    """The processes, and what arrived where.

    Attributes:
        ports: Port of each JAUS role; where they share one, it is the same.
        running: The processes that run, by role.
    """

    def __init__(
        self, path: list[str], logs: Path, *, is_shared: bool = False, bridge: Sequence[str] = ()
    ) -> None:
        """Starts all.

        Args:
            path: Folders of the generated packages.
            logs: Folder for the logs.
            is_shared: Whether all have one port and no proxy.
            bridge: What the command line of the bridge begins with.
        """
        self.path, self.logs, self._bridge = path, logs, bridge
        one = free_port()
        self.ports = {role: one if is_shared else free_port() for role in _ADDRESSES}
        self._peers: dict[str, list[str]] = {role: [] for role in _ADDRESSES}
        self._all: dict[str, list[Process]] = {role: [] for role in ROLES}
        self.running: dict[str, Process] = {}
        self.proxy: Process | None = None if is_shared else self._proxy()
        # The first one owns a port that they share; there it is not the bridge.
        for role in sorted(ROLES, key=lambda each: each != "vehicle"):
            self.start(role)
            if role == "vehicle" and is_shared:
                self._wait_for_port()

    def _wait_for_port(self) -> None:
        log = self.running["vehicle"].log
        wait_for(lambda: " runs as " in log.read_text(), "start of the vehicle")

    def _proxy(self) -> Process:
        routes = []
        for role in ("vehicle", "operator"):
            seen_by_bridge, seen_by_role = free_port(), free_port()
            routes.append(f"{seen_by_bridge}={self.ports[role]}:{seen_by_role}")
            routes.append(f"{seen_by_role}={self.ports['bridge']}:{seen_by_bridge}")
            self._know("bridge", role, seen_by_bridge)
            self._know(role, "bridge", seen_by_role)
        line = [str(FOLDER / "proxy.py"), str(SEED), *routes]
        return Process(line, [], self.logs / "proxy.log", stdin=True)

    def _know(self, who: str, whom: str, port: int) -> None:
        self._peers[who] += ["--jaus-peer", f"{_ADDRESSES[whom]}=127.0.0.1:{port}"]

    def network(self, **fate: float) -> None:
        """Says how datagrams fare from now on; see proxy.py."""
        assert self.proxy is not None
        known = len(self.proxy.of_kind("counts"))
        self.proxy.tell(json.dumps(fate))
        wait_for(lambda: len(self.proxy.of_kind("counts")) > known, "answer of the proxy")

    def start(self, role: str, *arguments: str) -> None:
        """Starts a role that does not run."""
        number = len(self._all[role])
        line = ["-m", "loop_bridge.main", *self._bridge]
        if role != "bridge":
            line = [str(FOLDER / _PROGRAMS[role]), *arguments]
        if role != "ros":
            line += ["--jaus-port", str(self.ports[role]), *self._peers[role]]
        self.running[role] = Process(line, self.path, self.logs / f"{role}-{number}.log")
        self._all[role].append(self.running[role])

    def signal(self, role: str, number: int) -> None:
        """Sends a signal to a role."""
        self.running[role].popen.send_signal(number)

    def kill(self, role: str) -> None:
        """Ends a role as a crash does."""
        self.running.pop(role).kill()

    def end(self, role: str) -> None:
        """Asks a role to end, which it does without a failure."""
        assert self.running.pop(role).stop() == 0, role

    def arrivals(self, connection: str) -> list[dict[str, Any]]:
        """Returns what has arrived by a connection."""
        return [
            fact
            for process in self._all[CONNECTIONS[connection]]
            for fact in process.of_kind(connection)
        ]

    def fresh(self, connection: str, since: float) -> float | None:
        """Returns when the first message arrived that was sent since a time; None before."""
        for fact in self.arrivals(connection):
            at, value = fact["at"], fact["value"]
            if at > since and value and at - age(value, at) > since:
                return float(at)
        return None

    def flows(self, since: float, seconds: float = PATIENCE) -> dict[str, float]:
        """Waits until each connection has carried what was sent since a time.

        Returns:
            Seconds that it took, by connection.
        """
        found: dict[str, float] = {}
        end = time.monotonic() + seconds
        while lacking := CONNECTIONS.keys() - found.keys():
            for each in lacking:
                came = self.fresh(each, since)
                if came is not None:
                    found[each] = came - since
            assert time.monotonic() < end, f"nothing came by {sorted(lacking)} in {seconds} s"
            time.sleep(0.02)
        return found

    def stops(self, connection: str, since: float, seconds: float = PATIENCE) -> float:
        """Waits until a stop is the last word of a connection; returns when it came."""

        def last() -> dict[str, Any] | None:
            facts = self.arrivals(connection)
            return facts[-1] if facts and not facts[-1]["value"] else None

        return float(wait_for(last, f"stop of {connection}", seconds)["at"]) - since

    def oldest(self, connection: str, since: float) -> float:
        """Returns the greatest age of what arrived by a connection since a time."""
        ages = [
            age(fact["value"], fact["at"])
            for fact in self.arrivals(connection)
            if fact["at"] > since and fact["value"]
        ]
        return max(ages, default=0.0)

    def close(self) -> dict[str, int]:
        """Ends all; returns the exit codes by role."""
        codes = {}
        try:
            for role in reversed(ROLES):
                if role in self.running:
                    self.signal(role, signal.SIGCONT)
                    codes[role] = self.running.pop(role).stop()
        finally:
            for process in [*self.running.values(), *([self.proxy] if self.proxy else [])]:
                process.close()
        return codes

    def tracebacks(self) -> list[str]:
        """Returns the logs in which something failed without being foreseen."""
        found = []
        for log in sorted(self.logs.iterdir()):
            text = log.read_text(errors="replace")
            if "Traceback" in text:
                found.append(f"{log.name}: {text[text.index('Traceback') :][:1500]}")
        return found
