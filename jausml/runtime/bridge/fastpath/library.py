"""The compiled core as Python calls it: its functions, and structures that both read.

The other side is the template fastpath.hpp of the generators, which becomes part of each core.
"""

from __future__ import annotations

import ctypes
import os
import socket
import struct
import sys
from typing import Any

from ..messages.compiled import Translation

AT_ONCE = 32  # messages that a core passes on before they are written down

# Laid out as the structs of fastpath.hpp: "@" aligns as the compiler does, padding included.
TAKEN = struct.Struct("@dQPNPNIHB1x")
"""A message that was taken: when, what was left out, where it is, its size, where the sizes of its
packets are, how many there are, the index of its route, the number of the last packet, and whether
it was acknowledged."""

SENT = struct.Struct("@dqQIIi4x")
"""A message that was sent: when it was taken, when it was published, what was left out, the index
of its subscription, how many datagrams have gone, and the error of the one that has not."""


class NoFastPathError(Exception):
    """Messages cannot pass a core alone here; the text says why."""


# Structures repeat those of fastpath.hpp field by field: core and Python share the memory.
class Ros(ctypes.Structure):
    """Functions of the client library of ROS."""

    _fields_ = tuple(
        (name, ctypes.c_void_p) for name in ("publish", "take", "forget_error", "allocator")
    )


class Order(ctypes.Structure):
    """What is known of the messages of one kind from one component."""

    _fields_ = (
        ("latest_at", ctypes.c_double),
        ("latest", ctypes.c_uint16),
        ("has_latest", ctypes.c_uint8),
        ("expected", ctypes.c_uint8),
    )


class Route(ctypes.Structure):
    """Which messages are usual, and what is done with them."""

    _fields_ = (
        ("source", ctypes.c_uint32),
        ("destination", ctypes.c_uint32),
        ("host", ctypes.c_uint32),
        ("code", ctypes.c_uint32),
        ("port", ctypes.c_uint16),
        ("flags", ctypes.c_uint8),
        ("answer", ctypes.c_uint8),
        ("is_event", ctypes.c_uint8),
        ("event", ctypes.c_uint8),
        ("is_ordered", ctypes.c_uint8),
        ("index", ctypes.c_uint32),
        ("publisher", ctypes.c_void_p),
        ("translation", ctypes.POINTER(Translation)),
        ("order", Order),
    )


class Datagram(ctypes.Structure):
    """A datagram that is left to Python."""

    _fields_ = (
        ("data", ctypes.c_void_p),
        ("size", ctypes.c_size_t),
        ("host", ctypes.c_uint32),
        ("port", ctypes.c_uint32),
    )


class Waited(ctypes.Structure):
    """What was done while the loop waited, and what is left to Python."""

    _fields_ = (
        ("taken", ctypes.c_uint8 * (TAKEN.size * AT_ONCE)),
        ("sent", ctypes.c_uint8 * (SENT.size * AT_ONCE)),
        ("ready", ctypes.c_int32 * AT_ONCE),
        ("taken_count", ctypes.c_size_t),
        ("sent_count", ctypes.c_size_t),
        ("ready_count", ctypes.c_size_t),
        ("left", ctypes.POINTER(Datagram)),
        ("left_count", ctypes.c_size_t),
    )


class Destination(ctypes.Structure):
    """Where the messages of a subscription go."""

    _fields_ = (
        ("host", ctypes.c_uint32),
        ("port", ctypes.c_uint16),
        ("flags", ctypes.c_uint8),
        ("sock", ctypes.c_int32),
        ("destination", ctypes.c_uint32),
        ("source", ctypes.c_uint32),
        ("longest", ctypes.c_size_t),
        ("lifetime", ctypes.c_double),
        ("heard", ctypes.c_double),
        ("numbers", ctypes.POINTER(ctypes.c_uint64)),
    )


class Subscription(ctypes.Structure):
    """A subscription, the number of the next message, and how many were lost."""

    _fields_ = (
        ("handle", ctypes.c_void_p),
        ("translation", ctypes.POINTER(Translation)),
        ("to", ctypes.POINTER(Destination)),
        ("descriptor", ctypes.c_int32),
        ("index", ctypes.c_uint32),
        ("age_limit", ctypes.c_int64),
        ("expected", ctypes.c_uint64),
        ("lost", ctypes.c_uint64),
    )


class Pending(ctypes.Structure):
    """A message of a subscription that is not usual, and how many more wait."""

    _fields_ = (
        ("data", ctypes.c_void_p),
        ("size", ctypes.c_size_t),
        ("published", ctypes.c_int64),
        ("received", ctypes.c_int64),
        ("number", ctypes.c_uint64),
        ("left", ctypes.c_uint64),
    )


NONE, SEVERAL = -1, -2  # what a wait returns in the place of the only descriptor that is ready

_POINTER, _SIZE = ctypes.c_void_p, ctypes.c_size_t
# Types are stated, as ctypes takes what it is not told of for a C int and cuts addresses.
_FUNCTIONS: dict[str, tuple[Any, tuple[Any, ...]]] = {
    "core": (_POINTER, (_POINTER, ctypes.c_int)),
    "core_end": (None, (_POINTER,)),
    "core_stop": (None, (_POINTER,)),
    "core_start": (None, (_POINTER,)),
    "core_forget": (None, (_POINTER,)),
    "core_listen": (None, (_POINTER, ctypes.c_int, _SIZE)),
    "core_add": (ctypes.POINTER(Order), (_POINTER, _POINTER, _POINTER, _SIZE)),
    "core_subscribe": (ctypes.POINTER(Pending), (_POINTER, _POINTER)),
    "next_number": (ctypes.c_uint64, (_POINTER,)),
}
_WAIT = ctypes.CFUNCTYPE(ctypes.c_int32, _POINTER, ctypes.c_double, ctypes.c_double, _POINTER)
_CLIENT_LIBRARY = {
    "publish": ("librcl.so", "rcl_publish_serialized_message"),
    "take": ("librcl.so", "rcl_take_serialized_message"),
    "forget_error": ("librcutils.so", "rcutils_reset_error"),
    "allocator": ("librcutils.so", "rcutils_get_default_allocator"),
}


class Library:
    """The functions of a core, and those of ROS that they call."""

    def __init__(self, core: ctypes.CDLL) -> None:
        if sys.platform != "linux":
            raise NoFastPathError(f"not tried on {sys.platform}")
        try:
            for name, (result, arguments) in _FUNCTIONS.items():
                function = getattr(core, f"jausml_{name}")
                function.restype, function.argtypes = result, arguments
            # The loop waits without the lock of the interpreter; all else takes microseconds.
            self.core_wait = _WAIT(_address_of(core.jausml_core_wait))
            # rclpy has loaded them; other copies would know nothing.
            entry_points = {
                name: getattr(ctypes.CDLL(file, mode=os.RTLD_NOLOAD | os.RTLD_LAZY), symbol)
                for name, (file, symbol) in _CLIENT_LIBRARY.items()
            }
        except (OSError, AttributeError) as error:
            raise NoFastPathError(str(error)) from error
        addresses = {name: _address_of(entry_point) for name, entry_point in entry_points.items()}
        # Kept here, as the core has no more than the address.
        self._core, self._ros = core, Ros(**addresses)
        self.ros = ctypes.addressof(self._ros)

    def __getattr__(self, name: str) -> Any:
        """Returns a function of the core."""
        return getattr(self._core, f"jausml_{name}")


def _address_of(function: Any) -> int:
    return ctypes.cast(function, _POINTER).value or 0


def packed_host(host: str) -> int:
    """Returns an address of IPv4 as a number."""
    # In the order of the host, as the core compares what ntohl gives.
    return int.from_bytes(socket.inet_aton(host), "big")


def host_of(packed: int) -> str:
    """Returns an address of IPv4 as text."""
    return socket.inet_ntoa(packed.to_bytes(4, "big"))
