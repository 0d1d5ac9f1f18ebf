"""ROS by its client library in C (rcl): publishes serialized messages, cancels goals.

rclpy would take three times the memory. The library fills its structures of options in buffers that
are larger than these. Only the quality of service, which is public and stable within a
distribution, is written here, and `Rcl.check` proves its layout. Each error of the library raises
RclError.
"""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any, NamedTuple

# Numbers of rmw/types.h.
_RELIABILITY = {"reliable": 1, "best_effort": 2}
_DURABILITY = {"transient_local": 1, "volatile": 2}
_HISTORY = {"keep_last": 1, "keep_all": 2}
_LIVELINESS = {"automatic": 1, "manual_by_topic": 3}
_ROSOUT = 40 + 8 + 8  # offset of enable_rosout in node options: after allocator, bool and arguments
_CHECK_TOPIC = "_guardian/check"


def _words(count: int) -> Any:
    """Returns a type for opaque structures of `count` machine words."""
    return type("Words", (ctypes.Structure,), {"_fields_": [("words", ctypes.c_uint64 * count)]})


class _Duration(ctypes.Structure):
    _fields_ = (("seconds", ctypes.c_uint64), ("nanoseconds", ctypes.c_uint64))


class _Quality(ctypes.Structure):
    """The profile of quality of service (rmw_qos_profile_t), the first field of options."""

    _fields_ = (
        ("history", ctypes.c_uint32),
        ("depth", ctypes.c_size_t),
        ("reliability", ctypes.c_uint32),
        ("durability", ctypes.c_uint32),
        ("deadline", _Duration),
        ("lifespan", _Duration),
        ("liveliness", ctypes.c_uint32),
        ("lease", _Duration),
    )


# An allocator is returned by value, and has exactly five words; the others are larger than needed.
_ALLOCATOR, _OPAQUE, _HANDLE = _words(5), _words(256), _words(8)


class RclError(Exception):
    """The library reports an error, or differs from what this module expects."""


class Publisher(NamedTuple):
    """A publisher of the library, and its topic."""

    handle: Any
    topic: str


class Rcl:
    """One node, made at the start, as it takes a second until others have found it."""

    def __init__(self, rcl: str, utilities: str, name: str, arguments: list[str]) -> None:
        """Joins ROS with arguments of security; a `name` that begins with `_` is hidden."""
        try:
            self._rcl = ctypes.CDLL(rcl, ctypes.RTLD_GLOBAL)
            default = ctypes.CDLL(utilities, ctypes.RTLD_GLOBAL).rcutils_get_default_allocator
        except (OSError, AttributeError) as error:
            raise RclError(str(error)) from error
        default.restype = _ALLOCATOR
        options, self._context, self._node = _HANDLE(), _HANDLE(), _HANDLE()
        self._call("rcl_init_options_init", ctypes.byref(options), default())
        encoded = [argument.encode() for argument in arguments]
        words = (ctypes.c_char_p * len(arguments))(*encoded) if encoded else None
        self._call(
            "rcl_init", len(arguments), words, ctypes.byref(options), ctypes.byref(self._context)
        )
        node_options = self._default("rcl_node_get_default_options")
        # No /rosout, since it logs to the stderr of its bridge.
        ctypes.c_bool.from_address(ctypes.addressof(node_options) + _ROSOUT).value = False
        self._call(
            "rcl_node_init",
            ctypes.byref(self._node),
            name.encode(),
            b"",
            ctypes.byref(self._context),
            ctypes.byref(node_options),
        )

    def close(self) -> None:
        """Leaves ROS."""
        self._call("rcl_node_fini", ctypes.byref(self._node))
        self._call("rcl_shutdown", ctypes.byref(self._context))
        self._call("rcl_context_fini", ctypes.byref(self._context))

    def type(self, library: str, package: str, kind: str, name: str) -> Any:
        """Returns the type support of a message or service from its library."""
        word = "service" if kind == "srv" else "message"
        symbol = f"rosidl_typesupport_c__get_{word}_type_support_handle__{package}__{kind}__{name}"
        try:
            function = getattr(ctypes.CDLL(library, ctypes.RTLD_GLOBAL), symbol)
        except (OSError, AttributeError) as error:
            raise RclError(str(error)) from error
        # ctypes would take the address for a C int and cut it.
        function.restype = ctypes.c_void_p
        return ctypes.c_void_p(function())

    def publisher(self, topic: str, support: Any, qos: dict[str, Any]) -> Publisher:
        """Makes a publisher; `qos` has the fields of `Qos`, in which 0 seconds is no limit."""
        options = self._default("rcl_publisher_get_default_options")
        quality = _Quality.from_address(ctypes.addressof(options))
        quality.history = _HISTORY.get(qos["history"], 1)
        quality.depth = qos["depth"]
        quality.reliability = _RELIABILITY.get(qos["reliability"], 0)
        quality.durability = _DURABILITY.get(qos["durability"], 0)
        quality.liveliness = _LIVELINESS.get(qos["liveliness"], 0)
        quality.deadline = _duration(qos["deadline"])
        quality.lease = _duration(qos["lease_duration"])
        handle = _HANDLE()
        self._call(
            "rcl_publisher_init",
            ctypes.byref(handle),
            ctypes.byref(self._node),
            support,
            topic.encode(),
            ctypes.byref(options),
        )
        return Publisher(handle, topic)

    def check(self, support: Any) -> None:
        """Raises RclError unless a publisher has the QoS that it was made with."""
        # Depth, reliability and durability are no defaults, so that they prove the layout.
        qos = {
            "history": "keep_last",
            "depth": 7,
            "reliability": "best_effort",
            "durability": "transient_local",
            "liveliness": "automatic",
            "deadline": 0.0,
            "lease_duration": 0.0,
        }
        publisher = self.publisher(_CHECK_TOPIC, support, qos)
        actual = self._rcl.rcl_publisher_get_actual_qos
        actual.restype = ctypes.POINTER(_Quality)
        quality = actual(ctypes.byref(publisher.handle)).contents
        values = (quality.depth, quality.reliability, quality.durability)
        self.destroy(publisher)
        if values != (7, _RELIABILITY["best_effort"], _DURABILITY["transient_local"]):
            raise RclError(f"a publisher has another quality of service than asked for: {values}")

    def subscribers(self, publisher: Publisher) -> int:
        """Returns the number of subscribers that a publisher has found."""
        count = ctypes.c_size_t()
        self._call(
            "rcl_publisher_get_subscription_count",
            ctypes.byref(publisher.handle),
            ctypes.byref(count),
        )
        return count.value

    def publishers(self, topic: str) -> int:
        """Returns the number of known publishers of a topic, including those of dead processes."""
        count = ctypes.c_size_t()
        self._call(
            "rcl_count_publishers", ctypes.byref(self._node), topic.encode(), ctypes.byref(count)
        )
        return count.value

    def publish(self, publisher: Publisher, data: bytes) -> None:
        """Publishes a serialized message."""
        buffer = ctypes.create_string_buffer(data, len(data))
        # rcutils_uint8_array_t: address, length and capacity; no allocator.
        array = (ctypes.c_uint64 * 8)(ctypes.addressof(buffer), len(data), len(data))
        self._call("rcl_publish_serialized_message", ctypes.byref(publisher.handle), array, None)

    def destroy(self, publisher: Publisher) -> None:
        """Destroys a publisher."""
        self._call("rcl_publisher_fini", ctypes.byref(publisher.handle), ctypes.byref(self._node))

    def canceller(self, service: str, support: Any) -> Any:
        """Returns a client of the service that cancels goals of an action."""
        options = self._default("rcl_client_get_default_options")
        handle = _HANDLE()
        self._call(
            "rcl_client_init",
            ctypes.byref(handle),
            ctypes.byref(self._node),
            support,
            service.encode(),
            ctypes.byref(options),
        )
        return handle

    def cancel(self, canceller: Any, goal: bytes) -> bool:
        """Requests the cancellation of a goal by its id; returns False without a server."""
        ready = ctypes.c_bool()
        self._call(
            "rcl_service_server_is_available",
            ctypes.byref(self._node),
            ctypes.byref(canceller),
            ctypes.byref(ready),
        )
        if not ready.value:
            return False
        # GoalInfo: the id, and a stamp of zero, which selects only this goal.
        request = ctypes.create_string_buffer(goal + bytes(8), len(goal) + 8)
        number = ctypes.c_int64()
        self._call("rcl_send_request", ctypes.byref(canceller), request, ctypes.byref(number))
        return True

    def _default(self, name: str) -> Any:
        function = getattr(self._rcl, name)
        # Returned by a hidden pointer, so that a larger structure does no harm.
        function.restype = _OPAQUE
        return function()

    def _call(self, name: str, *arguments: Any) -> None:
        result = getattr(self._rcl, name)(*arguments)
        if result:
            # Otherwise the library complains that the next error overwrites this one.
            self._rcl.rcutils_reset_error()
            raise RclError(f"{name} returned {result}")


def _duration(seconds: float) -> _Duration:
    return _Duration(int(seconds), round(seconds % 1 * 1e9))


def loaded_libraries() -> dict[str, str]:
    """Returns the paths of the shared libraries that this process has loaded, by file name."""
    paths_by_name: dict[str, str] = {}
    for line in Path("/proc/self/maps").read_text(encoding="utf-8").splitlines():
        path = line.partition("/")[2]
        if ".so" in path:
            paths_by_name.setdefault(path.rpartition("/")[2], f"/{path}")
    return paths_by_name
