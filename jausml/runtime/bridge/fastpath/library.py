"""What a compiled core has for the fast path, and what it shares with Python (fastpath.hpp)."""

from __future__ import annotations

import ctypes
import os
import struct
import sys
from typing import Any

from ..messages.compiled import Translation

AT_ONCE = 32
"""Datagrams that are received at once at most."""

NOTHING, ENOUGH, OTHER, FAILED = range(4)
"""Why no more messages were taken: none is there, enough are done, one is not usual, or the system
says no."""

TAKEN = struct.Struct("@dQPNIHB1x")
"""A message that was taken: when, what was left out, where it is, its size, the index of its route,
its number, and whether it was acknowledged."""

SENT = struct.Struct("@dqQIi")
"""A message that was sent: when it was taken, when it was published, what was left out, how many
datagrams have gone, and the error of the one that has not."""

_MOST_SENT = 16


class NoFastPathError(Exception):
    """Messages cannot pass a core alone here; the text says why."""


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


class Received(ctypes.Structure):
    """What was received, and the datagram that is not usual."""

    _fields_ = (
        ("taken", ctypes.c_uint8 * (TAKEN.size * AT_ONCE)),
        ("count", ctypes.c_size_t),
        ("data", ctypes.c_void_p),
        ("size", ctypes.c_size_t),
        ("host", ctypes.c_uint32),
        ("port", ctypes.c_uint32),
        ("error", ctypes.c_int32),
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


class Shipped(ctypes.Structure):
    """What was sent, and the message that is not usual."""

    _fields_ = (
        ("sent", ctypes.c_uint8 * (SENT.size * _MOST_SENT)),
        ("count", ctypes.c_size_t),
        ("data", ctypes.c_void_p),
        ("size", ctypes.c_size_t),
        ("published", ctypes.c_int64),
        ("received", ctypes.c_int64),
        ("number", ctypes.c_uint64),
    )


_POINTER, _SIZE = ctypes.c_void_p, ctypes.c_size_t
_FUNCTIONS: dict[str, tuple[Any, tuple[Any, ...]]] = {
    "receiver": (_POINTER, (_POINTER,)),
    "receiver_end": (None, (_POINTER,)),
    "receiver_forget": (None, (_POINTER,)),
    "receiver_add": (ctypes.POINTER(Order), (_POINTER, _POINTER, _POINTER, _SIZE)),
    "receive": (ctypes.c_int32, (_POINTER, ctypes.c_int, ctypes.c_int, _POINTER)),
    "subscriber": (_POINTER, (_POINTER, _POINTER, _POINTER, _POINTER)),
    "subscriber_end": (None, (_POINTER,)),
    "take": (ctypes.c_int32, (_POINTER, _SIZE, ctypes.c_uint64, ctypes.c_int64, _POINTER)),
    "next_number": (ctypes.c_uint64, (_POINTER,)),
}
_CLIENT_LIBRARY = {
    "publish": ("librcl.so", "rcl_publish_serialized_message"),
    "take": ("librcl.so", "rcl_take_serialized_message"),
    "forget_error": ("librcutils.so", "rcutils_reset_error"),
    "allocator": ("librcutils.so", "rcutils_get_default_allocator"),
}


class Library:
    """The functions of a core, and those of ROS that they call.

    Attributes:
        ros: Address of the functions of the client library.
    """

    def __init__(self, core: ctypes.CDLL) -> None:
        """Finds the functions.

        Raises:
            NoFastPathError: One of them is missing, or the machine is not one that was tried.
        """
        if sys.platform != "linux":
            raise NoFastPathError(f"not tried on {sys.platform}")
        try:
            for name, (result, arguments) in _FUNCTIONS.items():
                function = getattr(core, f"jausml_{name}")
                function.restype, function.argtypes = result, arguments
            # rclpy has loaded them; other copies would know nothing.
            found = {
                name: getattr(ctypes.CDLL(file, mode=os.RTLD_NOLOAD | os.RTLD_LAZY), symbol)
                for name, (file, symbol) in _CLIENT_LIBRARY.items()
            }
        except (OSError, AttributeError) as error:
            raise NoFastPathError(str(error)) from error
        addresses = {name: ctypes.cast(each, _POINTER).value for name, each in found.items()}
        self._core, self._ros = core, Ros(**addresses)
        self.ros = ctypes.addressof(self._ros)

    def __getattr__(self, name: str) -> Any:
        """Returns a function of the core."""
        return getattr(self._core, f"jausml_{name}")


def packed_host(host: str) -> int:
    """Returns an address of IPv4 as a number."""
    first, second, third, fourth = map(int, host.split("."))
    return first << 24 | second << 16 | third << 8 | fourth


def host_of(packed: int) -> str:
    """Returns an address of IPv4 as text."""
    return ".".join(str(packed >> shift & 0xFF) for shift in (24, 16, 8, 0))
