"""Memory and frames that a bridge and its guardian share."""

from __future__ import annotations

import ctypes
import json
import mmap
import os
import socket
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

MAX_STOPS = 1024  # connections, and routes of datagrams, for which a page has room
MAX_FRAME_SIZE = 1 << 17  # bytes of the longest frame

# CLOCK_MONOTONIC stops while the computer is suspended, but the robot may not.
_CLOCK = getattr(time, "CLOCK_BOOTTIME", time.CLOCK_MONOTONIC)


def steady_ns() -> int:
    """Returns nanoseconds of a steady clock, which goes on while the computer is suspended."""
    return time.clock_gettime_ns(_CLOCK)


class Page(ctypes.Structure):
    """The shared memory; each word of it is written by one of the two processes only."""

    _fields_ = (
        ("beat", ctypes.c_uint64),
        ("taken", ctypes.c_uint64),
        ("simulated", ctypes.c_int64),
        ("refused", ctypes.c_uint64),
        ("armed", ctypes.c_bool * MAX_STOPS),
        ("numbers", ctypes.c_uint16 * MAX_STOPS),
    )
    beat: int  # `steady_ns` of the last turn of the bridge; 0 before its first command
    taken: int  # number of times that the guardian has begun to send stops
    simulated: int  # simulated ns at the beat; 0 without simulated time
    refused: int  # topics and goals that the guardian cannot stop, as ROS refuses them
    armed: ctypes.Array[ctypes.c_bool]  # by number of a connection: whether it needs its stops
    numbers: ctypes.Array[ctypes.c_uint16]  # by slot: sequence number of the next datagram

    @staticmethod
    def descriptor() -> int:
        """Returns the descriptor of a new page without armed stops: an unnamed file in memory."""
        memory_file = os.memfd_create("guardian")
        os.ftruncate(memory_file, ctypes.sizeof(Page))
        return memory_file

    @classmethod
    def at(cls, descriptor: int) -> Page:
        """Returns the page of a descriptor."""
        return cls.from_buffer(mmap.mmap(descriptor, ctypes.sizeof(Page)))


def frame(kind: str, content: Mapping[str, Any]) -> bytes:
    """Returns a frame of a kind: `ros`, `stops`, `goal`, `done`, `nothing` or `bye`."""
    return json.dumps({"kind": kind, **content}).encode()


def read_frame(channel: socket.socket) -> dict[str, Any] | None:
    """Returns the next frame of a SEQPACKET socket; None if the other process has closed it."""
    data = channel.recv(MAX_FRAME_SIZE)
    if not data:
        return None
    content: dict[str, Any] = json.loads(data)
    return content


Route: TypeAlias = tuple[int, int]  # source and destination, which have one sequence of numbers


@dataclass
class _Slot:
    """Index of the number of a route in the page, its source, and the users of the route."""

    index: int
    next_number: Callable[[], int]
    users: set[object] = field(default_factory=set)


class Slots:
    """Assigns an index in the page to each route while it has users.

    A search may find more peers than a page has slots; further ones have no stop, which is
    reported.
    """

    def __init__(self) -> None:
        self._slots: dict[Route, _Slot] = {}
        self._refused: set[Route] = set()

    @property
    def refused(self) -> int:
        """Number of routes without a slot."""
        return len(self._refused)

    def take(self, user: object, route: Route, next_number: Callable[[], int]) -> int | None:
        """Returns the index of a route until all users have given it back; None without room.

        Args:
            next_number: Returns the sequence number of the next datagram.
        """
        slot = self._slots.get(route)
        if slot is None:
            if len(self._slots) >= MAX_STOPS:
                self._refused.add(route)
                return None
            used = {other.index for other in self._slots.values()}
            index = next(index for index in range(MAX_STOPS) if index not in used)
            slot = self._slots[route] = _Slot(index, next_number)
            self._refused.discard(route)
        slot.users.add(user)
        return slot.index

    def give_back(self, user: object, route: Route) -> None:
        """Removes a user of a route."""
        self._refused.discard(route)
        slot = self._slots.get(route)
        if slot is not None:
            slot.users.discard(user)
            if not slot.users:
                del self._slots[route]

    def clear(self) -> None:
        """Removes all routes."""
        self._slots.clear()
        self._refused.clear()

    def write(self, page: Page) -> None:
        """Writes the next sequence numbers into a page."""
        for slot in self._slots.values():
            page.numbers[slot.index] = slot.next_number()
