"""The two ends of what is measured: raw datagrams here, serialized messages of ROS there."""

from __future__ import annotations

import contextlib
import importlib
import socket
import struct
import time
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.impl.implementation_singleton import rclpy_implementation as implementation
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions

from jausml.runtime.base.address import JausAddress
from jausml.runtime.transports.packets.packet import AckNak, DataFlags, Packet

Numbers = tuple[int, int, int]
LOOPBACK = "127.0.0.1"
PEER, FIRST_BRIDGE = (1, 1, 1), 10
"""JAUS addresses: the end that measures, and one that takes what nobody measures.

The third is the component number of the first bridge of a system; the others follow.
"""

QUERY_STATUS, REPORT_STATUS = b"\x02\x20", b"\x02\x40"
"""Encoded query, and the code of its answer."""

FRAGMENT = 4079
"""Payload of the largest packet that AS5669A foresees, and that bridges send."""

QOS = QoSProfile(
    depth=100,
    history=HistoryPolicy.KEEP_LAST,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.VOLATILE,
)
"""That of the measured connections."""

_SEQUENCE = struct.Struct("<H")
_FLAGS, _ADDRESSES, _CODE, _BODY = 4, struct.Struct("<II"), slice(13, 15), 13
_ACKNOWLEDGE = 4
_BUFFER = 1 << 20
_HALF = 1 << 15
"""Half of the sequence numbers, so that two processes may speak for one component."""

_SECOND = 10**9
_RAW = True
_TURN = 0.001
_QUIET = 0.3
"""Seconds without a message after which no more are expected."""

_LONGEST_REST = 20.0


@cache
def message_class(name: str) -> Any:
    """Returns the class of a ROS type such as `geometry_msgs/PointStamped`."""
    package, _, kind = name.partition("/")
    return getattr(importlib.import_module(f"{package}.msg"), kind.rpartition("/")[2])


def datagrams(payload: bytes, destination: Numbers, source: Numbers) -> list[bytes]:
    """Returns the datagrams of a message without their sequence numbers.

    Args:
        payload: The encoded message.
        destination: JAUS address of the receiver.
        source: JAUS address of the sender.
    """
    parts = [payload[at : at + FRAGMENT] for at in range(0, len(payload), FRAGMENT)]
    places = [DataFlags.SINGLE]
    if len(parts) > 1:
        places = [DataFlags.FIRST, *[DataFlags.MIDDLE] * (len(parts) - 2), DataFlags.LAST]
    ends = JausAddress(*destination), JausAddress(*source)
    return [
        Packet(*ends, part, data_flags=place).encode()[: -_SEQUENCE.size]
        for part, place in zip(parts, places, strict=True)
    ]


def udp_socket(port: int = 0, timeout: float = 0.0) -> socket.socket:
    """Returns a bound socket.

    Args:
        port: Its port; 0 for any.
        timeout: Seconds that it waits for a datagram; 0 means forever.
    """
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sock.bind((LOOPBACK, port))
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFER)
    whole, part = divmod(timeout, 1)
    sock.setsockopt(
        socket.SOL_SOCKET, socket.SO_RCVTIMEO, struct.pack("@ll", int(whole), int(part * 1e6))
    )
    return sock


def free_port() -> int:
    """Returns a UDP port that nobody has at the moment."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind((LOOPBACK, 0))
        port: int = probe.getsockname()[1]
    return port


class JausEnd:
    """A socket that speaks for one JAUS component: messages out, and whole messages in.

    Attributes:
        sock: The socket.
        numbers: How many sequence numbers it takes by turns.
    """

    numbers = _HALF

    def __init__(self, address: Numbers, port: int, sock: socket.socket | None = None) -> None:
        """Opens the socket.

        Args:
            address: The component.
            port: Port of the other end on this computer.
            sock: The socket of another process that speaks for the component too; it numbers its
                messages otherwise.
        """
        self.sock = udp_socket(timeout=1.0) if sock is None else sock
        self._address = address
        self._target = (LOOPBACK, port)
        self._sequence = 0
        self._first = 0 if sock is None else _HALF

    def close(self) -> None:
        """Closes the socket."""
        self.sock.close()

    def outgoing(self, payload: bytes, destination: Numbers) -> list[bytes]:
        """Returns what `send` takes."""
        return datagrams(payload, destination, self._address)

    def send(self, parts: Sequence[bytes]) -> None:
        """Sends a message."""
        for part in parts:
            self._sequence = (self._sequence + 1) % self.numbers
            self.sock.sendto(part + _SEQUENCE.pack(self._first + self._sequence), self._target)

    def receive(self, code: bytes, flags: int = 0) -> bool:
        """Waits for a message; acknowledges what asks for it.

        Args:
            code: The first two bytes of its payload.
            flags: Flags of the receiving, such as `MSG_DONTWAIT`.

        Returns:
            Whether one came before the time-out of the socket.
        """
        while True:
            try:
                data = self.sock.recv(65536, flags)
            except BlockingIOError:
                return False
            place = data[_FLAGS] >> 6
            self.heard(data)
            if place == DataFlags.LAST or (place == DataFlags.SINGLE and data[_CODE] == code):
                return True

    def discard(self) -> int:
        """Takes what waits; returns the number of datagrams."""
        count = 0
        with contextlib.suppress(BlockingIOError):
            while True:
                self.heard(self.sock.recv(65536, socket.MSG_DONTWAIT))
                count += 1
        return count

    def heard(self, data: bytes) -> None:
        """Acknowledges a datagram that asks for it."""
        if data[_FLAGS] >> _ACKNOWLEDGE & 3 != AckNak.REQUESTED:
            return
        destination, source = _ADDRESSES.unpack_from(data, _FLAGS + 1)
        header = struct.pack("<BBHBII", 2, 0, 14, 1 | AckNak.ACK << 4, source, destination)
        self.sock.sendto(header + data[-_SEQUENCE.size :], self._target)


class Subscription:
    """A topic from which serialized messages are taken, with a wait set of its own.

    Attributes:
        handle: The subscription.
        wait_set: A wait set for it alone.
        missed: Messages of the one publisher that never came, by the numbers that `discard` saw.
    """

    def __init__(self, node: Any, context: Context, ros_class: type[Any], topic: str) -> None:
        """Subscribes.

        Args:
            node: The node.
            context: Its context.
            ros_class: Class of the messages.
            topic: The topic.
        """
        self._subscription = node.create_subscription(ros_class, topic, print, QOS, raw=True)
        self.handle = self._subscription.handle
        self.wait_set = implementation.WaitSet(1, 0, 0, 0, 0, 0, context.handle)
        self._class = ros_class
        self.missed = 0
        self._next: int | None = None

    def take(self, timeout: float = 1.0) -> bytes | None:
        """Waits for a message and takes it; None when none came in some seconds."""
        self.wait_set.clear_entities()
        self.wait_set.add_subscription(self.handle)
        self.wait_set.wait(int(timeout * _SECOND))
        taken = self.handle.take_message(self._class, _RAW)
        return taken[0] if taken is not None else None

    def discard(self) -> int:
        """Takes what waits; returns the number of messages."""
        count = 0
        while (taken := self.handle.take_message(self._class, _RAW)) is not None:
            count += 1
            number = taken[1]["publication_sequence_number"]
            if self._next is not None:
                self.missed += max(number - self._next, 0)
            self._next = number + 1
        return count


class RosEnd:
    """A node that publishes and takes serialized messages, without an executor."""

    def __init__(self, name: str, arguments: Sequence[str] | None = None) -> None:
        """Joins ROS.

        Args:
            name: Name of the node.
            arguments: Command line with `--ros-args`.
        """
        self.context = Context()
        rclpy.init(
            args=list(arguments or ()),
            context=self.context,
            signal_handler_options=SignalHandlerOptions.NO,
        )
        self.node = rclpy.create_node(
            name, context=self.context, enable_rosout=False, start_parameter_services=False
        )

    def subscription(self, ros_class: type[Any], topic: str) -> Subscription:
        """Returns a subscription."""
        return Subscription(self.node, self.context, ros_class, topic)

    def publisher(self, ros_class: type[Any], topic: str) -> Any:
        """Returns a publisher of serialized messages."""
        return self.node.create_publisher(ros_class, topic, QOS)

    def close(self) -> None:
        """Leaves ROS."""
        self.node.destroy_node()
        self.context.try_shutdown()


def paced(
    send: Callable[[], None], drain: Callable[[], int], rate: float, seconds: float
) -> tuple[int, int]:
    """Sends evenly for some seconds, and takes what comes meanwhile.

    Args:
        send: Sends a message.
        drain: Takes what waits; returns how much it was.
        rate: Messages a second.
        seconds: How long.

    Returns:
        How many were sent, and how many were taken.
    """
    sent = taken = 0
    start = time.perf_counter()
    while (elapsed := time.perf_counter() - start) < seconds:
        for _ in range(int(elapsed * rate) + 1 - sent):
            send()
            sent += 1
        taken += drain()
        left = min(start + sent / rate - time.perf_counter(), _TURN)
        if left > 0:
            time.sleep(left)
    return sent, taken


def drained(drain: Callable[[], int], seconds: float, quiet: float = _QUIET) -> int:
    """Takes what comes for some seconds, and then until nothing comes.

    Args:
        drain: Takes what waits; returns how much it was.
        seconds: How long in any case.
        quiet: Seconds without anything after which no more is expected.

    Returns:
        How much it was.
    """
    taken = 0
    last = time.perf_counter()
    end = last + seconds
    while (now := time.perf_counter()) < end or now < last + quiet:
        amount = drain()
        if amount:
            taken, last = taken + amount, now
        if now > end + _LONGEST_REST:
            break
        time.sleep(_TURN)
    return taken


def wait_until(condition: Callable[[], bool], seconds: float, pause: float = 0.002) -> bool:
    """Waits for a condition; returns whether it was met in time."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(pause)
    return True
