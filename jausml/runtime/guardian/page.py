"""What a bridge and its guardian share: a page of memory, and frames on a socket."""

from __future__ import annotations

import json
import mmap
import os
import struct
import time
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import socket
    from collections.abc import Mapping

MOST_STOPS = 1024
"""Connections, and datagrams, that one page has room for."""

MOST_OF_A_FRAME = 1 << 17
"""Bytes of the longest frame; a longer one is no stop of a robot."""

# Offsets in one page: 64 octets of words, a flag for each connection, a number for each slot.
_BEAT, _TAKEN, _SIMULATED, _REFUSED, _ARMED, _NUMBERS = 0, 8, 16, 24, 64, 64 + MOST_STOPS
_SIZE = 4096
_U64, _I64, _U16 = struct.Struct("<Q"), struct.Struct("<q"), struct.Struct("<H")


# CLOCK_MONOTONIC rests while the computer is suspended, and the robot may not.
_CLOCK = getattr(time, "CLOCK_BOOTTIME", time.CLOCK_MONOTONIC)


def steady_ns() -> int:
    """Returns nanoseconds that never go back, also those for which the computer was suspended."""
    return time.clock_gettime_ns(_CLOCK)


class Page:
    """The shared memory: each word of it is written by one side alone."""

    def __init__(self, descriptor: int) -> None:
        self._memory = mmap.mmap(descriptor, _SIZE)

    @staticmethod
    def descriptor() -> int:
        """Returns the descriptor of a new page, in which nothing is in motion yet."""
        # A file without a name, in memory: nobody else finds it, and it ends with its last user.
        memory_file = os.memfd_create("guardian")
        os.ftruncate(memory_file, _SIZE)
        return memory_file

    def close(self) -> None:
        """Gives the memory back."""
        self._memory.close()

    @property
    def beat(self) -> int:
        """When the bridge was there last, by `steady_ns`; 0 before anything moved."""
        return int(_U64.unpack_from(self._memory, _BEAT)[0])

    @beat.setter
    def beat(self, value: int) -> None:
        _U64.pack_into(self._memory, _BEAT, value)

    @property
    def taken(self) -> int:
        """How often the guardian has spoken, or was about to."""
        return int(_U64.unpack_from(self._memory, _TAKEN)[0])

    @taken.setter
    def taken(self, value: int) -> None:
        _U64.pack_into(self._memory, _TAKEN, value)

    @property
    def simulated(self) -> int:
        """Simulated ns when the bridge was there last; 0 where ROS has that of the system."""
        return int(_I64.unpack_from(self._memory, _SIMULATED)[0])

    @simulated.setter
    def simulated(self, value: int) -> None:
        _I64.pack_into(self._memory, _SIMULATED, value)

    @property
    def refused(self) -> int:
        """Topics and goals that the guardian cannot stop, as ROS refuses them."""
        return int(_U64.unpack_from(self._memory, _REFUSED)[0])

    @refused.setter
    def refused(self, value: int) -> None:
        _U64.pack_into(self._memory, _REFUSED, value)

    def is_armed(self, number: int) -> bool:
        """Whether something stands that the stops of a number must end."""
        return bool(self._memory[_ARMED + number])

    def arm(self, number: int, armed: bool) -> None:  # noqa: FBT001
        """Says whether something stands."""
        self._memory[_ARMED + number] = armed

    def sequence(self, slot: int) -> int:
        """The sequence number that the datagram of a slot should have."""
        return int(_U16.unpack_from(self._memory, _NUMBERS + 2 * slot)[0])

    def set_sequence(self, slot: int, number: int) -> None:
        """Says which sequence number the datagram of a slot should have."""
        _U16.pack_into(self._memory, _NUMBERS + 2 * slot, number & 0xFFFF)


def frame(kind: str, content: Mapping[str, Any]) -> bytes:
    """Returns what goes over the socket.

    Args:
        kind: What it is: `ros`, `stops`, `goal`, `done`, `nothing` or `bye`.
        content: What it says, as JSON has it; octets are hexadecimal.
    """
    return json.dumps({"kind": kind, **content}).encode()


def read_frame(channel: socket.socket) -> dict[str, Any] | None:
    """Returns the next frame of a socket; None when the other side is gone."""
    # SEQPACKET keeps frames apart: one read is one frame.
    data = channel.recv(MOST_OF_A_FRAME)
    if not data:
        return None
    content: dict[str, Any] = json.loads(data)
    return content
