"""States of a bridge and of its connections: reasons of stops, phases, and their log."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

from ...base.address import JausAddress
from ...base.counters import LOGGER
from ...services.definitions import Status


class StopReason(Enum):
    """Why a connection is stopped; logs and diagnostics show the value."""

    START = "no message yet"
    SILENCE = "the source is silent"
    CONTROL_RELEASED = "control was released"
    CONTROL_LAPSED = "control lapsed: its client did not request it again in time"
    TAKEN_OVER = "another component took control"
    INACTIVE = "the bridge is inactive"
    CLOCK = "nobody says the time on /clock"
    STANDBY = "the bridge stands by"
    RESET = "the bridge is reset"
    EMERGENCY = "emergency"
    FAILURE = "the bridge has failed"
    STOOD_STILL = "the bridge stood still, and its guardian has stopped what it commands"
    END = "the bridge ends"


_HALTS = {  # states in which the bridge may not command
    Status.INITIALIZE: StopReason.RESET,
    Status.EMERGENCY: StopReason.EMERGENCY,
    Status.FAILURE: StopReason.FAILURE,
    Status.SHUTDOWN: StopReason.END,
}


@dataclass(frozen=True)
class Standing:
    """Status, controller and activity of a bridge, which decide what it may command."""

    status: Status
    controller: JausAddress | None
    is_active: bool = True
    has_lapsed: bool = False  # whether the last controller has let its control lapse

    @property
    def halt(self) -> StopReason | None:
        """Why the bridge may not command its peers now; None when it may.

        A bridge with a controller commands only in Ready; one without also in Standby, as no
        controller can resume it.
        """
        if not self.is_active:
            return _HALTS.get(self.status, StopReason.INACTIVE)
        if self.status is Status.STANDBY and self.controller is not None:
            return StopReason.STANDBY
        return _HALTS.get(self.status)

    @property
    def without_controller(self) -> StopReason:
        """How the former controller lost its control, where no other took it over."""
        return StopReason.CONTROL_LAPSED if self.has_lapsed else StopReason.CONTROL_RELEASED

    def lost_since(self, former: Standing) -> StopReason | None:
        """Returns why commands of the former controller have to end; None if they may go on."""
        if former.is_active and not self.is_active:
            return StopReason.INACTIVE
        if self.status is not former.status and self.status in _HALTS:
            return _HALTS[self.status]
        if former.status in _HALTS:
            return None  # no command was in effect in that state
        if former.controller not in (None, self.controller):
            return StopReason.TAKEN_OVER if self.controller else self.without_controller
        left_ready = former.status is Status.READY and self.status is not Status.READY
        return StopReason.STANDBY if left_ready else None


class ConnectionPhase(Enum):
    """State of a connection; diagnostics and logs show the value."""

    WAITING = "waiting"  # no message came yet, or a peer is lacking
    ACTIVE = "active"
    DEGRADED = "degraded"  # messages pass, with faults
    SILENT = "silent"  # usable messages of the source have ceased; a stop was sent, if there is one
    REFUSED = "refused"  # messages may not pass, or no peer obeys
    FAILED = "failed"  # messages cannot be translated


LEVELS = {  # of `/diagnostics`
    ConnectionPhase.WAITING: "stale",
    ConnectionPhase.ACTIVE: "ok",
    ConnectionPhase.DEGRADED: "warning",
    ConnectionPhase.SILENT: "stale",
    ConnectionPhase.REFUSED: "stale",
    ConnectionPhase.FAILED: "error",
}

_SILENCES = (StopReason.SILENCE, StopReason.CLOCK)


@dataclass(frozen=True, slots=True)
class Facts:
    """Facts by which a connection is judged; a text is empty where all is well."""

    error: str = ""  # of values
    fault: str = ""  # of topics
    lacking: str = ""  # which peer or service is not there
    failing: str = ""  # why none of the latest messages could be passed on
    stopped: StopReason | None = None  # why the stop was the last message sent
    forbidden: str = ""  # why no message may be passed on now
    is_heard: bool = True  # whether a message ever came
    refusal: str = ""  # why no peer obeys
    complaint: str = ""  # the fault of a connection that passes messages on


class Judgement(NamedTuple):
    """State of a connection, and the reason in words."""

    phase: ConnectionPhase
    reason: str

    @property
    def level(self) -> str:
        """Level of `/diagnostics`."""
        return LEVELS[self.phase]


def judge(facts: Facts) -> Judgement:
    """Returns the state of a connection, by the first fact in the order of importance."""
    if facts.error:
        return Judgement(ConnectionPhase.FAILED, facts.error)
    if facts.fault:
        return Judgement(ConnectionPhase.DEGRADED, facts.fault)
    if facts.lacking:
        return Judgement(ConnectionPhase.WAITING, facts.lacking)
    if facts.failing and not facts.forbidden:
        return Judgement(ConnectionPhase.FAILED, facts.failing)
    if facts.stopped is not None:
        return _stopped(facts, facts.stopped)
    if facts.forbidden:
        return Judgement(ConnectionPhase.REFUSED, facts.forbidden)
    if not facts.is_heard:
        return Judgement(ConnectionPhase.WAITING, StopReason.START.value)
    if facts.refusal:
        return Judgement(ConnectionPhase.REFUSED, facts.refusal)
    if facts.complaint:
        return Judgement(ConnectionPhase.DEGRADED, facts.complaint)
    return Judgement(ConnectionPhase.ACTIVE, "running")


def _stopped(facts: Facts, reason: StopReason) -> Judgement:
    """Returns the state of a stopped connection."""
    if reason in _SILENCES and facts.is_heard:
        return Judgement(ConnectionPhase.SILENT, reason.value)
    if reason in (StopReason.START, *_SILENCES) or not (facts.is_heard or facts.forbidden):
        return Judgement(ConnectionPhase.WAITING, StopReason.START.value)
    if facts.forbidden:
        return Judgement(ConnectionPhase.REFUSED, facts.forbidden)
    return Judgement(ConnectionPhase.WAITING, f"no message since the stop: {reason.value}")


INTERVAL = 10.0  # least seconds between two lines of the log about one connection
PATIENCE = 3.0  # seconds after which a waiting connection is logged with its reason
_WARNED = (ConnectionPhase.SILENT, ConnectionPhase.FAILED)  # DEGRADED is warned of by its counts


class StateLog:
    """Logs changes of the state of a connection, not too often."""

    def __init__(self, name: str) -> None:
        """Begins with a waiting connection, which is not logged."""
        self._name = name
        self._last_phase = ConnectionPhase.WAITING
        self._next = 0.0
        self._reason = StopReason.START.value
        self._waiting_since = 0.0

    def note(self, judgement: Judgement, now: float) -> None:
        """Logs a change of the state, unless the last line was less than `INTERVAL` ago."""
        phase = judgement.phase
        if phase is ConnectionPhase.WAITING and judgement.reason != self._reason:
            self._reason, self._waiting_since = judgement.reason, now
        is_due = self._waiting_since > 0 and now - self._waiting_since >= PATIENCE
        if phase is self._last_phase is ConnectionPhase.WAITING and is_due:
            self._waiting_since = 0.0
            LOGGER.info("%s is %s: %s", self._name, phase.value, judgement.reason)
        if phase is self._last_phase or now < self._next:
            return
        self._last_phase, self._next = phase, now + INTERVAL
        level = logging.WARNING if phase in _WARNED else logging.INFO
        LOGGER.log(level, "%s is %s: %s", self._name, phase.value, judgement.reason)
