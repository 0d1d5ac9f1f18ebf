"""What a bridge and its guardian share: a page of memory, and frames on a socket."""

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

MOST_STOPS = 1024  # connections, and datagrams, that one page has room for
MOST_OF_A_FRAME = 1 << 17  # bytes of the longest frame; a longer one is no stop of a robot

# CLOCK_MONOTONIC rests while the computer is suspended, and the robot may not.
_CLOCK = getattr(time, "CLOCK_BOOTTIME", time.CLOCK_MONOTONIC)


def steady_ns() -> int:
    """Returns nanoseconds that never go back, also those for which the computer was suspended."""
    return time.clock_gettime_ns(_CLOCK)


class Page(ctypes.Structure):
    """The shared memory: each word of it is written by one side alone."""

    _fields_ = (
        ("beat", ctypes.c_uint64),
        ("taken", ctypes.c_uint64),
        ("simulated", ctypes.c_int64),
        ("refused", ctypes.c_uint64),
        ("armed", ctypes.c_bool * MOST_STOPS),
        ("numbers", ctypes.c_uint16 * MOST_STOPS),
    )
    beat: int  # when the bridge was there last, by `steady_ns`; 0 before anything moved
    taken: int  # how often the guardian has spoken, or was about to
    # Simulated ns when the bridge was there last; 0 where ROS has that of the system.
    simulated: int
    refused: int  # topics and goals that the guardian cannot stop, as ROS refuses them
    # By number of stops, whether something stands that they must end.
    armed: ctypes.Array[ctypes.c_bool]
    # By slot, the sequence number that its datagram should have.
    numbers: ctypes.Array[ctypes.c_uint16]

    @staticmethod
    def descriptor() -> int:
        """Returns the descriptor of a new page, in which nothing is in motion yet."""
        # A file without a name, in memory: nobody else finds it, and it ends with its last user.
        memory_file = os.memfd_create("guardian")
        os.ftruncate(memory_file, ctypes.sizeof(Page))
        return memory_file

    @classmethod
    def at(cls, descriptor: int) -> Page:
        """Returns the page of a descriptor; the memory is given back with it."""
        return cls.from_buffer(mmap.mmap(descriptor, ctypes.sizeof(Page)))


def frame(kind: str, content: Mapping[str, Any]) -> bytes:
    """Returns what goes over the socket: `ros`, `stops`, `goal`, `done`, `nothing` or `bye`."""
    return json.dumps({"kind": kind, **content}).encode()


def read_frame(channel: socket.socket) -> dict[str, Any] | None:
    """Returns the next frame of a socket; None when the other side is gone."""
    # SEQPACKET keeps frames apart: one read is one frame.
    data = channel.recv(MOST_OF_A_FRAME)
    if not data:
        return None
    content: dict[str, Any] = json.loads(data)
    return content


Route: TypeAlias = tuple[int, int]
"""Source and destination, which share one sequence of numbers."""


@dataclass
class _Slot:
    """Where the number of a route stands, how to find it out, and who sends on that route."""

    place: int
    sequence: Callable[[], int]
    users: set[object] = field(default_factory=set)


class Slots:
    """One place for each route, while somebody sends on it.

    Peers that a search finds are as many as the network says, and a page has an end: who finds no
    place has no stop, which is told.
    """

    def __init__(self) -> None:
        self._slots: dict[Route, _Slot] = {}
        self._refused: set[Route] = set()

    @property
    def refused(self) -> int:
        """How many routes have found no place."""
        return len(self._refused)

    def take(self, user: object, route: Route, sequence: Callable[[], int]) -> int | None:
        """Returns the place of a route until all users have given it back; None without room.

        The sequence returns the number that the next datagram should have.
        """
        slot = self._slots.get(route)
        if slot is None:
            if len(self._slots) >= MOST_STOPS:
                self._refused.add(route)
                return None
            taken = {other.place for other in self._slots.values()}
            place = next(place for place in range(MOST_STOPS) if place not in taken)
            slot = self._slots[route] = _Slot(place, sequence)
            self._refused.discard(route)
        slot.users.add(user)
        return slot.place

    def give_back(self, user: object, route: Route) -> None:
        """Takes note that somebody does not send on a route any more."""
        self._refused.discard(route)
        slot = self._slots.get(route)
        if slot is not None:
            slot.users.discard(user)
            if not slot.users:
                del self._slots[route]

    def clear(self) -> None:
        """Takes all places back."""
        self._slots.clear()
        self._refused.clear()

    def write(self, page: Page) -> None:
        """Notes the sequence numbers that datagrams should have now."""
        for slot in self._slots.values():
            page.numbers[slot.place] = slot.sequence()
