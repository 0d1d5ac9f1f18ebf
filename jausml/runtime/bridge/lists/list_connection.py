"""Base class of the connections between ROS actions and JAUS lists, in both directions."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

from ..connections.connection import Connection
from ..ends.actions import ListAction
from ..ends.ends import Ends
from ..ends.topics import Parameter
from ..reports.diagnostics import FILTERED
from ..reports.states import StopReason

if TYPE_CHECKING:
    from ..ros.actions import NodeActions

SourceT = TypeVar("SourceT")
TargetT = TypeVar("TargetT")


class ListConnection(Connection[SourceT, TargetT]):
    """A connection of lists, whose elements pass together or not at all."""

    def __init__(
        self, name: str, translate: Callable[[SourceT], TargetT | None], *, action: ListAction
    ) -> None:
        super().__init__(name, translate, is_command=True)
        self._action = action
        self._type = action.element

    def declare(self, ends: Ends) -> None:
        """Declares the name of the action; lists have no silence, and no latency is measured."""
        parameter = Parameter(f"{self.name}.action", self._action.name, f"Action of {self.name}.")
        self._action = replace(self._action, name=ends.ros.parameter(parameter))

    def measure_latency(self, wanted: bool) -> None:  # noqa: FBT001
        """Does nothing: lists are rare, and their latency is not measured."""

    def watch(self) -> None:
        """Does nothing: there is no list to stop yet."""

    def deliver(self, payload: bytes) -> bool:  # noqa: ARG002
        """Returns False: a single element is never delivered."""
        return False

    def note_stop(self, reason: StopReason) -> None:
        """Counts that a list was stopped."""
        self.stopped = reason
        self.statistics.stops[reason] += 1

    def all_transcoded(self, elements: Iterable[bytes]) -> list[bytes] | None:
        """Returns the translated elements of a list; None, counted, if a translation fails."""
        payloads: list[bytes] = []
        try:
            for element in elements:
                payload = self._transcode(element)
                if payload is None:
                    self.drop(FILTERED)
                    return None
                payloads.append(payload)
        except Exception as error:
            self.fail(error)
            return None
        return payloads


def node_actions() -> type[NodeActions]:
    """Returns the class with the actions of a node; imported late, as it needs rclpy."""
    from ..ros.actions import NodeActions  # noqa: PLC0415

    return NodeActions
