"""Client of the service ListManager: edits and reads the lists of other components (AS5710)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from ..base.address import JausAddress
from ..base.clocks import Alarm
from ..messages import (
    ConfirmElementRequest,
    DeleteElement,
    QueryElement,
    QueryElementList,
    RejectElementRequest,
    ReportElement,
    ReportElementList,
    SetElement,
)
from ..services.host import Host
from ..services.list_elements import ListElement
from ..services.list_manager import ALL_UIDS, NO_UID
from ..wire.message import Message
from .query import QueryClient

MAX_ELEMENTS = 255  # elements that one request holds (AS5710, SetElement)
# Bytes of elements in one request, to fit an Ethernet frame; a single element may have more.
MAX_BYTES = 1400
ELEMENT_HEADER = 9  # bytes of an element next to its data: three UIDs, format and count


class ListRequest:
    """A change of another component's list, made by ``set_list`` or ``delete_elements``.

    Its requests are sent one after the other; each is repeated until it is answered.
    """

    def __init__(
        self,
        client: ListClient,
        target: JausAddress,
        requests: Sequence[SetElement | DeleteElement],
        on_done: Callable[[], None] | None,
        on_refused: Callable[[int | None], None] | None,
        timeout: float,
        retries: int,
    ) -> None:
        self.target = target
        self._client = client
        self._requests = list(requests)
        self._on_done = on_done
        self._on_refused = on_refused
        self._timeout = timeout
        self._retries = retries
        self._attempts = 0
        self._request_id = -1  # none
        self._timer = Alarm(client.component.loop)

    @property
    def under_way(self) -> bool:
        """Whether a request waits for its answer."""
        return self._request_id >= 0

    def cancel(self) -> None:
        """Sends no further request; neither callback is called."""
        with self._client.component.loop.lock:
            self._client.forget(self)

    def send_next(self) -> None:
        """Sends the next request; calls `on_done` if all are confirmed."""
        if not self._requests:
            self._client.forget(self)
            if self._on_done is not None:
                self._client.component.call(self._on_done)
            return
        self._request_id = self._client.next_request_id()
        self._requests[0].request_id_rec.request_id = self._request_id
        self._attempts = self._retries + 1
        self._send()

    def confirmed(self, request_id: int) -> None:
        """Takes a confirmation; that of the request under way begins the next request."""
        if request_id == self._request_id:
            self.stop_waiting()
            del self._requests[0]
            self.send_next()

    def rejected(self, request_id: int, code: int) -> None:
        """Takes a rejection; that of the request under way ends the change."""
        if request_id == self._request_id:
            self._refuse(code)

    def stop_waiting(self) -> None:
        """Stops waiting for an answer."""
        self._request_id = -1
        self._timer.cancel()

    def _send(self) -> None:
        if self._attempts <= 0:
            self._client.component.counters.add("list_client.unanswered")
            self._refuse(None)
            return
        self._attempts -= 1
        self._timer.set(self._timeout, self._send)
        self._client.component.send(self._requests[0], self.target)

    def _refuse(self, code: int | None) -> None:
        self._client.forget(self)
        if self._on_refused is not None:
            self._client.component.call(self._on_refused, code)


class ListClient:
    """The changes that one component makes to the lists of other components."""

    def __init__(self, component: Host) -> None:
        self.component = component
        self._queries = component.part(QueryClient)
        self._pending: list[ListRequest] = []
        self._last_request_id = 0
        component.on_message(ConfirmElementRequest, self._confirmed)
        component.on_message(RejectElementRequest, self._rejected)
        component.when_stopped(self.stop)

    def read(
        self,
        target: JausAddress,
        on_list: Callable[[tuple[ListElement, ...]], None],
        on_failure: Callable[[], None] | None,
        timeout: float,
        retries: int,
    ) -> None:
        """Queries the UIDs of the elements, then one element after the other."""
        elements: list[ListElement] = []

        def ask(query: Message, report: type[Message], take: Callable[..., None]) -> None:
            self._queries.ask(
                target, query, report, take, on_failure=on_failure, timeout=timeout, retries=retries
            )

        def take_list(report: ReportElementList, _sender: JausAddress) -> None:
            read_next([record.element_uid for record in report.element_list])

        def read_next(uids: list[int]) -> None:
            if not uids:
                self.component.call(on_list, tuple(elements))
                return

            def take_element(report: ReportElement, _sender: JausAddress) -> None:
                if report.element_uid != uids[0]:  # a late answer to an earlier query
                    read_next(uids)
                    return
                elements.append(_element(report))
                read_next(uids[1:])

            ask(QueryElement(element_uid=uids[0]), ReportElement, take_element)

        ask(QueryElementList(), ReportElementList, take_list)

    def next_request_id(self) -> int:
        """Returns the id of a new request, which its answer repeats."""
        self._last_request_id = (self._last_request_id + 1) & 0xFF
        return self._last_request_id

    def forget(self, request: ListRequest) -> None:
        """Drops a change that has ended; the next one to its target begins."""
        request.stop_waiting()
        if request in self._pending:
            self._pending.remove(request)
            following = self._first(request.target)
            if following is not None:
                self.component.loop.call_soon(lambda: self._begin(following))

    def stop(self) -> None:
        """Cancels all changes."""
        pending, self._pending = self._pending, []
        for request in pending:
            request.stop_waiting()

    def change(
        self,
        target: JausAddress,
        requests: Sequence[SetElement | DeleteElement],
        *,
        on_done: Callable[[], None] | None = None,
        on_refused: Callable[[int | None], None] | None = None,
        timeout: float = 1.0,
        retries: int = 3,
    ) -> ListRequest:
        """Sends requests to a target, each when the previous one is confirmed."""
        if not target.is_concrete:
            raise ValueError(f"{target} does not name one component")
        for message in requests:
            message.encode()
        request = ListRequest(self, target, requests, on_done, on_refused, timeout, retries)
        self._pending.append(request)
        self.component.when_started(lambda: self._begin(request))
        return request

    def _begin(self, request: ListRequest) -> None:
        """Starts a change, unless it waits for a former one of the same list."""
        if self._first(request.target) is request and not request.under_way:
            request.send_next()

    def _first(self, target: JausAddress) -> ListRequest | None:
        return next((request for request in self._pending if request.target == target), None)

    def _confirmed(self, message: ConfirmElementRequest, sender: JausAddress) -> None:
        for request in tuple(self._pending):
            if request.target == sender:
                request.confirmed(message.request_id)

    def _rejected(self, message: RejectElementRequest, sender: JausAddress) -> None:
        for request in tuple(self._pending):
            if request.target == sender:
                request.rejected(message.request_id, message.response_code)


def deletion(uids: Sequence[int]) -> DeleteElement:
    """Returns the request that deletes elements, at most 255."""
    return DeleteElement(
        delete_element_list=[DeleteElement.DeleteElementRec(element_uid=uid) for uid in uids]
    )


def replacement(elements: list[ListElement]) -> list[SetElement | DeleteElement]:
    """Returns the requests that delete the list and append the elements piece by piece.

    The list must be valid after each request: the last element of a piece has no next UID until
    the next piece is appended; only the last piece may close a circle.
    """
    requests: list[SetElement | DeleteElement] = [deletion([ALL_UIDS])]
    while elements:
        size, count = 0, 0
        while count < min(len(elements), MAX_ELEMENTS):
            size += ELEMENT_HEADER + len(elements[count].data)
            if count and size > MAX_BYTES:
                break
            count += 1
        piece, elements = elements[:count], elements[count:]
        records = [_record(element) for element in piece]
        if elements:
            records[-1].next_uid = NO_UID
        requests.append(SetElement(element_list=records))
    return requests


def _record(element: ListElement) -> SetElement.ElementRec:
    return SetElement.ElementRec(
        element_uid=element.uid,
        previous_uid=element.previous_uid,
        next_uid=element.next_uid,
        element_data=SetElement.ElementData(element.data_format, element.data),
    )


def _element(report: ReportElement) -> ListElement:
    data = report.element_data
    return ListElement(
        report.element_uid,
        report.previous_uid,
        report.next_uid,
        bytes(data.data),
        data.format_index,
    )


class ListEditor(Host):
    """A component that edits and reads the lists of other components."""

    def set_list(
        self,
        target: JausAddress,
        elements: Iterable[ListElement],
        *,
        on_done: Callable[[], None] | None = None,
        on_refused: Callable[[int | None], None] | None = None,
        timeout: float = 1.0,
        retries: int = 3,
    ) -> ListRequest:
        """Replaces the list of another component, which must be controlled (AS5710, SetElement).

        Args:
            elements: The list, in order; see ``chain``.
            on_done: Called when the whole list is confirmed.
            on_refused: Called with the code of RejectElementRequest, or None when the target did
                not answer; the list may then be set in part.
            timeout: Seconds to wait for each answer before the request is repeated.
        """
        with self.loop.lock:
            return self.part(ListClient).change(
                target,
                replacement(list(elements)),
                on_done=on_done,
                on_refused=on_refused,
                timeout=timeout,
                retries=retries,
            )

    def delete_elements(
        self,
        target: JausAddress,
        uids: Sequence[int],
        *,
        on_done: Callable[[], None] | None = None,
        on_refused: Callable[[int | None], None] | None = None,
        timeout: float = 1.0,
        retries: int = 3,
    ) -> ListRequest:
        """Deletes elements of another component's list, which must be controlled.

        Args:
            uids: The elements, at most 255; 65535 means all.
            on_refused: Called with the code of RejectElementRequest, or None without an answer.
            timeout: Seconds to wait for each answer before the request is repeated.
        """
        with self.loop.lock:
            return self.part(ListClient).change(
                target,
                [deletion(uids)],
                on_done=on_done,
                on_refused=on_refused,
                timeout=timeout,
                retries=retries,
            )

    def read_list(
        self,
        target: JausAddress,
        on_list: Callable[[tuple[ListElement, ...]], None],
        *,
        on_failure: Callable[[], None] | None = None,
        timeout: float = 1.0,
        retries: int = 3,
    ) -> None:
        """Reads the list of another component; control is not needed.

        Args:
            on_failure: Called when a query stayed unanswered, as when the list has changed
                meanwhile.
            timeout: Seconds to wait for each report before the query is repeated.
        """
        with self.loop.lock:
            self.part(ListClient).read(target, on_list, on_failure, timeout, retries)
