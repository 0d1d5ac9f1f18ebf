"""What a bridge and its guardian share: a page of memory, and frames on a socket."""

from __future__ import annotations

import ctypes
import json
import mmap
import os
import time
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import socket
    from collections.abc import Mapping

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
