"""A connection of lists, in whichever direction they go."""

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
    """A connection whose messages are elements of lists, which pass together or not at all."""

    def __init__(
        self, name: str, translate: Callable[[SourceT], TargetT | None], *, action: ListAction
    ) -> None:
        super().__init__(name, translate, is_command=True)
        self._action = action
        self._type = action.element

    def declare(self, ends: Ends) -> None:
        """Declares the name of the action: lists have no silence, their latency is not measured."""
        parameter = Parameter(f"{self.name}.action", self._action.name, f"Action of {self.name}.")
        self._action = replace(self._action, name=ends.ros.parameter(parameter))

    def measure_latency(self, wanted: bool) -> None:  # noqa: FBT001
        """Measures nothing: lists are rare."""

    def watch(self) -> None:
        """Nothing is to be stopped before there is a list."""

    def deliver(self, payload: bytes) -> bool:  # noqa: ARG002
        """Elements alone go nowhere."""
        return False

    def note_stop(self, reason: StopReason) -> None:
        """Counts that a list was stopped."""
        self.stopped = reason
        self.statistics.stops[reason] += 1

    def all_transcoded(self, elements: Iterable[bytes]) -> list[bytes] | None:
        """Returns the elements of a list, translated; None, counted, when one cannot be."""
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
    """Returns what has the actions of a node of rclpy, which need not be installed before."""
    from ..ros.actions import NodeActions  # noqa: PLC0415

    return NodeActions
