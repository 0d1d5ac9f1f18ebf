"""The ListManager service: a list of elements that the controller edits (AS5710)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..messages import (
    ConfirmElementRequest,
    DeleteElement,
    QueryElement,
    QueryElementCount,
    QueryElementList,
    RejectElementRequest,
    ReportElement,
    ReportElementCount,
    ReportElementList,
    SetElement,
)
from .definitions import Guard
from .element_list import ElementList, ListElement, ListError, Reason

if TYPE_CHECKING:
    from ..base.address import JausAddress
    from ..wire.message import Message
    from .host import Host

DATA_FORMATS = (0, 1)
"""Formats of ElementData: a JAUS message, or one of the user; a report can hold no other."""

ELEMENTS_OF_DRIVERS = {
    "urn:jaus:jss:mobility:GlobalWaypointListDriver": 0x040C,
    "urn:jaus:jss:mobility:LocalWaypointListDriver": 0x040D,
    "urn:jaus:jss:mobility:GlobalPathSegmentDriver": 0x040F,
    "urn:jaus:jss:mobility:LocalPathSegmentDriver": 0x0410,
    "urn:jaus:jss:manipulator:ManipulatorJointPositionsListDriver": 0x0602,
    "urn:jaus:jss:manipulator:ManipulatorEndEffectorPoseListDriver": 0x0610,
}
"""Message code of the elements that each list driver takes (AS6009, manipulator set)."""


class ListManagerService:
    """Edits and reports the list (AS5710 v1.1, ListManager, protocol behaviour)."""

    # The service was part of the other sets before core v1.1 took it over.
    urns = frozenset(
        f"urn:jaus:jss:{owner}:ListManager" for owner in ("core", "mobility", "manipulator")
    )

    def __init__(self, component: Host) -> None:
        self._component = component
        self.elements = ElementList(component.settings.max_list_elements)
        self._codes = {
            ELEMENTS_OF_DRIVERS[service.urn]
            for service in component.services
            if service.urn in ELEMENTS_OF_DRIVERS
        }

    def attach(self) -> None:
        """Take the messages of ListManager."""
        component = self._component
        component.handle(SetElement, self._set, when=Guard.CONTROLLED, counts_each=True)
        component.handle(DeleteElement, self._delete, when=Guard.CONTROLLED, counts_each=True)
        component.provide(QueryElement, ReportElement, self._report_element)
        component.provide(QueryElementList, ReportElementList, self._report_list)
        component.provide(QueryElementCount, ReportElementCount, self._report_count)

    def is_of_driver(self, element: ListElement) -> bool:
        """Whether an element is what the component's list drivers execute."""
        return element.message_code in self._codes

    def _set(self, message: SetElement, sender: JausAddress) -> None:
        requested = [
            ListElement(
                each.element_uid,
                each.previous_uid,
                each.next_uid,
                bytes(each.element_data.data),
                each.element_data.format_index,
            )
            for each in message.element_list
        ]
        request_id = message.request_id_rec.request_id
        try:
            self._check(requested)
            self.elements.set(requested)
        except ListError as error:
            self._reject(sender, request_id, error)
        else:
            self._confirm(sender, request_id)

    def _check(self, requested: list[ListElement]) -> None:
        if not requested:
            raise ListError(Reason.UNSPECIFIED_ERROR, "the request holds no element")
        for element in requested:
            is_known = element.data_format in DATA_FORMATS
            if not (is_known and self._component.call(self._component.supports_element, element)):
                raise ListError(
                    Reason.UNSUPPORTED_ELEMENT_TYPE, f"element {element.uid} is not supported"
                )

    def _delete(self, message: DeleteElement, sender: JausAddress) -> None:
        request_id = message.request_id_rec.request_id
        uids = [each.element_uid for each in message.delete_element_list]
        try:
            if not uids:
                raise ListError(Reason.UNSPECIFIED_ERROR, "the request names no element")
            self.elements.delete(uids)
        except ListError as error:
            self._reject(sender, request_id, error)
        else:
            self._confirm(sender, request_id)

    def _confirm(self, client: JausAddress, request_id: int) -> None:
        self._component.send(ConfirmElementRequest(request_id=request_id), client)
        self._component.call(self._component.on_list_changed)
        for report in (ReportElement, ReportElementList, ReportElementCount):
            self._component.report_changed(report)

    def _reject(self, client: JausAddress, request_id: int, error: ListError) -> None:
        self._component.counters.count("list_manager.rejected", f"request of {client}: {error}")
        message = RejectElementRequest(request_id=request_id, response_code=error.reason)
        self._component.send(message, client)

    def _report_element(self, query: QueryElement, _sender: JausAddress) -> ReportElement | None:
        element = self.elements.get(query.element_uid)
        if element is None:
            return None
        return ReportElement(
            element_uid=element.uid,
            previous_uid=element.previous_uid,
            next_uid=element.next_uid,
            element_data=ReportElement.ElementData(element.data_format, element.data),
        )

    def _report_list(self, _query: Message, _sender: JausAddress) -> ReportElementList:
        return ReportElementList(
            element_list=[
                ReportElementList.ElementListRec(element_uid=each.uid) for each in self.elements
            ]
        )

    def _report_count(self, _query: Message, _sender: JausAddress) -> ReportElementCount:
        return ReportElementCount(element_count=len(self.elements))
