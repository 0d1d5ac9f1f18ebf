"""A connection of lists, in whichever direction they go."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from ..connections.connection import Connection
from ..connections.translations import Form, uses_ros_classes
from ..light_message import is_light
from ..reports.diagnostics import FILTERED

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from ..ends.ends import Ends
    from ..ends.ros_side import ListAction
    from ..reports.states import StopReason

SourceT = TypeVar("SourceT")
TargetT = TypeVar("TargetT")


class ListConnection(Connection[SourceT, TargetT]):
    """A connection whose messages are elements of lists, which pass together or not at all."""

    def __init__(
        self,
        name: str,
        translate: Callable[[SourceT], TargetT | None],
        *,
        action: ListAction,
    ) -> None:
        super().__init__(name, translate, is_command=True)
        self._action = action

    def declare(self, ends: Ends) -> None:
        """Declares nothing: lists have no silence, and their latency is not measured."""

    def measure_latency(self, wanted: bool) -> None:  # noqa: FBT001
        """Measures nothing: lists are rare."""

    def watch(self) -> None:
        """Nothing is to be stopped before there is a list."""

    def deliver(self, payload: bytes) -> bool:  # noqa: ARG002
        """Elements alone go nowhere."""
        return False

    def classes(self) -> Form:
        """Returns which classes of ROS the translation has to do with."""
        is_real = uses_ros_classes(self._translate) or not is_light(self._action.element)
        return Form.ROS_CLASSES if is_real else Form.LIGHT

    def note_stop(self, reason: StopReason) -> None:
        """Counts that a list was stopped."""
        self.stopped = reason
        counts = self.statistics.stops
        counts[reason] = counts.get(reason, 0) + 1

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
