"""The bridges that stand side by side, and the ways through each of them."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path

from ends import PEER, JausEnd, RosEnd, drained, free_port, wait_until
from names import FLOOR, GENERATED, WAYS
from processes import Child, Children
from samples import Sample
from systems import System

HERE = Path(__file__).resolve().parent
PATIENCE = 20.0
"""Seconds in which the first message must be through."""


_FIRST_TRY, _LONGER = 0.05, 1.4
_QUIET = 0.7
"""Seconds without a message after which none is expected of the slowest bridge."""


class UnreachableError(RuntimeError):
    """Nothing comes through a bridge."""


class Loop:
    """Both ways of one kind of message through one bridge, from this process to this process.

    Attributes:
        variant: Which bridge.
        end: The socket of this process, which is the JAUS component that the bridge speaks with.
        processes: Those of the bridge: two for a floor.
    """

    end_class: type[JausEnd] = JausEnd

    def __init__(
        self, variant: str, ros: RosEnd, system: System, bridge: str, sample: Sample
    ) -> None:
        """Opens the ends; nothing is started.

        Args:
            variant: Which bridge.
            ros: The node of this process.
            system: The system that was generated.
            bridge: The bridge of the system.
            sample: What is sent.
        """
        self.variant = variant
        self.processes: list[Child] = []
        self.port = free_port()
        self.end = self.end_class(PEER, self.port)
        self.sample = sample
        self._bridge = bridge
        self._parts = self.end.outgoing(sample.jaus, system.address(bridge))
        self._code = sample.jaus[:2]
        self.subscription = ros.subscription(sample.ros_class, self.topic("up"))
        self.publisher = ros.publisher(sample.ros_class, self.topic("down"))

    def topic(self, way: str) -> str:
        """Returns the topic of a way."""
        return f"/{self.variant}/{self.sample.map}_{way}"

    def start(self, children: Children, folder: Path) -> None:
        """Starts the bridge.

        Args:
            children: Who starts processes.
            folder: Where files may be written.
        """
        if self.variant == FLOOR:
            self.processes = [self._floor(children, folder, way) for way in WAYS]
            return
        options = ["--jaus-port", str(self.port)]
        ros = ["--ros-args", "-r", f"__ns:=/{self.variant}"]
        if self.variant == GENERATED:
            ros += ["-p", "compiled:=false"]
        line = ["-m", f"{self._bridge}.main", *options, "--log-level", "warning"]
        self.processes = [children.start(*line, *ros)]

    def _floor(self, children: Children, folder: Path, way: str) -> Child:
        out = folder / f"{self.sample.kind}_{way}"
        out.write_bytes(self.sample.ros if way == "up" else self.sample.jaus)
        port = self.port if way == "up" else self.end.sock.getsockname()[1]
        options = ["--type", self.sample.type, "--topic", self.topic(way), "--port", str(port)]
        return children.start(HERE / "floor.py", way, out, *options)

    def send(self) -> None:
        """Sends a message towards ROS."""
        self.end.send(self._parts)

    def processor_time(self) -> float:
        """Returns the seconds of processor time that the bridge has taken."""
        return sum(process.processor_time() for process in self.processes)

    def until(self, came: Callable[[], bool]) -> None:
        """Waits until something has come through.

        Raises:
            UnreachableError: It did not, or the bridge has ended.
        """

        def done() -> bool:
            if not all(process.is_alive for process in self.processes):
                raise UnreachableError(f"{self.variant} of {self._bridge} has ended")
            return came()

        if not wait_until(done, PATIENCE, pause=0.0):
            raise UnreachableError(f"nothing comes through {self.variant} of {self._bridge}")

    def close(self) -> None:
        """Closes the socket."""
        self.end.close()

    def up(self, timeout: float = 1.0) -> float | None:
        """Sends a message and waits for it on the topic; microseconds, None when it was lost."""
        started = time.perf_counter_ns()
        self.end.send(self._parts)
        taken = self.subscription.take(timeout)
        arrived = time.perf_counter_ns()
        return (arrived - started) / 1e3 if taken is not None else None

    def down(self) -> float | None:
        """Publishes a message and waits for it at the socket; microseconds, None if it was lost."""
        started = time.perf_counter_ns()
        self.publisher.publish(self.sample.ros)
        came = self.end.receive(self._code)
        arrived = time.perf_counter_ns()
        return (arrived - started) / 1e3 if came else None

    def exchange(self, way: str) -> float | None:
        """Sends one message and waits for it; what has come late is thrown away before."""
        self.discard()
        return self.up() if way == "up" else self.down()

    def discard(self) -> int:
        """Throws away what waits at the ends; returns how much it was."""
        return self.subscription.discard() + self.end.discard()

    def reach(self) -> None:
        """Waits until messages come through both ways.

        Raises:
            UnreachableError: None came, or the bridge has ended.
        """
        # Ever more seldom: a slow bridge must work off what was sent while it started.
        timeouts = iter([_FIRST_TRY * _LONGER**n for n in range(100)])
        self.until(lambda: self.up(min(next(timeouts), 1.0)) is not None)
        self.until(lambda: self.down() is not None)


def settle(loops: Sequence[Loop]) -> None:
    """Waits until nothing comes any more of what was sent to find out whether it comes through."""
    drained(lambda: sum(loop.discard() for loop in loops), 0, quiet=_QUIET)


def reached(routes: Sequence[Loop], reach: Callable[[Loop], object]) -> list[Loop]:
    """Returns the bridges that messages come through; tells of the others and leaves them out.

    Args:
        routes: Bridges that were started.
        reach: Waits until messages come through one.
    """
    reached_routes = []
    for route in routes:
        try:
            reach(route)
        except UnreachableError as error:
            print(f"  left out: {error}", flush=True)
            route.close()
        else:
            reached_routes.append(route)
    return reached_routes
