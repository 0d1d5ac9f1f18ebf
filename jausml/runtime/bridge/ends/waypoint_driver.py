"""Waypoint driver of a bridge: takes waypoints of its controller, and has an executor go there.

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

_WAYPOINT_UID = 1  # UID of the waypoint as the only element of its list


@dataclass(frozen=True)
class WaypointMessages(ListMessages):
    """The messages of a waypoint driver.

    To set the waypoint (`execute`) is to go there. The report has the layout of that message.
    """

    def driver(self, component: Host) -> WaypointDriver:
        """Returns the driver of a component that goes to its waypoints."""
        return WaypointDriver(component, self)


class WaypointDriver(ListDriver):
    """Goes to the waypoint that the controller has set."""

    def __init__(self, component: Host, messages: WaypointMessages) -> None:
        """Takes the waypoint, and tells the last one to whoever asks."""
        super().__init__(component, messages)
        self._waypoint: ListElement | None = None

    def supports(self, element: ListElement) -> bool:  # noqa: ARG002
        """Returns False: no element of a list of ListManager is a waypoint."""
        return False

    def list_changed(self) -> None:
        """Does nothing: the waypoint is in no list of ListManager."""

    def elements_from(self, uid: int) -> list[ListElement]:
        """Returns the waypoint, if it is the one that is meant."""
        return [self._waypoint] if uid == _WAYPOINT_UID and self._waypoint is not None else []

    @property
    def first_again(self) -> int:
        """Returns that no element follows the waypoint."""
        return NO_UID

    def _execute(self, message: Any, sender: JausAddress) -> Completion:
        """Goes to a waypoint instead of the one before; if it is the same, nothing begins anew.

        A waypoint that cannot be translated is dropped, and the one before stands.
        """
        begun = Completion()
        waypoint = ListElement(_WAYPOINT_UID, data=message.encode())
        executor = self._executor_of([waypoint], _WAYPOINT_UID, sender)
        if executor is None or not executor.can_carry(waypoint):
            begun.fail()
            return begun
        is_under_way = self._running is executor and waypoint == self._waypoint
        self._waypoint = waypoint
        self._take_over(executor, begun)
        if not is_under_way:
            executor.begin(_WAYPOINT_UID, None)
            self._component.report_changed(self._messages.report)
        return begun

    def _report(self, _query: Message, _sender: JausAddress) -> bytes | None:
        """Returns the waypoint; None when there never was one."""
        waypoint = self._waypoint
        return None if waypoint is None else self._told_as(self._messages.report.CODE, waypoint)

    def _element(self, uid: int) -> ListElement | None:
        return self._waypoint if uid == _WAYPOINT_UID else None
