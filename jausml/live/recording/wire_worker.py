"""The process that passes recorded messages of ROS to generated bridges, and so to JAUS.

It answers each line of JSON on its input with one on its output; `jausml/live/workers` runs it. The
bridges are on the real network, and what they have of ROS is in this process. When the input ends
they are closed in good order: what they control is stopped and released.
"""

from __future__ import annotations

import json
import signal
import sys
import typing
from contextlib import ExitStack
from dataclasses import replace
from importlib import import_module
from random import Random

from jausml_runtime import Qos
from jausml_runtime.bridge.messages.limits import RosTypeError
from jausml_runtime.component.process import running_transport
from jausml_runtime.virtual import Link, RosGraph, VirtualRosNode

_OFFERED = Qos(durability="transient_local", depth=1)  # the quality that meets any subscription


class OpenBridges:
    """The bridges on the network."""

    def __init__(self) -> None:
        self._stack = ExitStack()
        self._bridges: list[typing.Any] = []
        self._graph: typing.Any = None

    def answer(self, request: dict[str, typing.Any]) -> typing.Any:
        """Returns the answer to a request."""
        if "bridges" in request:
            return self._open(request)
        if "message" in request:
            return self._publish(*request["message"])
        return self._close()

    def _open(self, request: dict[str, typing.Any]) -> typing.Any:
        for package, name, _ in request["bridges"]:
            self._bridges.append(getattr(import_module(f"{package}.{package}"), name)())
        try:
            settings = replace(self._bridges[0].settings.transport, **request["transport"])
            transport = self._stack.enter_context(running_transport(settings))
            self._graph = RosGraph(transport.loop, Random(), _ignore)
            for bridge, (_, _, node) in zip(self._bridges, request["bridges"], strict=True):
                bridge.open(VirtualRosNode(self._graph, node, {}, Link()), transport)
                self._stack.callback(bridge.close)
        except (OSError, ValueError) as error:
            self._stack.close()
            return {"error": str(error)}
        return {}

    def _publish(self, topic: str, kind: str, data: str) -> str:
        """Publishes a message; returns the reason if that fails, else an empty text."""
        with self._graph.loop.lock:
            try:
                self._graph.publish(topic, kind, bytes.fromhex(data), _OFFERED)
            except (RosTypeError, ValueError) as error:
                return str(error)
        return ""

    def _close(self) -> dict[str, typing.Any]:
        """Closes all bridges; returns their statistics by connection."""
        self._stack.close()
        return {
            f"{bridge.settings.name}.{connection.name}": _counts(connection.statistics)
            for bridge in self._bridges
            for connection in bridge.connections
        }


def _counts(statistics: typing.Any) -> dict[str, typing.Any]:
    return {
        "passed": statistics.passed,
        "arrivals": statistics.arrivals,
        "drops": dict(statistics.drops),
    }


def _ignore(_where: str, _data: bytes) -> None:
    """Takes a message for watchers, of which there are none."""


def main() -> None:
    """Answers requests until the input ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent process ends it
    wire = OpenBridges()
    try:
        for line in sys.stdin:
            sys.stdout.write(json.dumps(wire.answer(json.loads(line))) + "\n")
            sys.stdout.flush()
    finally:
        wire.answer({})


if __name__ == "__main__":
    main()
