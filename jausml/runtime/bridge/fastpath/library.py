"""The compiled core for Python: its functions, and the structures that both share.

They are defined in fastpath.hpp, a template of the generators that becomes part of each core.
"""

from __future__ import annotations

import ctypes
import os
import socket
import struct
import sys
from typing import Any

from ..messages.compiled import Translation

AT_ONCE = 32  # most messages that the core passes on in one wait, before Python accounts for them

# Laid out as the structs of fastpath.hpp: "@" aligns as the compiler does, padding included.
# A message from JAUS: time, bits of omitted fields, address and size of the payload, address of the
# sizes of its packets and their number, index of the route, number of the last packet, and whether
# it was acknowledged.
TAKEN = struct.Struct("@dQPNPNIHB1x")
# A message to JAUS: time of arrival, time of publication, bits of omitted fields, index of the
# subscription, number of datagrams sent, and the error of the one that failed.
SENT = struct.Struct("@dqQIIi4x")


class NoFastPathError(Exception):
    """The core cannot pass messages on without Python here; the text says why."""


# Structures repeat those of fastpath.hpp field by field: core and Python share the memory.
class Ros(ctypes.Structure):
    """Functions of rcl."""

    _fields_ = tuple(
        (name, ctypes.c_void_p) for name in ("publish", "take", "forget_error", "allocator")
    )


class Order(ctypes.Structure):
    """Latest and expected numbers of the messages of one code from one component."""

    _fields_ = (
        ("latest_at", ctypes.c_double),
        ("latest", ctypes.c_uint16),
        ("has_latest", ctypes.c_uint8),
        ("expected", ctypes.c_uint8),
    )


class Route(ctypes.Structure):
    """Which datagrams the core takes without Python, and where it publishes their messages."""

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
    """Result of a wait: messages passed on, ready descriptors, datagrams left to Python."""

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
    """A subscription that the core takes, the expected number, and how many messages were lost."""

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
    """A message of a subscription that is left to Python, and how many more wait."""

    _fields_ = (
        ("data", ctypes.c_void_p),
        ("size", ctypes.c_size_t),
        ("published", ctypes.c_int64),
        ("received", ctypes.c_int64),
        ("number", ctypes.c_uint64),
        ("left", ctypes.c_uint64),
    )


NONE, SEVERAL = -1, -2  # results of a wait, instead of a single ready descriptor

_POINTER, _SIZE = ctypes.c_void_p, ctypes.c_size_t
# All types are stated, since ctypes takes others for a C int and cuts addresses.
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
    """The functions of a core, and those of ROS that they call; raises NoFastPathError."""

    def __init__(self, core: ctypes.CDLL) -> None:
        if sys.platform != "linux":
            raise NoFastPathError(f"not tried on {sys.platform}")
        try:
            for name, (result, arguments) in _FUNCTIONS.items():
                function = getattr(core, f"jausml_{name}")
                function.restype, function.argtypes = result, arguments
            # Called without the lock of the interpreter; all others take microseconds.
            self.core_wait = _WAIT(_address_of(core.jausml_core_wait))
            # Only the copies that rclpy has loaded have its state.
            entry_points = {
                name: getattr(ctypes.CDLL(file, mode=os.RTLD_NOLOAD | os.RTLD_LAZY), symbol)
                for name, (file, symbol) in _CLIENT_LIBRARY.items()
            }
        except (OSError, AttributeError) as error:
            raise NoFastPathError(str(error)) from error
        addresses = {name: _address_of(entry_point) for name, entry_point in entry_points.items()}
        # Kept here, as the core only holds the address.
        self._core, self._ros = core, Ros(**addresses)
        self.ros = ctypes.addressof(self._ros)

    def __getattr__(self, name: str) -> Any:
        """Returns a function of the core."""
        return getattr(self._core, f"jausml_{name}")


def _address_of(function: Any) -> int:
    return ctypes.cast(function, _POINTER).value or 0


def packed_host(host: str) -> int:
    """Returns an IPv4 address as a number in the byte order of the host, as the core has it."""
    return int.from_bytes(socket.inet_aton(host), "big")


def host_of(packed: int) -> str:
    """Returns the IPv4 address of a number as text."""
    return socket.inet_ntoa(packed.to_bytes(4, "big"))
