"""Facts of a system in a recording: statuses and answers, as the live view takes them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from jausml.live.peers.discovery import type_name
from jausml.live.recording.mcap_files import Found, RecordingError
from jausml.live.recording.playing import JAUS_TOPICS, PlayedRecording
from jausml.live.recording.recorder import DIAGNOSTICS
from jausml.live.systems.folding import (
    AnswerSource,
    ComponentAnswer,
    DiagnosticStatus,
    fold_answer,
    fold_statuses,
)
from jausml.live.systems.reports import control_in, machines_in, state_in, timeout_in
from jausml.live.systems.state import SystemState
from jausml.runtime.messages import (
    ConfirmControl,
    QueryControl,
    QueryStatus,
    RejectControl,
    ReportControl,
    ReportIdentification,
    ReportStatus,
    ReportTimeout,
)
from jausml.runtime.messages.machine_states import ReportMachineStates
from jausml.runtime.wire.message import DecodeError

BRIDGE = "jaus state"  # name of the status of a bridge with its own state and controller

_ACCEPTED, _RELEASED = 0, 0  # response codes of ConfirmControl and RejectControl (AS5710)


@dataclass(frozen=True, slots=True)
class Fact:
    """Statuses or an answer at a time, in seconds since the beginning."""

    time: float
    statuses: tuple[DiagnosticStatus, ...] = ()
    answer: ComponentAnswer | None = None


def fold_fact(state: SystemState, fact: Fact) -> SystemState:
    """Returns the state after a fact."""
    if fact.answer is not None:
        return fold_answer(state, fact.answer, fact.time)
    return fold_statuses(state, fact.statuses, fact.time)


def _identification(report: ReportIdentification, _: str) -> dict[str, Any]:
    return {"name": report.identification or None, "type": type_name(report.type_) or None}


def _confirmed(report: ConfirmControl, client: str) -> dict[str, Any]:
    return {"controller": client} if report.response_code == _ACCEPTED else {}


def _rejected(report: RejectControl, _: str) -> dict[str, Any]:
    return {"controller": ""} if report.response_code == _RELEASED else {}


# Classes of messages, and functions that return the facts in them about the sender, by name.
_READERS: dict[str, tuple[Any, Callable[[Any, str], dict[str, Any]]]] = {
    "ReportStatus": (ReportStatus, state_in),
    "ReportControl": (ReportControl, control_in),
    "ReportTimeout": (ReportTimeout, timeout_in),
    "ReportIdentification": (ReportIdentification, _identification),
    "ConfirmControl": (ConfirmControl, _confirmed),
    "RejectControl": (RejectControl, _rejected),
    "ReportMachineStates": (ReportMachineStates, machines_in),
}

_QUERIES = (QueryStatus.NAME, QueryControl.NAME)


class Listener:
    """Finds the facts in the messages of a recording, which are read in their order.

    Attributes:
        unreadable: Number of messages that cannot be read.
        hears_ros: Whether there is a message of `/diagnostics`.
        hears_jaus: Whether there is a JAUS message.
    """

    def __init__(self, recording: PlayedRecording) -> None:
        """Begins without a message."""
        self.unreadable = 0
        self.hears_ros = self.hears_jaus = False
        self._recording = recording
        self._open_queries: dict[str, set[tuple[str, str]]] = {}
        self._controllers: dict[str, str] = {}

    def facts(self, time: float, record: Found) -> Iterator[Fact]:
        """Yields the facts in a message; most have none."""
        topic = record[1].topic
        try:
            if topic == DIAGNOSTICS:
                self.hears_ros = True
                statuses = statuses_of(self._recording.value_of(record))
                yield Fact(time, statuses)
                for status in statuses:
                    if status.name.endswith(f": {BRIDGE}"):
                        yield Fact(time, answer=_own_answer(status))
            elif topic.startswith(JAUS_TOPICS):
                self.hears_jaus = True
                yield from self._message_facts(time, topic, record)
        except (RecordingError, DecodeError, KeyError, TypeError, ValueError, AttributeError):
            self.unreadable += 1

    def _message_facts(self, time: float, topic: str, record: Found) -> Iterator[Fact]:
        source, _, name = topic.removeprefix(JAUS_TOPICS).partition("/")
        self._open_queries.pop(source, None)
        if name not in _READERS and name not in _QUERIES:
            return
        value = self._recording.value_of(record)
        other = str(value["destination"])
        if name in _QUERIES:
            yield from self._unanswered(time, other, (source, name))
            return
        kind, read = _READERS[name]
        fields = read(kind.decode(bytes.fromhex(value["payload"])), other)
        # One to a former controller is repeated until it acknowledges, or comes later.
        if kind is RejectControl and self._controllers.get(source, other) != other:
            return
        if "controller" in fields:
            self._controllers[source] = fields["controller"]
        if fields:
            yield Fact(time, answer=ComponentAnswer(source, **fields))

    def _unanswered(self, time: float, asked: str, question: tuple[str, str]) -> Iterator[Fact]:
        """Yields a fact if a component gets the same query again without having answered."""
        waiting = self._open_queries.setdefault(asked, set())
        if question in waiting:
            yield Fact(time, answer=ComponentAnswer(asked, source=AnswerSource.NOBODY))
            waiting.clear()
        waiting.add(question)


def _own_answer(status: DiagnosticStatus) -> ComponentAnswer:
    """Returns the state of a bridge in its own status, in the form of an answer."""
    values = dict(status.values)
    controller = values.get("controller")
    return ComponentAnswer(
        status.hardware_id,
        state=values.get("jaus", "").upper() or None,
        controller="" if controller == "none" else controller,
    )


def statuses_of(value: dict[str, Any]) -> tuple[DiagnosticStatus, ...]:
    """Returns the statuses of a `diagnostic_msgs/msg/DiagnosticArray`."""
    return tuple(
        DiagnosticStatus(
            status["level"],
            status["name"],
            status["message"],
            status["hardware_id"],
            tuple((pair["key"], pair["value"]) for pair in status["values"]),
        )
        for status in value["status"]
    )
