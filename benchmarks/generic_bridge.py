"""A generic bridge: it reads the model when it starts and interprets it for each message.

Usage: generic_bridge.py MODEL BRIDGE --jaus-port PORT [--ros-args ...]

A ROS node on typed messages with the executor of rclpy, and a JAUS component on the transport of
jausml. It is what one would write without a generator: no control, limits, counters or diagnostics.
"""

from __future__ import annotations

import argparse
import contextlib
import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import interpreting
import rclpy
import systems
from ends import QOS
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.utilities import remove_ros_args

from jausml.language.metamodel.classes import bridge
from jausml.live.messages import Catalogue
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.loop import Loop
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.transports.udp.judp import JudpTransport

if TYPE_CHECKING:
    from collections.abc import Callable

    from interpreting import Interpreter


class GenericBridge:
    """The connections of a bridge of a model."""

    def __init__(self, element: bridge.Bridge, catalogue: Catalogue, port: int) -> None:
        """Opens both sides.

        Args:
            element: The bridge in the model.
            catalogue: The messages of the model.
            port: JAUS port.
        """
        self.node = rclpy.create_node("generic")
        self._address = JausAddress.parse(str(element.address))
        self._takers: dict[int, Callable[[bytes], None]] = {}
        loop = Loop()
        self._transport = JudpTransport(TransportSettings(port=port), loop)
        self._transport.open()
        found = interpreting.interpreters(element, catalogue.message)
        for each in element.bridgeConnections:
            interpreter = found[str(each.name)]
            topic = str(each.topics[0].name)
            if each.direction.name == "jausToRos":
                code = int(str(each.map.message.code), 16)
                self._takers[code] = self._publishing(interpreter, topic)
            else:
                self._subscribe(interpreter, topic, str(each.peers[0].address))
        self._transport.attach(self._address, self._receive)
        loop.start()

    def _publishing(self, interpreter: Interpreter, topic: str) -> Callable[[bytes], None]:
        publisher = self.node.create_publisher(interpreter.ros_class, topic, QOS)
        return lambda payload: publisher.publish(interpreter.to_ros(payload))

    def _subscribe(self, interpreter: Interpreter, topic: str, peer: str) -> None:
        send = partial(self._transport.send, self._address, JausAddress.parse(peer))
        take = lambda message: send(interpreter.to_jaus(message))  # noqa: E731
        self.node.create_subscription(interpreter.ros_class, topic, take, QOS)

    def _receive(self, message: Any) -> None:
        taker = self._takers.get(int.from_bytes(message.payload[:2], "little"))
        if taker is not None:
            taker(message.payload)


def main() -> None:
    """Runs until it is ended."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("model", type=Path)
    parser.add_argument("bridge")
    parser.add_argument("--jaus-port", type=int, required=True)
    options = parser.parse_args(remove_ros_args(sys.argv)[1:])
    model = systems.read_system(options.model)
    element = next(each for each in model.instances(bridge.Bridge) if each.name == options.bridge)
    rclpy.init(args=sys.argv)
    executor = SingleThreadedExecutor()
    executor.add_node(GenericBridge(element, Catalogue(model), options.jaus_port).node)
    with contextlib.suppress(ExternalShutdownException, KeyboardInterrupt):
        executor.spin()


if __name__ == "__main__":
    main()
