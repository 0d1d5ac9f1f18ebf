"""One bridge between a vehicle, an operator and a ROS node, with a network that can fail.

Each role is a process. What the bridge and its JAUS peers exchange passes a network of networks.py.
"""

import signal
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tests.live.bridge_support import PATIENCE, Process, wait_for

from .networks import FOLDER, Network, Udp
from .stamps import age

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

STALE = 2.5
"""Seconds after which a command must not be obeyed; bridges let none wait for more than two."""

_PROGRAMS = {"vehicle": "vehicle.py", "operator": "operator_unit.py", "ros": "ros_node.py"}


class System:
    """The processes, and what arrived where.

    Attributes:
        network: What joins the JAUS roles.
        running: The processes that run, by role.
    """

    def __init__(
        self,
        path: list[str],
        logs: Path,
        *,
        network: type[Network] = Udp,
        bridge: Sequence[str] = (),
        vehicle: Sequence[str] = (),
    ) -> None:
        """Starts all.

        Args:
            path: Folders of the generated packages.
            logs: Folder for the logs.
            network: What joins the JAUS roles.
            bridge: What the command line of the bridge begins with.
            vehicle: What that of the vehicle begins with, where it is started with nothing else.
        """
        self.path, self.logs, self._bridge, self._vehicle = path, logs, bridge, vehicle
        self.network = network(logs)
        self._all: dict[str, list[Process]] = {role: [] for role in ROLES}
        self.running: dict[str, Process] = {}
        first = self.network.first
        for role in sorted(ROLES, key=lambda role_name: role_name != first):
            self.start(role)
            if role == first:
                self.begins(role)

    def start(self, role: str, *arguments: str) -> None:
        """Starts a role that does not run."""
        number = len(self._all[role])
        line = ["-m", "loop_bridge.main", *self._bridge]
        if role != "bridge":
            usual = self._vehicle if role == "vehicle" else ()
            line = [str(FOLDER / _PROGRAMS[role]), *(arguments or usual)]
        if role != "ros":
            line += self.network.options(role)
        if role == "bridge":
            line += ["--ros-args", "-p", "diagnostics_frequency:=10.0"]
        self.running[role] = Process(line, self.path, self.logs / f"{role}-{number}.log")
        self._all[role].append(self.running[role])

    def begins(self, role: str) -> None:
        """Waits until a JAUS role runs: on a busy computer its start alone may take long."""
        log = self.running[role].log
        wait_for(
            lambda: " runs as " in log.read_text(errors="replace"), f"start of {role}", PATIENCE
        )

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

    def starts(self) -> dict[str, int]:
        """Returns how often each role was started."""
        return {role: len(processes) for role, processes in self._all.items()}

    def accounts(self) -> list[dict[str, Any]]:
        """Returns what receivers have said of what came from each peer, the oldest first."""
        told = [
            fact
            for role in ("ros", "vehicle", "operator")
            for process in self._all[role]
            for fact in process.of_kind("account")
        ]
        return sorted(told, key=lambda fact: fact["at"])

    def connections(self) -> dict[str, dict[str, Any]]:
        """Returns what each connection of the bridge said last of its messages."""
        facts = [fact for process in self._all["ros"] for fact in process.of_kind("connection")]
        return {fact["name"]: fact for fact in sorted(facts, key=lambda fact: fact["at"])}

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
            for connection in lacking:
                came = self.fresh(connection, since)
                if came is not None:
                    found[connection] = came - since
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
            for process in self.running.values():
                process.close()
            self.network.close()
        return codes

    def tracebacks(self) -> list[str]:
        """Returns the logs in which something failed without being foreseen."""
        found = []
        for log in sorted(self.logs.iterdir()):
            text = log.read_text(errors="replace")
            if "Traceback" in text:
                found.append(f"{log.name}: {text[text.index('Traceback') :][:1500]}")
        return found
