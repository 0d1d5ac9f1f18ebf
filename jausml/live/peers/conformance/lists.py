"""Checks of ListManager, Liveness and Time: elements, the heartbeat, and the clock (AS5710A).

A list that holds something is only read. An element is set in an empty list alone and deleted
again; no list is ever executed. The clock is never set.
"""

from __future__ import annotations

from datetime import datetime, timedelta, timezone

from jausml.live.peers.conformance.check import Check, step
from jausml.live.peers.conformance.event_steps import carries, created
from jausml.live.peers.conformance.evidence import CheckFailed
from jausml.live.peers.conformance.session import Session
from jausml.live.peers.conformance.steps import (
    A,
    AnythingBut,
    B,
    ask,
    expect,
    expect_none,
    has,
    quiet,
    ready,
    send,
    serves,
    should_have,
)
from jausml.runtime.messages import (
    ConfirmElementRequest,
    DeleteElement,
    QueryElement,
    QueryElementCount,
    QueryElementList,
    QueryHeartbeatPulse,
    QueryTime,
    RejectElementRequest,
    ReportElement,
    ReportElementCount,
    ReportElementList,
    ReportHeartbeatPulse,
    ReportTime,
    SetElement,
)

UNSUPPORTED_TYPE = RejectElementRequest.ResponseCode.UNSUPPORTED_ELEMENT_TYPE

_UID = 4711
_USER_DEFINED = 1


def _counts_listed(session: Session, report: ReportElementCount, _: str) -> None:
    counted, uids = report.element_count, _uids(session)
    session.require(counted == len(uids), f"{counted} elements are counted, {len(uids)} are listed")
    session.require(
        len(set(uids)) == len(uids) and not {0, 65535} & set(uids),
        f"the element UIDs {uids[:20]} hold a reserved or doubled one",
    )


def _reports_listed(session: Session) -> None:
    uids = _uids(session)
    session.skip_unless(bool(uids), "the list is empty")
    for uid in uids[:10]:
        ask(A, QueryElement(element_uid=uid), ReportElement, has(element_uid=uid))(session)


@step
def lacks(session: Session, uid: int) -> None:
    """Skips the check where an element exists."""
    session.skip_unless(uid not in _uids(session), f"element {uid} exists")


@step
def still_lacks(session: Session, uid: int) -> None:
    """An element does not exist now either."""
    session.require(uid not in _uids(session), f"element {uid} exists after {session.latest}")


@step
def empty(session: Session) -> None:
    """Skips the check where the list holds something."""
    session.skip_unless(not _uids(session), "the list is not empty and stays as it is")


@step
def holds(session: Session, *uids: int) -> None:
    """The list holds these elements and no others."""
    actual_uids = _uids(session)
    session.require(
        actual_uids == [*uids],
        f"the list holds {actual_uids} instead of {[*uids]} after {session.latest}",
    )


@step
def accepted(session: Session, client: int) -> None:
    """Skips the check where elements of user data are not supported."""
    rejection = session.client(client).find(RejectElementRequest, within=session.probe.quiet)
    code = None if rejection is None else rejection.response_code
    session.skip_unless(
        code != UNSUPPORTED_TYPE, "the target takes no user-defined elements (code 4)"
    )
    session.require(code is None, f"{session.latest} is rejected with code {code}")


def _uids(session: Session) -> list[int]:
    report = session.first.ask(QueryElementList(), ReportElementList)
    return [element_list.element_uid for element_list in report.element_list]


def _element(request_id: int) -> SetElement:
    record = SetElement.ElementRec(
        element_uid=_UID,
        previous_uid=0,
        next_uid=0,
        element_data=SetElement.ElementData(format_index=_USER_DEFINED, data=b"\0"),
    )
    return SetElement(
        request_id_rec=SetElement.RequestIDRec(request_id=request_id), element_list=[record]
    )


def _delete(request_id: int) -> DeleteElement:
    return DeleteElement(
        request_id_rec=DeleteElement.RequestIDRec(request_id=request_id),
        delete_element_list=[DeleteElement.DeleteElementRec(element_uid=_UID)],
    )


CHECKS = (
    Check(
        "list.count",
        "Counts the elements that it lists",
        "AS5710A ListManager, QueryElementCount, QueryElementList",
        "ReportElementCount is the length of ReportElementList; no UID is 0, 65535 or doubled.",
        (ask(A, QueryElementCount(), ReportElementCount, _counts_listed),),
    ),
    Check(
        "list.elements",
        "Reports its elements",
        "AS5710A ListManager, QueryElement, ReportElement",
        "Each listed element (of the first ten) is reported under its UID.",
        (_reports_listed,),
    ),
    Check(
        "list.unknown-element",
        "Reports no element that does not exist",
        "AS5710A ListManager, QueryElement, guard elementExists",
        "QueryElement of a UID that is not listed is not answered.",
        (
            lacks(_UID),
            send(A, QueryElement(element_uid=_UID)),
            expect_none(A, ReportElement, f"element {_UID} is not listed"),
        ),
    ),
    Check(
        "list.set-by-other",
        "Ignores SetElement of others than its controller",
        "AS5710A ListManager, SetElement, guard isControllingClient",
        "SetElement of a client without control does not change the list.",
        (lacks(_UID), send(B, _element(1)), quiet(), still_lacks(_UID)),
    ),
    Check(
        "list.delete-unknown",
        "Rejects the deletion of an element that does not exist",
        "AS5710A ListManager, DeleteElement, RejectElementRequest 5",
        "The rejection repeats the request id; code 5 or 1 says why.",
        (
            lacks(_UID),
            ready(A),
            send(A, _delete(9)),
            expect(A, RejectElementRequest, has(request_id=9), should_have(response_code=(5, 1))),
        ),
    ),
    Check(
        "list.set-and-delete",
        "Sets and deletes an element for its controller",
        "AS5710A ListManager, SetElement, DeleteElement, ConfirmElementRequest",
        "An element of user data is set in an empty list, reported, and deleted again.",
        (
            empty(),
            ready(A),
            send(A, _element(10)),
            accepted(A),
            expect(A, ConfirmElementRequest, has(request_id=10)),
            holds(_UID),
            send(A, _delete(11)),
            expect(A, ConfirmElementRequest, has(request_id=11)),
            holds(),
        ),
    ),
)


TIME, DATE = 1, 2
"""Bits of the presence vector of QueryTime and ReportTime (AS5710A)."""

_FIRST_YEAR = 2000
_LARGEST_DIFFERENCE = timedelta(seconds=5)


def _is_a_time(session: Session, report: ReportTime, what: str) -> None:
    """The fields lie in their ranges; a clock far from ours is noted."""
    time, date = report.time_stamp, report.date_stamp
    if time is None or date is None:
        lacking = "TimeStamp" if time is None else "DateStamp"
        raise CheckFailed(f"{what} holds no {lacking} although it was asked for")
    day = (_FIRST_YEAR + date.year, date.month, date.day)
    clock = (time.hour, time.minutes, time.seconds, 1000 * time.milliseconds)
    try:
        theirs = datetime(*day, *clock, tzinfo=timezone.utc)
    except ValueError as error:
        raise CheckFailed(f"{what} holds no date and time: {error}") from error
    if abs(theirs - session.probe.utc()) > _LARGEST_DIFFERENCE:
        session.note(f"its clock says {theirs:%Y-%m-%d %H:%M:%S} UTC, which is not ours")


LIVENESS = (
    Check(
        "liveness.pulse",
        "Reports its heartbeat",
        "AS5710A Liveness, QueryHeartbeatPulse",
        "QueryHeartbeatPulse is answered with the empty ReportHeartbeatPulse.",
        (ask(A, QueryHeartbeatPulse(), ReportHeartbeatPulse),),
    ),
    Check(
        "liveness.event",
        "Reports its heartbeat periodically",
        "AS5710A Liveness, QueryHeartbeatPulse; Events, CreateEvent",
        "A periodic event on the heartbeat is confirmed and delivers it; others watch it so.",
        (
            serves("Events"),
            created(A, query=QueryHeartbeatPulse()),
            carries(A, ReportHeartbeatPulse),
        ),
    ),
)
TIME_CHECKS = (
    Check(
        "time.report",
        "Reports time and date",
        "AS5710A Time, QueryTime, ReportTime",
        "The fields lie in their ranges; a clock far from ours is noted.",
        (ask(A, QueryTime(presence_vector=TIME | DATE), ReportTime, _is_a_time),),
    ),
    Check(
        "time.subset",
        "Reports what was asked for",
        "AS5710A Time, QueryTime: PresenceVector; the report may hold more or less",
        "A query for the time alone and one for the date alone.",
        (
            ask(
                A,
                QueryTime(presence_vector=TIME),
                ReportTime,
                should_have(time_stamp=AnythingBut(None), date_stamp=None),
            ),
            ask(
                A,
                QueryTime(presence_vector=DATE),
                ReportTime,
                should_have(time_stamp=None, date_stamp=AnythingBut(None)),
            ),
        ),
    ),
)
