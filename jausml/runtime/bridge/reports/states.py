"""States of a bridge and of its connections: why nothing stands, and how it goes in one word."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

from ...base.address import JausAddress
from ...base.counters import LOGGER
from ...services.definitions import Status


class StopReason(Enum):
    """Why the stop stands on the other side; the value is what logs and diagnostics say."""

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


_HALTS = {
    Status.INITIALIZE: StopReason.RESET,
    Status.EMERGENCY: StopReason.EMERGENCY,
    Status.FAILURE: StopReason.FAILURE,
    Status.SHUTDOWN: StopReason.END,
}
"""States in which nothing is commanded, whoever wants to."""


@dataclass(frozen=True)
class Standing:
    """What the JAUS side of a bridge may do."""

    status: Status
    controller: JausAddress | None
    is_active: bool = True
    has_lapsed: bool = False  # nobody controls the bridge since its controller let control lapse

    @property
    def halt(self) -> StopReason | None:
        """Why the bridge commands nothing of its own now; None when it does.

        A bridge that somebody controls commands in Ready alone. One that nobody controls works by
        itself: the Standby of a bridge that nobody ever resumes forbids nothing.
        """
        if not self.is_active:
            return _HALTS.get(self.status, StopReason.INACTIVE)
        if self.status is Status.STANDBY and self.controller is not None:
            return StopReason.STANDBY
        return _HALTS.get(self.status)

    @property
    def without_controller(self) -> StopReason:
        """Why the former controller has control no more, where nobody took it over."""
        return StopReason.CONTROL_LAPSED if self.has_lapsed else StopReason.CONTROL_RELEASED

    def lost_since(self, former: Standing) -> StopReason | None:
        """Returns why what the former controller commanded must not stand; None when it may."""
        if former.is_active and not self.is_active:
            return StopReason.INACTIVE
        if self.status is not former.status and self.status in _HALTS:
            return _HALTS[self.status]
        if former.status in _HALTS:
            return None  # what stood then ended with that state
        if former.controller not in (None, self.controller):
            return StopReason.TAKEN_OVER if self.controller else self.without_controller
        left_ready = former.status is Status.READY and self.status is not Status.READY
        return StopReason.STANDBY if left_ready else None


class ConnectionPhase(Enum):
    """How it stands with a connection; the value is what diagnostics and logs say."""

    WAITING = "waiting"  # nothing came yet, or the other end is not there
    ACTIVE = "active"
    DEGRADED = "degraded"  # messages pass, but not as they should
    SILENT = "silent"  # the source says nothing usable any more; its stop stands, if it has one
    REFUSED = "refused"  # it may not pass anything on, or nobody obeys
    FAILED = "failed"  # what comes cannot be passed on


LEVELS = {
    ConnectionPhase.WAITING: "stale",
    ConnectionPhase.ACTIVE: "ok",
    ConnectionPhase.DEGRADED: "warning",
    ConnectionPhase.SILENT: "stale",
    ConnectionPhase.REFUSED: "stale",
    ConnectionPhase.FAILED: "error",
}
"""Levels of `/diagnostics`."""

_SILENCES = (StopReason.SILENCE, StopReason.CLOCK)


@dataclass(frozen=True, slots=True)
class Facts:
    """What is known of a connection. Texts are empty for what is well."""

    error: str = ""  # what is wrong with the values that it is given
    fault: str = ""  # what is wrong with its topics
    lacking: str = ""  # which other end is not there
    failing: str = ""  # why none of the latest messages could be passed on
    stopped: StopReason | None = None  # why no messages of the source stand
    forbidden: str = ""  # why nothing may be passed on now
    is_heard: bool = True  # whether a message ever came
    refusal: str = ""  # why nobody at the other end obeys
    complaint: str = ""  # what is not as it should be, though messages pass


class Judgement(NamedTuple):
    """State of a connection."""

    phase: ConnectionPhase
    reason: str

    @property
    def level(self) -> str:
        """Level of `/diagnostics`."""
        return LEVELS[self.phase]


def judge(facts: Facts) -> Judgement:
    """Returns the state of a connection; of several facts the one that explains the others."""
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
    """Returns the state while no message of the source stands."""
    if reason in _SILENCES and facts.is_heard:
        return Judgement(ConnectionPhase.SILENT, reason.value)
    if reason in (StopReason.START, *_SILENCES) or not (facts.is_heard or facts.forbidden):
        return Judgement(ConnectionPhase.WAITING, StopReason.START.value)
    if facts.forbidden:
        return Judgement(ConnectionPhase.REFUSED, facts.forbidden)
    return Judgement(ConnectionPhase.WAITING, f"no message since the stop: {reason.value}")


INTERVAL = 10.0  # least seconds between two lines about one connection: its state may come and go

PATIENCE = 3.0
"""Seconds after which the log tells for whom a connection waits that has had no message yet."""

_WARNED = (ConnectionPhase.SILENT, ConnectionPhase.FAILED)
"""States that are warned of; of what degrades a connection its counts warn already."""


class StateLog:
    """Remembers what the log was told of a connection."""

    def __init__(self, name: str) -> None:
        """Begins with a connection that waits, of which nothing is told."""
        self._name = name
        self._last_phase = ConnectionPhase.WAITING
        self._next = 0.0
        self._awaited = StopReason.START.value
        self._since = 0.0

    def note(self, judgement: Judgement, now: float) -> None:
        """Tells the log of a change, unless it was told something a moment ago."""
        phase = judgement.phase
        if phase is ConnectionPhase.WAITING and judgement.reason != self._awaited:
            self._awaited, self._since = judgement.reason, now
        is_due = self._since > 0 and now - self._since >= PATIENCE
        if phase is self._last_phase is ConnectionPhase.WAITING and is_due:
            self._since = 0.0
            LOGGER.info("%s is %s: %s", self._name, phase.value, judgement.reason)
        if phase is self._last_phase or now < self._next:
            return
        self._last_phase, self._next = phase, now + INTERVAL
        level = logging.WARNING if phase in _WARNED else logging.INFO
        LOGGER.log(level, "%s is %s: %s", self._name, phase.value, judgement.reason)
