"""The waypoint driver that a bridge provides: the waypoint of its controller, and who goes there.

AS6009, Global and Local Waypoint Driver: each waypoint takes the place of the one before. It is
executed as a list of one element.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ...base.address import JausAddress
from ...services.definitions import Completion
from ...services.host import Host
from ...services.list_elements import ListElement
from ...services.list_manager import NO_UID
from ...wire.message import Message
from .list_driver import ListDriver, ListMessages

ONLY = 1  # UID of the waypoint, while the robot goes there


@dataclass(frozen=True)
class WaypointMessages(ListMessages):
    """The messages of a waypoint driver: what sets the waypoint executes it.

    The query and the report, laid out as that is, tell the waypoint.
    """

    def driver(self, component: Host) -> WaypointDriver:
        """Returns the driver of a component that goes to its waypoints."""
        return WaypointDriver(component, self)


class WaypointDriver(ListDriver):
    """Executes the waypoint of a bridge, as its controller says."""

    def __init__(self, component: Host, messages: WaypointMessages) -> None:
        """Takes the waypoint, and tells the last one to whoever asks."""
        super().__init__(component, messages)
        self._waypoint: ListElement | None = None

    def supports(self, element: ListElement) -> bool:  # noqa: ARG002
        """A waypoint is no list of ListManager."""
        return False

    def list_changed(self) -> None:
        """The list of ListManager is none of a waypoint."""

    def elements_from(self, uid: int) -> list[ListElement]:
        """Returns the waypoint, if it is the one that is meant."""
        return [self._waypoint] if uid == ONLY and self._waypoint is not None else []

    @property
    def first_again(self) -> int:
        """A waypoint that is reached stays so."""
        return NO_UID

    def _execute(self, message: Any, sender: JausAddress) -> Completion:
        """Goes to a waypoint in the place of the one before; one that is said again is the same.

        A waypoint that cannot be translated is dropped, and the one before stands.
        """
        begun = Completion()
        waypoint = ListElement(ONLY, data=message.encode())
        executor = self._executor_of([waypoint], ONLY, sender)
        if executor is None or not executor.can_carry(waypoint):
            begun.fail()
            return begun
        goes_there = self._running is executor and waypoint == self._waypoint
        self._waypoint = waypoint
        self._take_over(executor, begun)
        if not goes_there:
            executor.begin(ONLY, None)
            self._component.report_changed(self._messages.report)
        return begun

    def _report(self, _query: Message, _sender: JausAddress) -> bytes | None:
        """Returns the waypoint; None when there never was one."""
        waypoint = self._waypoint
        return None if waypoint is None else self._told_as(self._messages.report.CODE, waypoint)

    def _element(self, uid: int) -> ListElement | None:
        return self._waypoint if uid == ONLY else None
