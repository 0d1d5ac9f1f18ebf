"""Service introspection: whether a node publishes its calls, for those who record or watch them.

ROS publishes no request and no response of a service unless its ends say so. Each end then has the
topic `<service>/_service_event`.
"""

# ROS is typed in parts; whoever checks generated code reads this module too.
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

_PROFILE = QoSProfile(depth=256)
"""Reliable, with room for both events of more calls than are under way at once."""


class CallIntrospection(NodePart):
    """Has the ends of calls publish them, as a parameter of their node says."""

    def __init__(self, ros: RosNode) -> None:
        self._ros = ros
        self._ends: list[Any] = []
        self._state = ServiceIntrospectionState.OFF

    def add(self, end: Any) -> None:
        """Takes an end that was made: of a service or, where rclpy has that, of an action."""
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
    """Returns what parts of a node that have calls share."""
    return CallIntrospection


def _check(state: str) -> None:
    if state not in _STATES:
        raise ValueError(f"{state} is none of {_WORDS}")
