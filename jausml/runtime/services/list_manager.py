"""The ListManager service: a list that the controller edits by atomic requests (AS5710)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Protocol

from ..base.address import JausAddress
from ..base.api import JausError
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
from ..wire.message import Message
from .definitions import Guard
from .host import Host
from .list_elements import ELEMENTS_OF_DRIVERS, ListElement

Reason = RejectElementRequest.ResponseCode

NO_UID = 0  # previous UID of the first element, next UID of the last one
ALL_UIDS = 65535  # UID that means all elements in a DeleteElement; no element has it


class ListError(JausError):
    """A request is rejected; `reason` is the code for RejectElementRequest."""

    def __init__(self, reason: Reason, text: str) -> None:
        super().__init__(text)
        self.reason = reason


def chain(
    contents: Iterable[tuple[int, bytes, int]], *, circular: bool = False
) -> list[ListElement]:
    """Returns elements linked in their order, of UIDs, data and formats."""
    contents = list(contents)
    if not contents:
        return []
    uids = [uid for uid, _, _ in contents]
    closing = uids[0] if circular and len(uids) > 1 else NO_UID
    before, after = [NO_UID, *uids[:-1]], [*uids[1:], closing]
    return [
        ListElement(uid, previous, following, data, data_format)
        for (uid, data, data_format), previous, following in zip(
            contents, before, after, strict=True
        )
    ]


class ElementList:
    """A list of elements that is always valid (AS5710, ListManager).

    A valid list has one first element, one last element unless it is circular, and each element can
    be reached from the first one. A request that would violate this changes nothing.
    """

    def __init__(self, capacity: int) -> None:
        self._capacity = capacity
        self._elements: dict[int, ListElement] = {}

    def __len__(self) -> int:
        return len(self._elements)

    def __iter__(self) -> Iterator[ListElement]:
        return iter(tuple(self._elements.values()))

    def __contains__(self, uid: object) -> bool:
        return uid in self._elements

    def get(self, uid: int) -> ListElement | None:
        """Returns the element of a UID; None without one."""
        return self._elements.get(uid)

    @property
    def first(self) -> ListElement | None:
        """The first element; None in an empty list."""
        return next(iter(self._elements.values()), None)

    @property
    def circular(self) -> bool:
        """Whether the first element follows the last one."""
        return bool(self._elements) and next(reversed(self._elements.values())).next_uid != NO_UID

    def set(self, requested: Sequence[ListElement]) -> None:
        """Adds elements, or replaces those of the same UID; neighbours are linked to them.

        Raises:
            ListError: The list would not be valid, or is full; nothing is changed.
        """
        new = {element.uid: element for element in requested}
        self._check(requested, new)
        others = _contents(element for element in self if element.uid not in new)
        if len(others) + len(new) > self._capacity:
            raise ListError(Reason.OUT_OF_MEMORY, f"more than {self._capacity} elements")
        # Other elements are linked without the replaced ones first.
        linked = chain(others, circular=self.circular and len(others) > 1)
        self._elements = _in_order(_linked({element.uid: element for element in linked}, new))

    def delete(self, uids: Sequence[int]) -> None:
        """Deletes elements, or all; the neighbours of a deleted element become neighbours.

        Raises:
            ListError: There is no such element; nothing is changed.
        """
        if ALL_UIDS in uids:
            self._elements = {}
            return
        for uid in uids:
            if uid == NO_UID:
                raise ListError(Reason.INVALID_ELEMENT_ID, "no element has UID 0")
            if uid not in self._elements:
                raise ListError(Reason.ELEMENT_ID_NOT_FOUND, f"there is no element {uid}")
        others = _contents(element for element in self if element.uid not in uids)
        linked = chain(others, circular=self.circular)
        self._elements = {element.uid: element for element in linked}

    def _check(self, requested: Sequence[ListElement], new: dict[int, ListElement]) -> None:
        """Raises ListError for a wrong element."""
        if len(new) != len(requested):
            raise ListError(Reason.INVALID_ELEMENT_ID, "an element is given twice")
        for element in requested:
            uid = element.uid
            if uid in (NO_UID, ALL_UIDS):
                raise ListError(Reason.INVALID_ELEMENT_ID, f"{uid} is no UID of an element")
            for neighbour, reason in (
                (element.previous_uid, Reason.INVALID_PREVIOUS_ELEMENT),
                (element.next_uid, Reason.INVALID_NEXT_ELEMENT),
            ):
                known = neighbour in new or neighbour in self._elements
                if neighbour == uid or (neighbour != NO_UID and not known):
                    raise ListError(reason, f"element {uid}: {neighbour} cannot be its neighbour")


def _contents(elements: Iterable[ListElement]) -> list[tuple[int, bytes, int]]:
    return [(element.uid, element.data, element.data_format) for element in elements]


def _linked(
    others: dict[int, ListElement], new: dict[int, ListElement]
) -> dict[int, tuple[int, int, ListElement]]:
    """Returns previous and next UID of all elements, with the neighbours of new ones updated."""
    elements = {**others, **new}
    previous = {uid: element.previous_uid for uid, element in elements.items()}
    following = {uid: element.next_uid for uid, element in elements.items()}
    old_first = next(iter(others), NO_UID)
    old_last = next(reversed(others), NO_UID)
    new_first = next((uid for uid in new if previous[uid] == NO_UID), NO_UID)
    for element in new.values():
        if element.previous_uid in others:
            following[element.previous_uid] = element.uid
        # The UID of the first element as next one closes the circle, unless there is a new first.
        closes = element.next_uid == old_first and not new_first
        if element.next_uid in others and not closes:
            previous[element.next_uid] = element.uid
    if old_last and new_first and following[old_last] == old_first:
        following[old_last] = new_first
    return {uid: (previous[uid], following[uid], element) for uid, element in elements.items()}


def _in_order(links: dict[int, tuple[int, int, ListElement]]) -> dict[int, ListElement]:
    """Returns the elements in the order of their links; raises ListError for an invalid list."""
    heads = [uid for uid, (previous, _, _) in links.items() if previous == NO_UID]
    if len(heads) != 1:
        raise ListError(Reason.INVALID_PREVIOUS_ELEMENT, f"{len(heads)} elements are the first")
    ordered: dict[int, ListElement] = {}
    before, uid = NO_UID, heads[0]
    while uid != NO_UID and not (ordered and uid == heads[0]):
        previous, following, element = links[uid]
        if uid in ordered:
            raise ListError(Reason.INVALID_NEXT_ELEMENT, f"{before} leads back to {uid}")
        if previous != before:
            raise ListError(Reason.INVALID_PREVIOUS_ELEMENT, f"{before} and {uid} do not agree")
        ordered[uid] = ListElement(uid, previous, following, element.data, element.data_format)
        before, uid = uid, following
    if len(ordered) != len(links):
        raise ListError(Reason.INVALID_NEXT_ELEMENT, "elements would be cut off from the list")
    return ordered


DATA_FORMATS = (0, 1)  # of ElementData: a JAUS message, or a format of the user


class Driver(Protocol):
    """A list driver of a bridge."""

    def supports(self, element: ListElement) -> bool:
        """Returns whether the list may hold an element, as the driver can execute it."""

    def list_changed(self) -> None:
        """Takes over a change of the list."""


class ListManagerService:
    """Edits and reports the list (AS5710 v1.1, ListManager, protocol behaviour)."""

    # The service was part of the other sets before core v1.1 took it over.
    urns = frozenset(
        f"urn:jaus:jss:{owner}:ListManager" for owner in ("core", "mobility", "manipulator")
    )

    def __init__(self, component: Host) -> None:
        self._component = component
        self.elements = ElementList(component.settings.max_list_elements)
        self.drivers: list[Driver] = []  # decide on elements; without any, the component does

    def attach(self) -> None:
        """Takes the messages of ListManager."""
        component = self._component
        component.handle(SetElement, self._set, when=Guard.CONTROLLED, counts_each=True)
        component.handle(DeleteElement, self._delete, when=Guard.CONTROLLED, counts_each=True)
        component.provide(QueryElement, ReportElement, self._report_element)
        component.provide(QueryElementList, ReportElementList, self._report_list)
        component.provide(QueryElementCount, ReportElementCount, self._report_count)

    def _supports(self, element: ListElement) -> bool:
        if self.drivers:
            return any(driver.supports(element) for driver in self.drivers)
        holder = self._component
        return isinstance(holder, ListHolder) and bool(
            holder.call(holder.supports_element, element)
        )

    def _set(self, message: SetElement, sender: JausAddress) -> None:
        requested = [
            ListElement(
                element.element_uid,
                element.previous_uid,
                element.next_uid,
                bytes(element.element_data.data),
                element.element_data.format_index,
            )
            for element in message.element_list
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
            if not (is_known and self._supports(element)):
                raise ListError(
                    Reason.UNSUPPORTED_ELEMENT_TYPE, f"element {element.uid} is not supported"
                )

    def _delete(self, message: DeleteElement, sender: JausAddress) -> None:
        request_id = message.request_id_rec.request_id
        uids = [delete_element.element_uid for delete_element in message.delete_element_list]
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
        for driver in self.drivers:
            driver.list_changed()
        if isinstance(self._component, ListHolder):
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
                ReportElementList.ElementListRec(element_uid=element.uid)
                for element in self.elements
            ]
        )

    def _report_count(self, _query: Message, _sender: JausAddress) -> ReportElementCount:
        return ReportElementCount(element_count=len(self.elements))


class ListHolder(Host):
    """A component with a list that its controller edits."""

    @property
    def elements(self) -> ElementList:
        """The list that the controller edits (AS5710, ListManager); not to be changed here."""
        return self.part(ListManagerService).elements

    def on_list_changed(self) -> None:
        """The controller has changed ``elements`` (AS5710, ListManager)."""

    def supports_element(self, element: ListElement) -> bool:
        """Returns whether the component's list may hold an element (AS5710, ListManager).

        By default these are the messages that its list drivers execute, e.g. SetGlobalWaypoint for
        a GlobalWaypointListDriver; without a driver there are none.
        """
        codes = (ELEMENTS_OF_DRIVERS.get(service.urn) for service in self.services)
        return element.message_code in codes
