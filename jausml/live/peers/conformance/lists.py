"""Checks of ListManager: the list of elements (AS5710A).

A list that holds something is only read. An element is set in an empty list alone and deleted
again; no list is ever executed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.live.peers.conformance.check import check
from jausml.live.peers.conformance.client import decoded
from jausml.live.peers.conformance.evidence import CheckFailed
from jausml.runtime.messages import (
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

if TYPE_CHECKING:
    from jausml.live.peers.conformance.client import Client
    from jausml.live.peers.conformance.session import Session

UNSUPPORTED_TYPE = RejectElementRequest.ResponseCode.UNSUPPORTED_ELEMENT_TYPE

_UID = 4711
_USER_DEFINED = 1


@check(
    "list.count",
    "Counts the elements that it lists",
    "AS5710A ListManager, QueryElementCount, QueryElementList",
)
def count(session: Session) -> None:
    """ReportElementCount is the length of ReportElementList; no UID is 0, 65535 or doubled."""
    uids = _uids(session)
    counted = session.first.ask(QueryElementCount(), ReportElementCount).element_count
    session.require(counted == len(uids), f"{counted} elements are counted, {len(uids)} are listed")
    session.require(
        len(set(uids)) == len(uids) and not {0, 65535} & set(uids),
        f"the element UIDs {uids[:20]} hold a reserved or doubled one",
    )


@check(
    "list.elements",
    "Reports its elements",
    "AS5710A ListManager, QueryElement, ReportElement",
)
def elements(session: Session) -> None:
    """Each listed element (of the first ten) is reported under its UID."""
    uids = _uids(session)
    session.skip_unless(bool(uids), "the list is empty")
    for uid in uids[:10]:
        report = session.first.ask(QueryElement(element_uid=uid), ReportElement)
        session.require(
            report.element_uid == uid, f"element {uid} is reported as {report.element_uid}"
        )


@check(
    "list.unknown-element",
    "Reports no element that does not exist",
    "AS5710A ListManager, QueryElement, guard elementExists",
)
def unknown_element(session: Session) -> None:
    """QueryElement of a UID that is not listed is not answered."""
    session.skip_unless(_UID not in _uids(session), f"element {_UID} exists")
    session.first.send(QueryElement(element_uid=_UID))
    session.first.expect_none(ReportElement, f"element {_UID} is not listed")


@check(
    "list.set-by-other",
    "Ignores SetElement of others than its controller",
    "AS5710A ListManager, SetElement, guard isControllingClient",
)
def set_by_other(session: Session) -> None:
    """SetElement of a client without control does not change the list."""
    before = _uids(session)
    session.second.send(_element(request_id=1, uid=_UID))
    session.probe.wait(lambda: False, session.probe.quiet)
    session.require(_uids(session) == before, "a client without control can change the list")


@check(
    "list.delete-unknown",
    "Rejects the deletion of an element that does not exist",
    "AS5710A ListManager, DeleteElement, RejectElementRequest 5",
)
def delete_unknown(session: Session) -> None:
    """The rejection repeats the request id; code 5 or 1 says why."""
    session.skip_unless(_UID not in _uids(session), f"element {_UID} exists")
    session.make_ready(0)
    code = _answer(session.first, _delete(request_id=9, uid=_UID), 9)
    session.require(code is not None, "the deletion of an unknown element is confirmed")
    if code not in (1, 5):
        session.note(f"rejected with code {code}; 5 (element id not found) is usual")


@check(
    "list.set-and-delete",
    "Sets and deletes an element for its controller",
    "AS5710A ListManager, SetElement, DeleteElement, ConfirmElementRequest",
)
def set_and_delete(session: Session) -> None:
    """An element of user data is set in an empty list, reported, and deleted again."""
    session.skip_unless(not _uids(session), "the list is not empty and stays as it is")
    session.make_ready(0)
    code = _answer(session.first, _element(request_id=10, uid=_UID), 10)
    session.skip_unless(
        code != UNSUPPORTED_TYPE, "the target takes no user-defined elements (code 4)"
    )
    session.require(code is None, f"SetElement is rejected with code {code}")
    uids = _uids(session)
    code = _answer(session.first, _delete(request_id=11, uid=_UID), 11)
    session.require(uids == [_UID], f"the list holds {uids} after element {_UID} was set")
    session.require(code is None, f"DeleteElement is rejected with code {code}")
    session.require(not _uids(session), "the list is not empty after its element was deleted")


CHECKS = (count, elements, unknown_element, set_by_other, delete_unknown, set_and_delete)


def _uids(session: Session) -> list[int]:
    report = session.first.ask(QueryElementList(), ReportElementList)
    return [each.element_uid for each in report.element_list]


def _element(request_id: int, uid: int) -> SetElement:
    record = SetElement.ElementRec(
        element_uid=uid,
        previous_uid=0,
        next_uid=0,
        element_data=SetElement.ElementData(format_index=_USER_DEFINED, data=b"\0"),
    )
    return SetElement(
        request_id_rec=SetElement.RequestIDRec(request_id=request_id), element_list=[record]
    )


def _delete(request_id: int, uid: int) -> DeleteElement:
    return DeleteElement(
        request_id_rec=DeleteElement.RequestIDRec(request_id=request_id),
        delete_element_list=[DeleteElement.DeleteElementRec(element_uid=uid)],
    )


def _answer(client: Client, message: SetElement | DeleteElement, request_id: int) -> int | None:
    """Sends a request and returns the response code of its rejection, None when confirmed."""
    client.send(message)
    codes = (ConfirmElementRequest.CODE, RejectElementRequest.CODE)
    received = client.first_of(codes)
    if received is None:
        raise CheckFailed(f"{message.NAME} of the controller is neither confirmed nor rejected")
    if received.code == ConfirmElementRequest.CODE:
        confirmed = decoded(ConfirmElementRequest, received.payload)
        answered, code = confirmed.request_id, None
    else:
        rejected = decoded(RejectElementRequest, received.payload)
        answered, code = rejected.request_id, int(rejected.response_code)
    if answered != request_id:
        raise CheckFailed(f"the answer names request {answered} instead of {request_id}")
    return code
