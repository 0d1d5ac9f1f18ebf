"""Lists of other components: replaced, emptied and compared as a whole (AS5710, ListManager)."""

from __future__ import annotations

from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any

from jausml.live.peers.query_client import NoAnswer, QueryClient, Refused
from jausml.runtime import chain
from jausml.runtime.messages import (
    QueryElementCount,
    QueryElementList,
    RejectElementRequest,
    ReportElementCount,
    SetElement,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.runtime import ListElement, ListRequest
    from jausml.runtime.base.address import JausAddress

_JAUS_MESSAGE = 0
"""Format of an element that is a message (AS5710, SetElement)."""

_LONGEST = 5.0
"""Seconds that one request may take, with its repetitions."""


class ListingClient(QueryClient):
    """Changes the lists of those whom we control, one change of each at a time."""

    def __init__(self, *others: Any) -> None:
        super().__init__(*others)
        self._changes: dict[JausAddress, tuple[ListRequest, SimpleQueue[str]]] = {}

    def set_list(self, target: JausAddress, payloads: Sequence[bytes]) -> None:
        """Replaces the list of a component by messages, whose UIDs are counted from 1.

        Raises:
            NoAnswer: It does not confirm; the list may be set in part.
            Refused: It rejects an element, or the change was dropped.
        """
        ends: SimpleQueue[str] = SimpleQueue()
        unanswered = "no answer"
        with self._component.loop.lock:
            if target in self._changes:
                raise Refused(f"the list of {target} is being changed")
            request = self._component.set_list(
                target,
                _elements(payloads),
                on_done=lambda: ends.put(""),
                on_refused=lambda code: ends.put(unanswered if code is None else _reason(code)),
            )
            self._changes[target] = request, ends
        try:
            told = ends.get(timeout=_LONGEST * (1 + len(payloads)))
        except Empty:  # our component has ended, which tells nobody
            told = unanswered
        finally:
            self._changes.pop(target, None)
            request.cancel()
        if told == unanswered:
            raise self.unanswered(target, SetElement.NAME, "ConfirmElementRequest")
        if told:
            raise Refused(f"{target} does not take the list: {told}")

    def drop_list_changes(self) -> None:
        """Sends nothing more of the changes that are under way."""
        with self._component.loop.lock:  # what has begun is known, and can be dropped
            changes = tuple(self._changes.values())
        for request, ends in changes:
            request.cancel()
            ends.put("it was stopped meanwhile")

    def has_list(self, target: JausAddress, payloads: Sequence[bytes]) -> bool:
        """Tells whether the list of a component is what `set_list` makes of messages."""
        wanted = _elements(payloads)
        count = self.ask(target, QueryElementCount(), ReportElementCount).element_count
        if count != len(wanted):
            return False
        found: SimpleQueue[tuple[ListElement, ...] | None] = SimpleQueue()
        self._component.read_list(target, found.put, on_failure=lambda: found.put(None))
        try:
            elements = found.get(timeout=self.timeout * (1 + len(wanted)))
        except Empty:
            elements = None
        if elements is None:
            raise NoAnswer(
                f"{target} does not tell its list, which {QueryElementList.NAME} asks for"
            )
        return list(elements) == wanted


def _elements(payloads: Sequence[bytes]) -> list[ListElement]:
    return chain((uid, payload, _JAUS_MESSAGE) for uid, payload in enumerate(payloads, 1))


def _reason(code: int) -> str:
    known = RejectElementRequest.ResponseCode
    name = known(code).name if code in tuple(known) else "of no known meaning"
    return f"{RejectElementRequest.NAME} {code}, {name.lower().replace('_', ' ')}"
