"""The floor: forwards the same bytes between the same two sockets as a bridge, and no more.

Usage: floor.py up|down FILE --type PACKAGE/TYPE --topic TOPIC --port PORT

FILE has what goes out: on the way up the serialized ROS message, and PORT is where datagrams come
in; on the way down the encoded JAUS message, and PORT is where it goes. One process for each
direction: it waits for one socket, or for one topic.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from ends import FIRST_BRIDGE, LOOPBACK, PEER, RosEnd, datagrams, message_class, udp_socket

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


def main() -> None:
    """Runs until it is killed."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("way", choices=["up", "down"])
    parser.add_argument("file", type=Path)
    parser.add_argument("--type", required=True)
    parser.add_argument("--topic", required=True)
    parser.add_argument("--port", type=int, required=True)
    options = parser.parse_args()
    forward = up if options.way == "up" else down
    ros_class = message_class(options.type)
    forward(RosEnd("floor"), ros_class, options.topic, options.port, options.file.read_bytes())


if __name__ == "__main__":
    main()
