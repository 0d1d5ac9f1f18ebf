"""Waypoint driver of a bridge: has the waypoints of its controller executed by a connection.

AS6009, Global and Local Waypoint Driver: each waypoint replaces the one before. It is executed like
a list of one element.
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

    `execute` sets the waypoint and starts to go there. The report has the fields of that message.
    """

    def driver(self, component: Host) -> WaypointDriver:
        """Returns a new driver for the waypoints of a component."""
        return WaypointDriver(component, self)


class WaypointDriver(ListDriver):
    """Goes to the waypoint that the controller has set."""

    def __init__(self, component: Host, messages: WaypointMessages) -> None:
        """Takes waypoints, and answers queries for the last one."""
        super().__init__(component, messages)
        self._waypoint: ListElement | None = None

    def supports(self, element: ListElement) -> bool:  # noqa: ARG002
        """Returns False: no element of a list of ListManager is a waypoint."""
        return False

    def list_changed(self) -> None:
        """Does nothing: the waypoint is in no list of ListManager."""

    def elements_from(self, uid: int) -> list[ListElement]:
        """Returns the waypoint for its UID; none for another UID."""
        return [self._waypoint] if uid == _WAYPOINT_UID and self._waypoint is not None else []

    @property
    def restart_uid(self) -> int:
        """0, as no element follows the waypoint."""
        return NO_UID

    def _execute(self, message: Any, sender: JausAddress) -> Completion:
        """Goes to a waypoint instead of the one before; goes on if both are equal.

        A waypoint that cannot be translated is dropped in favour of the one before.
        """
        completion = Completion()
        waypoint = ListElement(_WAYPOINT_UID, data=message.encode())
        executor = self._executor_of([waypoint], _WAYPOINT_UID, sender)
        if executor is None or not executor.can_carry(waypoint):
            completion.fail()
            return completion
        is_under_way = self._running is executor and waypoint == self._waypoint
        self._waypoint = waypoint
        self._take_over(executor, completion)
        if not is_under_way:
            executor.begin(_WAYPOINT_UID, None)
            self._component.report_changed(self._messages.report)
        return completion

    def _report(self, _query: Message, _sender: JausAddress) -> bytes | None:
        """Returns the report of the waypoint; None before the first."""
        waypoint = self._waypoint
        return None if waypoint is None else self._report_of(self._messages.report.CODE, waypoint)

    def _element(self, uid: int) -> ListElement | None:
        return self._waypoint if uid == _WAYPOINT_UID else None
