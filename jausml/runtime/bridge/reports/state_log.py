"""Tells the log when the state of a connection is another one."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from ...base.counters import LOGGER
from .states import ConnectionPhase

if TYPE_CHECKING:
    from .states import Judgement

INTERVAL = 10.0
"""Least seconds between two lines about one connection: its state may come and go."""

_WARNED = (ConnectionPhase.SILENT, ConnectionPhase.FAILED)
"""States that are warned of; of what degrades a connection its counts warn already."""


class StateLog:
    """Remembers what the log was told of a connection."""

    def __init__(self, name: str) -> None:
        """Begins with a connection that waits, of which nothing is told."""
        self._name = name
        self._told = ConnectionPhase.WAITING
        self._next = 0.0

    def note(self, judgement: Judgement, now: float) -> None:
        """Tells the log of a change, unless it was told something a moment ago."""
        phase = judgement.phase
        if phase is self._told or now < self._next:
            return
        self._told, self._next = phase, now + INTERVAL
        level = logging.WARNING if phase in _WARNED else logging.INFO
        LOGGER.log(level, "%s is %s: %s", self._name, phase.value, judgement.reason)
