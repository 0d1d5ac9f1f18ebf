"""Service introspection: publishes the calls of a node, to be recorded or watched.

A client or server of ROS publishes its requests and responses only if it is configured to; the
topic is `<service>/_service_event`.
"""

# rclpy has few types, and type checks of generated code include this module.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call"

from __future__ import annotations

from typing import Any

from rclpy.qos import QoSProfile
from rclpy.service_introspection import ServiceIntrospectionState

from ..ends.topics import Parameter
from .node import NodePart, RosNode

_STATES = {
    "disabled": ServiceIntrospectionState.OFF,
    "metadata": ServiceIntrospectionState.METADATA,
    "contents": ServiceIntrospectionState.CONTENTS,
}

_WORDS = ", ".join(_STATES)

_PROFILE = QoSProfile(depth=256)  # reliable, for both events of all calls under way


class CallIntrospection(NodePart):
    """Configures clients and servers by the parameter `service_introspection` of their node."""

    def __init__(self, ros: RosNode) -> None:
        self._ros = ros
        self._ends: list[Any] = []
        self._state = ServiceIntrospectionState.OFF

    def add(self, end: Any) -> None:
        """Adds a client or server of a service or, where rclpy supports that, of an action."""
        if not hasattr(end, "configure_introspection"):
            return  # actions before Kilted
        if not self._ends:
            text = f"What is published of calls on <service>/_service_event: {_WORDS}."
            parameter = Parameter("service_introspection", "disabled", text, check=_check)
            self._state = _STATES[self._ros.parameter(parameter, self._change)]
        self._ends.append(end)
        if self._state != ServiceIntrospectionState.OFF:
            self._configure(end)

    def _change(self, word: str) -> None:
        with self._ros.loop.lock:
            self._state = _STATES[word]
            for end in self._ends:
                self._configure(end)

    def _configure(self, end: Any) -> None:
        end.configure_introspection(self._ros.node.get_clock(), _PROFILE, self._state)


def introspection() -> type[CallIntrospection]:
    """Returns the class, for `RosSide.part`."""
    return CallIntrospection


def _check(state: str) -> None:
    if state not in _STATES:
        raise ValueError(f"{state} is none of {_WORDS}")
