"""Measures the latency that a generated bridge adds, beside plain ping-pongs in the same run.

Usage: bridge_latency.py [--rounds N]

Four exchanges take turns, so that they meet the same machine:

    ros     this process -> ROS -> echo node       -> ROS -> this process     (two ROS hops)
    jaus    this process -> JAUS -> echo component -> JAUS -> this process    (two JAUS hops)
    up      this process -> JAUS -> bridge         -> ROS -> this process     (one of each)
    down    this process -> ROS  -> bridge         -> JAUS -> this process    (one of each)

An up or a down is one ROS hop, one JAUS hop and the bridge, as a ros and a jaus are two hops and an
echo each. So half a ros plus half a jaus is what an exchange would take if a bridge cost as much as
an echo; the ratio to it is the figure to trust on a shared machine. Echo and bridge all use rclpy's
SingleThreadedExecutor and typed messages.
"""

# ruff: noqa: PLC0415 - each role imports what it has: ROS, JAUS, the toolchain

from __future__ import annotations

import argparse
import contextlib
import os
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING

HERE = Path(__file__).resolve().parent
CLIENT, BRIDGE, ECHO = "10.1.1", "10.1.9", "10.1.5"
PATIENCE = 30.0

if TYPE_CHECKING:
    from collections.abc import Callable


def generate(folder: Path) -> list[str]:
    """Generates the bridge; returns the folders for the module path."""
    from jausml.generation import render
    from jausml.generators.bridge.target import TARGET as BRIDGE_TARGET
    from jausml.generators.messages.target import TARGET as MESSAGES_TARGET
    from jausml.generators.runtime.target import TARGET as RUNTIME_TARGET
    from jausml.model import read_models

    model = read_models([HERE / "bridge_latency.xmi"]).model
    for artifact in render(model, [BRIDGE_TARGET, MESSAGES_TARGET, RUNTIME_TARGET]):
        path = folder / artifact.path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(artifact.text, encoding="utf-8")
    return [str(path) for path in sorted(folder.iterdir()) if (path / path.name).is_dir()]


# ------------------------------------------------------------------ echoes


def echo_ros() -> None:
    """Publishes each `ping` as `pong`."""
    import rclpy
    from geometry_msgs.msg import TwistStamped
    from rclpy.executors import ExternalShutdownException

    rclpy.init()
    node = rclpy.create_node("echo")
    publisher = node.create_publisher(TwistStamped, "pong", 1)
    node.create_subscription(TwistStamped, "ping", publisher.publish, 1)
    with contextlib.suppress(ExternalShutdownException):
        rclpy.spin(node)


def echo_jaus(port: int) -> None:
    """Sends each message back to its sender."""
    from jausml_runtime.base.address import JausAddress
    from jausml_runtime.base.loop import Loop
    from jausml_runtime.base.settings import TransportSettings
    from jausml_runtime.transports.udp.judp import JudpTransport

    own, loop = JausAddress.parse(ECHO), Loop()
    transport = JudpTransport(TransportSettings(port=port), loop)
    transport.open()
    transport.attach(own, lambda m: transport.send(own, m.source, m.payload))
    loop.start()
    signal.pause()


# ------------------------------------------------------------------ the measuring process


class Peer:
    """The JAUS and ROS ends in this process, each with a thread that waits.

    They wait before a message is sent, so that what rclpy does before it waits is not measured.
    """

    def __init__(self, port: int) -> None:
        """Joins both networks.

        Args:
            port: JAUS port of the run.
        """
        import rclpy
        from geometry_msgs.msg import TwistStamped
        from jausml_runtime import ComponentSettings, JausComponent
        from jausml_runtime.base.address import JausAddress
        from jausml_runtime.base.loop import Loop
        from jausml_runtime.base.settings import TransportSettings
        from jausml_runtime.transports.udp.judp import JudpTransport
        from measured_bridge.messages import SetVelocityCommand
        from rclpy.executors import SingleThreadedExecutor

        self.targets = {name: JausAddress.parse(name) for name in (BRIDGE, ECHO)}
        self.loop = Loop()
        self.transport = JudpTransport(TransportSettings(port=port), self.loop)
        self.transport.open()
        self.client = JausComponent(
            self.transport,
            JausAddress.parse(CLIENT),
            name="client",
            services=(),
            settings=ComponentSettings(register_services=False),
        )
        self.client.on_message(SetVelocityCommand, self._received)
        # The bridge obeys commands of its controller alone.
        self.client.control(self.targets[BRIDGE], authority=200)
        self.client.start()
        self.command = SetVelocityCommand(velocity_x=2.0, velocity_y=0.5, yaw_rate=0.25)
        rclpy.init()
        self.node = rclpy.create_node("measure")
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        self.twist = TwistStamped()
        self.twist.twist.linear.x, self.twist.twist.linear.y = 2.0, -0.5
        self.publishers = {
            topic: self.node.create_publisher(TwistStamped, topic, 1) for topic in ("ping", "down")
        }
        for topic in ("pong", "up"):
            self.node.create_subscription(TwistStamped, topic, self._received, 1)
        self.arrived = 0.0
        self.event = threading.Event()
        self.loop.start()
        threading.Thread(target=self.executor.spin, daemon=True).start()

    def _received(self, *_message: object) -> None:
        self.arrived = time.perf_counter()
        self.event.set()

    def exchange(self, send: Callable[[], None]) -> float | None:
        """Sends and waits for what comes back; microseconds, None when nothing came."""
        self.event.clear()
        started = time.perf_counter()
        send()
        return (self.arrived - started) * 1e6 if self.event.wait(1.0) else None

    def publish(self, topic: str) -> None:
        """Publishes a message."""
        self.publishers[topic].publish(self.twist)

    def send(self, target: str) -> None:
        """Sends a command."""
        self.client.send(self.command, self.targets[target])

    def measure(self, rounds: int) -> dict[str, list[float]]:
        """Runs the exchanges by turns; the first tenth warms up."""
        kinds: dict[str, Callable[[], float | None]] = {
            "ros": lambda: self.exchange(lambda: self.publish("ping")),
            "jaus": lambda: self.exchange(lambda: self.send(ECHO)),
            "up": lambda: self.exchange(lambda: self.send(BRIDGE)),
            "down": lambda: self.exchange(lambda: self.publish("down")),
        }
        for name, kind in kinds.items():
            end = time.monotonic() + PATIENCE
            while kind() is None:
                if time.monotonic() > end:
                    raise SystemExit(f"{name}: nothing comes back")
        found: dict[str, list[float]] = {name: [] for name in kinds}
        for number in range(rounds):
            for name, kind in kinds.items():
                taken = kind()
                if taken is not None and number >= rounds // 10:
                    found[name].append(taken)
                time.sleep(0.002)
        return found


def report(found: dict[str, list[float]]) -> None:
    """Prints the table and the ratios."""
    middle = {name: statistics.median(values) for name, values in found.items()}
    print(f"{'exchange':10} {'n':>6} {'median us':>10} {'p95':>8} {'p99':>8}")
    for name, values in found.items():
        cuts = statistics.quantiles(values, n=100)
        print(f"{name:10} {len(values):6} {middle[name]:10.0f} {cuts[94]:8.0f} {cuts[98]:8.0f}")
    expected = (middle["ros"] + middle["jaus"]) / 2
    print(f"half a ros and half a jaus: {expected:.0f} us")
    for name in ("up", "down"):
        added = middle[name] - expected
        print(f"{name}: {middle[name] / expected:.2f} of that, {added:+.0f} us over an echo")


def main() -> None:
    """Starts the processes, measures, reports."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--rounds", type=int, default=500)
    parser.add_argument("--role", choices=["ros", "jaus"], help=argparse.SUPPRESS)
    parser.add_argument("--port", type=int, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.role == "ros":
        echo_ros()
    elif options.role == "jaus":
        echo_jaus(options.port)
    else:
        supervise(options.rounds)


def supervise(rounds: int) -> None:
    """Runs the echoes and the bridge as processes and measures from this one."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    with tempfile.TemporaryDirectory() as folder:
        path = generate(Path(folder))
        sys.path += path
        os.environ.update(
            ROS_AUTOMATIC_DISCOVERY_RANGE="LOCALHOST",
            ROS_DOMAIN_ID=str(10 + os.getpid() % 90),
            PYTHONPATH=os.pathsep.join(path),
        )
        lines = [
            [__file__, "--role", "ros"],
            [__file__, "--role", "jaus", "--port", str(port)],
            ["-m", "measured_bridge.main", "--jaus-port", str(port), "--log-level", "warning"],
        ]
        processes = [subprocess.Popen([sys.executable, *line]) for line in lines]
        try:
            report(Peer(port).measure(rounds))
        finally:
            for process in processes:
                process.send_signal(signal.SIGTERM)
            for process in processes:
                process.wait(PATIENCE)


if __name__ == "__main__":
    main()
