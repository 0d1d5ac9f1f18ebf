"""The floor: forwards the same bytes between the same two sockets as a bridge, and no more.

Usage: floor.py up|down FILE --type PACKAGE/TYPE --topic TOPIC --port PORT [--relay LIBRARY]

FILE has what goes out: on the way up the serialized ROS message, and PORT is where datagrams come
in; on the way down the encoded JAUS message, and PORT is where it goes. One process for each
direction: it waits for one socket, or for one topic. LIBRARY has the loops in C (`relay.cpp`),
which get the ends that are opened here.
"""

from __future__ import annotations

import argparse
import ctypes
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ends import FIRST_BRIDGE, LOOPBACK, PEER, RosEnd, datagrams, message_class, udp_socket

from jausml.runtime.guardian.rcl import loaded_libraries

if TYPE_CHECKING:
    from collections.abc import Callable

_FLAGS = 4
_RAW = True
_INCOMPLETE = (1, 2)


def up(ros: RosEnd, ros_class: type, topic: str, port: int, out: bytes) -> None:
    """Publishes for each message that comes in, of one datagram or several."""
    receive = udp_socket(port).recv
    publish = ros.publisher(ros_class, topic).publish
    while True:
        if receive(65536)[_FLAGS] >> 6 not in _INCOMPLETE:
            publish(out)


def down(ros: RosEnd, ros_class: type, topic: str, port: int, out: bytes) -> None:
    """Sends a message for each one that is published."""
    subscription = ros.subscription(ros_class, topic)
    clear, add = subscription.wait_set.clear_entities, subscription.wait_set.add_subscription
    wait, handle = subscription.wait_set.wait, subscription.handle
    take, send = handle.take_message, udp_socket().sendto
    parts = datagrams(out, PEER, (1, 1, FIRST_BRIDGE))
    target, sequence = (LOOPBACK, port), 0
    while True:
        clear()
        add(handle)
        wait(-1)
        if take(ros_class, _RAW) is not None:
            for part in parts:
                sequence = sequence + 1 & 0xFFFF
                send(part + sequence.to_bytes(2, "little"), target)


def relay_up(library: Any) -> Callable[[RosEnd, type, str, int, bytes], None]:
    """Returns the same as `up` in C."""

    def relay(ros: RosEnd, ros_class: type, topic: str, port: int, out: bytes) -> None:
        publisher = ctypes.c_void_p(ros.publisher(ros_class, topic).handle.pointer)
        with udp_socket(port) as sock:
            library.relay_up(sock.fileno(), publisher, out, ctypes.c_size_t(len(out)))

    return relay


def relay_down(library: Any) -> Callable[[RosEnd, type, str, int, bytes], None]:
    """Returns the same as `down` in C."""

    def relay(ros: RosEnd, ros_class: type, topic: str, port: int, out: bytes) -> None:
        subscription = ros.subscription(ros_class, topic)
        parts = [each + bytes(2) for each in datagrams(out, PEER, (1, 1, FIRST_BRIDGE))]
        count = len(parts)
        buffers = [ctypes.create_string_buffer(each, len(each)) for each in parts]
        pointers = (ctypes.c_void_p * count)(*map(ctypes.addressof, buffers))
        sizes = (ctypes.c_size_t * count)(*map(len, parts))
        ends = (subscription.wait_set, subscription.handle)
        handles = [ctypes.c_void_p(each.pointer) for each in ends]
        with udp_socket() as sock:
            library.relay_down(sock.fileno(), port, *handles, pointers, sizes, count)

    return relay


def _loops(path: str) -> Any:
    """Returns the loops in C, which find the client library that rclpy has loaded."""
    ctypes.CDLL(loaded_libraries()["librcl.so"], ctypes.RTLD_GLOBAL)
    return ctypes.CDLL(path)


def main() -> None:
    """Runs until it is killed."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("way", choices=["up", "down"])
    parser.add_argument("file", type=Path)
    parser.add_argument("--type", required=True)
    parser.add_argument("--topic", required=True)
    parser.add_argument("--port", type=int, required=True)
    parser.add_argument("--relay")
    options = parser.parse_args()
    forward = up if options.way == "up" else down
    if options.relay:
        forward = (relay_up if options.way == "up" else relay_down)(_loops(options.relay))
    ros_class = message_class(options.type)
    forward(RosEnd("floor"), ros_class, options.topic, options.port, options.file.read_bytes())


if __name__ == "__main__":
    main()
