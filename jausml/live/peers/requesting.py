"""Commands of an operator: a request with its answer, or a command repeated while it is obeyed."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Collection, Iterator
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from queue import Empty
from typing import Any

from jausml.language import wire
from jausml.live.messages import MessageEntry, MessageError, UnknownMessageError, read_code
from jausml.live.peers.control import Hold
from jausml.live.peers.entry_messages import full_query, message_class
from jausml.live.peers.operator import Operator
from jausml.live.peers.query_client import NoAnswer, Refused
from jausml.live.peers.rendering import field_texts, printable, shown_fields, status_line
from jausml.runtime.base.address import JausAddress
from jausml.runtime.services.definitions import Status
from jausml.runtime.wire.message import Message

Outcome = tuple["MessageEntry", dict[str, Any]]  # an answer or report, and its fields

_PAUSE = 0.05  # seconds between two queries of the values that a command sets
# States after the commands of Management (AS5710).
_STATES: dict[str, Collection[str]] = {
    "ClearEmergency": ("STANDBY", "READY"),
    "Resume": ("READY",),
    "SetEmergency": ("EMERGENCY",),
    "Shutdown": ("SHUTDOWN",),
    "Standby": ("STANDBY",),
}


@dataclass(frozen=True)
class Course:
    """The times of a command.

    Attributes:
        rate: Messages each second; None for a single one.
        duration: Seconds to hold control after the first message.
        keep_sending: Whether it is sent on after the component is lost.
    """

    rate: float | None = None
    duration: float = 0.0
    keep_sending: bool = False

    def next_due(self, last: float, now: float) -> float | None:
        """Returns the time of the next message, None when there is none.

        Times are in seconds since the first message. Missed messages are left out.
        """
        if not self.rate:
            return None
        due = max(round(last * self.rate) + 1, math.ceil(now * self.rate)) / self.rate
        return due if due < self.duration else None


def command(
    operator: Operator, hold: Hold, message: Message, course: Course, tell: Callable[[str], None]
) -> None:
    """Sends a message to a controlled component; watches that it stays Ready and controlled.

    A loss is passed to `tell` in words, and ends the command unless `keep_sending` is set.
    """
    begin = time.monotonic()
    is_lost = False
    due: float | None = 0.0
    while due is not None:
        operator.send(hold.target, message)
        due = course.next_due(due, time.monotonic() - begin)
        until = begin + (course.duration if due is None else due)
        if not is_lost and hold.wait_for_loss(until - time.monotonic()):
            is_lost = True
            tell(f"{hold.target} is lost: {_state_text(operator, hold)}")
            if not course.keep_sending:
                return
        time.sleep(max(0.0, until - time.monotonic()))
    if not is_lost:
        _check_finally(operator, hold, tell)


def _check_finally(operator: Operator, hold: Hold, tell: Callable[[str], None]) -> None:
    """Queries the state a last time, to notice a loss before control is released."""
    try:
        state, _ = operator.status(hold.target)
    except NoAnswer:
        hold.lose()
        tell(f"{hold.target} is lost: it does not answer any more")
        return
    if hold.is_lost or (hold.was_ready and state is not None and state is not Status.READY):
        hold.lose()
        tell(f"{hold.target} is lost: {_state_text(operator, hold)}")


def _state_text(operator: Operator, hold: Hold) -> str:
    try:
        return status_line(*operator.status(hold.target))
    except NoAnswer:
        return "it does not answer any more"


def outcome(name: str, hold: Hold) -> str:
    """Returns the numbers of sent messages and of doubtful ones (see `Hold`), in words."""
    times = f" {hold.sent} times" if hold.sent != 1 else ""
    text = f"{name} sent to {hold.target}{times}"
    if hold.doubtful:
        wanted = "READY and ours" if hold.was_ready else "ours"
        text += f", {hold.doubtful} of them when it may not have been {wanted}"
    return text


def request(
    operator: Operator,
    target: JausAddress,
    name: str,
    fields: dict[str, Any] | None = None,
    timeout: float | None = None,
    gate: AbstractContextManager[None] | None = None,
) -> Outcome:
    """Sends a command and returns its confirmation, or the report of the value that it sets.

    A command with neither is followed by QueryStatus, whose report comes after any rejection. A
    query is answered by its report, as with `Operator.query`.

    Args:
        gate: Is held while the command is sent, and may refuse it.

    Raises:
        NoAnswer: The component does not answer.
        Refused: The command was rejected, or has no effect; the text says why.
    """
    try:
        entry = operator.find(target, name)
    except UnknownMessageError:
        return operator.query(target, name, fields, timeout)
    if entry.name.startswith(("Query", "Report")):
        return operator.query(target, name, fields, timeout)
    answers = entry.relations.answers
    sent_fields = entry.completed(fields or {})
    if any(_has_request_id(answer) for answer in answers):
        sent_fields = _with_request_id(entry.record, sent_fields, operator.next_request_id())
    operator.check_obeyed(target, entry)
    end = time.monotonic() + (operator.timeout if timeout is None else timeout)
    outcome_of = _report if all(answer.is_rejection for answer in answers) else _answer
    return outcome_of(operator, target, entry, sent_fields, answers, end, gate or nullcontext())


# -- commands with a confirmation ------------------------------------------------------------------


def _answer(
    operator: Operator,
    target: JausAddress,
    entry: MessageEntry,
    fields: dict[str, Any],
    answers: tuple[MessageEntry, ...],
    end: float,
    gate: AbstractContextManager[None],
) -> Outcome:
    """Sends a command and returns the answer that belongs to it."""
    by_code = {answer_entry.code: answer_entry for answer_entry in answers}
    message = operator.message(entry, fields)
    wanted = _request_id(entry.decode(message.encode()))
    with operator.awaiting(target, by_code) as queue:
        with gate:
            operator.send(target, message, acknowledge=True)
        while True:
            try:
                payload = queue.get(timeout=max(0.0, end - time.monotonic()))
            except Empty:
                raise _unanswered(operator, target, entry, answers) from None
            answer = by_code[read_code(payload)]
            try:
                answer_fields = answer.decode(payload)
            except MessageError:
                continue  # the error of a missing answer says so
            if _request_id(answer_fields) in (None, wanted):
                break
    operator.answered(target, message)
    if answer.is_rejection:
        raise _rejected(target, entry, answer, answer_fields)
    return answer, answer_fields


def _rejected(
    target: JausAddress, entry: MessageEntry, answer: MessageEntry, fields: dict[str, Any]
) -> Refused:
    description = printable(shown_fields(answer, fields))
    return Refused(f"{target} rejects {entry.name}: {answer.name} {description}")


def _unanswered(
    operator: Operator, target: JausAddress, entry: MessageEntry, answers: tuple[MessageEntry, ...]
) -> Exception:
    """Returns the error for a command without an answer, with the likely reason."""
    reason = operator.why_ignored(target)
    if reason:
        return Refused(f"{target} does not answer {entry.name}: {reason}")
    return operator.unanswered(target, entry.name, answers[0].name if len(answers) == 1 else "")


def _has_request_id(entry: MessageEntry) -> bool:
    return any(member.name == "RequestID" for member in _members(entry))


def _members(entry: MessageEntry) -> Iterator[Any]:
    for body in entry.record.members:
        yield from getattr(body.kind, "members", ())


def _request_id(fields: Any) -> Any:
    """Returns the RequestID in fields, which an answer has from its command; None without one."""
    if not isinstance(fields, dict):
        return None
    if "RequestID" in fields:
        return fields["RequestID"]
    request_ids = (_request_id(field) for field in fields.values())
    return next((request_id for request_id in request_ids if request_id is not None), None)


def _with_request_id(kind: wire.Record, fields: dict[str, Any], number: int) -> dict[str, Any]:
    """Returns fields with `number` as the RequestID, unless they have one."""
    new_fields = dict(fields)
    for member in kind.members:
        if member.name == "RequestID":
            new_fields.setdefault(member.name, number)
        elif isinstance(member.kind, wire.Record) and not member.is_optional:
            inner = new_fields.get(member.name, {})
            numbered = (
                _with_request_id(member.kind, inner, number) if isinstance(inner, dict) else inner
            )
            if numbered:
                new_fields[member.name] = numbered
    return new_fields


# -- commands without a confirmation ---------------------------------------------------------------


def _report(
    operator: Operator,
    target: JausAddress,
    entry: MessageEntry,
    fields: dict[str, Any],
    rejections: tuple[MessageEntry, ...],
    end: float,
    gate: AbstractContextManager[None],
) -> Outcome:
    """Sends a command and returns the first report with the value that it sets."""
    query, report = entry.relations.exchange or operator.exchange(target, "Status")
    message = operator.message(entry, fields)
    sent = entry.decode(message.encode())
    question = operator.message(query, _question(query, report, entry.shortened(sent)))
    wanted = _wanted(entry, report, sent)
    by_code = {rejection.code: rejection for rejection in rejections}
    with operator.awaiting(target, by_code) as rejected:
        with gate:
            operator.send(target, message, acknowledge=True)
        while True:
            left = max(_PAUSE, end - time.monotonic())
            report_fields, unanswered = _query_report(operator, target, question, report, left)
            if not rejected.empty():
                payload = rejected.get()
                answer = by_code[read_code(payload)]
                raise _rejected(target, entry, answer, answer.decode(payload))
            if unanswered is not None:
                reason = operator.why_ignored(target)
                if not reason:
                    raise unanswered
                raise Refused(f"{target} does not answer {query.name}: {reason}")
            values = report.shortened(report_fields)
            differing = next((name for name in wanted if values.get(name) not in wanted[name]), "")
            if not differing:
                operator.answered(target, message)
                return report, report_fields
            if time.monotonic() > end:
                shown = _shown(report, report_fields, differing)
                reason = operator.why_ignored(target)
                text = f"{target} reports {shown} after {entry.name}"
                raise Refused(f"{text}: {reason}" if reason else text)
            time.sleep(_PAUSE)


def _query_report(
    operator: Operator, target: JausAddress, question: Message, report: MessageEntry, left: float
) -> tuple[dict[str, Any], NoAnswer | None]:
    """Queries a report; returns its fields, or the error that none answer_fields."""
    try:
        return operator.ask(target, question, message_class(report), left).fields, None
    except NoAnswer as error:
        return {}, error


def _question(query: MessageEntry, report: MessageEntry, sent: dict[str, Any]) -> dict[str, Any]:
    """Returns the fields of a query for set values, with the sent fields that both have."""
    fields = full_query(query, report)
    same = {member.name: sent[member.name] for member in _members(query) if member.name in sent}
    for body in query.record.members if same else ():
        fields[body.name] |= same
    return fields


def _shown(report: MessageEntry, fields: dict[str, Any], name: str) -> str:
    """Returns a field of a report with its value, in words."""
    texts = field_texts(report.record, fields)
    return next((f"{path}={text}" for path, text in texts if path == name), f"no {name}")


def _wanted(
    entry: MessageEntry, report: MessageEntry, sent: dict[str, Any]
) -> dict[str, Collection[Any]]:
    """Returns the values that a report must have: those of equal fields of the command."""
    if report.name == "ReportStatus":
        is_obeyed_in_ready = entry.is_command and entry.name not in _STATES
        states = ("READY",) if is_obeyed_in_ready else _STATES.get(entry.name)
        return {} if states is None else {"Status": states}
    kinds = {member.name: member.kind for member in _members(report)}
    alike = {member.name for member in _members(entry) if kinds.get(member.name) == member.kind}
    return {name: (value,) for name, value in entry.shortened(sent).items() if name in alike}
