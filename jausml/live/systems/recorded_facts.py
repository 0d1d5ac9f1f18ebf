"""Facts of a system in a recording, in the values that the live view is fed with."""

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

BRIDGE = "jaus state"  # the status in which a bridge tells its own state and controller

_ACCEPTED, _RELEASED = 0, 0  # response codes of ConfirmControl and RejectControl (AS5710)


@dataclass(frozen=True, slots=True)
class Fact:
    """The statuses or the answer at a time, in seconds since the beginning."""

    time: float
    statuses: tuple[DiagnosticStatus, ...] = ()
    answer: ComponentAnswer | None = None


def fold_fact(state: SystemState, fact: Fact) -> SystemState:
    """Returns the state after something was told."""
    if fact.answer is not None:
        return fold_answer(state, fact.answer, fact.time)
    return fold_statuses(state, fact.statuses, fact.time)


def _identification(report: ReportIdentification, _: str) -> dict[str, Any]:
    return {"name": report.identification or None, "type": type_name(report.type_) or None}


def _confirmed(report: ConfirmControl, client: str) -> dict[str, Any]:
    return {"controller": client} if report.response_code == _ACCEPTED else {}


def _rejected(report: RejectControl, _: str) -> dict[str, Any]:
    return {"controller": ""} if report.response_code == _RELEASED else {}


# The functions that read the facts in each message about its sender, by its name.
_TELLING: dict[str, tuple[Any, Callable[[Any, str], dict[str, Any]]]] = {
    "ReportStatus": (ReportStatus, state_in),
    "ReportControl": (ReportControl, control_in),
    "ReportTimeout": (ReportTimeout, timeout_in),
    "ReportIdentification": (ReportIdentification, _identification),
    "ConfirmControl": (ConfirmControl, _confirmed),
    "RejectControl": (RejectControl, _rejected),
    "ReportMachineStates": (ReportMachineStates, machines_in),
}

_ASKING = (QueryStatus.NAME, QueryControl.NAME)


class Listener:
    """Takes the messages of a recording, in their order.

    Attributes:
        unreadable: How many of them could not be read.
        hears_ros: Whether bridges told anything.
        hears_jaus: Whether there is a JAUS message.
    """

    def __init__(self, recording: PlayedRecording) -> None:
        """Begins without a message."""
        self.unreadable = 0
        self.hears_ros = self.hears_jaus = False
        self._recording = recording
        self._asked: dict[str, set[tuple[str, str]]] = {}

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
                        yield Fact(time, answer=_of_itself(status))
            elif topic.startswith(JAUS_TOPICS):
                self.hears_jaus = True
                yield from self._said(time, topic, record)
        except (RecordingError, DecodeError, KeyError, TypeError, ValueError, AttributeError):
            self.unreadable += 1

    def _said(self, time: float, topic: str, record: Found) -> Iterator[Fact]:
        source, _, name = topic.removeprefix(JAUS_TOPICS).partition("/")
        self._asked.pop(source, None)
        if name not in _TELLING and name not in _ASKING:
            return
        value = self._recording.value_of(record)
        other = str(value["destination"])
        if name in _ASKING:
            yield from self._unanswered(time, other, (source, name))
            return
        kind, told_by = _TELLING[name]
        fields = told_by(kind.decode(bytes.fromhex(value["payload"])), other)
        if fields:
            yield Fact(time, answer=ComponentAnswer(source, **fields))

    def _unanswered(self, time: float, asked: str, question: tuple[str, str]) -> Iterator[Fact]:
        """Yields the fact that a component gets the same question again, without an answer."""
        waiting = self._asked.setdefault(asked, set())
        if question in waiting:
            yield Fact(time, answer=ComponentAnswer(asked, source=AnswerSource.NOBODY))
            waiting.clear()
        waiting.add(question)


def _of_itself(status: DiagnosticStatus) -> ComponentAnswer:
    """Returns the state of a bridge as it reports itself, so that nobody has to ask it."""
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
