"""What was commanded, by whom, and what came of it; and alarms, until somebody says why not."""

from __future__ import annotations

import logging
import time
from collections import deque
from dataclasses import asdict, dataclass
from threading import Lock
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

_LOG = logging.getLogger("jausml.operating")
_MOST = 2000
_MOST_ALARMS = 200


@dataclass(frozen=True)
class JournalEntry:
    """Something that was done, or happened (`time`: seconds since 1970)."""

    number: int
    time: float
    who: str
    text: str


@dataclass
class Alarm:
    """Something that nobody should overlook (`silenced`: by whom and why; empty while it is not).

    `subject` tells what it is about: an alarm about the same that sounds is not raised again.
    """

    number: int
    time: float
    subject: str
    text: str
    silenced: str = ""


class Journal:
    """The latest entries and alarms; any thread may add."""

    def __init__(self, notify: Callable[[str, object], None]) -> None:
        """Has none (`notify`: takes the name of a notification and its parameters)."""
        self._notify = notify
        self._entries: deque[JournalEntry] = deque(maxlen=_MOST)
        self._alarms: dict[int, Alarm] = {}
        self._count = 0
        self._lock = Lock()

    @property
    def entries(self) -> list[dict[str, Any]]:
        """The entries, the latest last."""
        with self._lock:
            return [asdict(entry) for entry in self._entries]

    @property
    def alarms(self) -> list[dict[str, Any]]:
        """The alarms, the latest last."""
        with self._lock:
            return [asdict(alarm) for alarm in self._alarms.values()]

    def note(self, who: str, text: str) -> None:
        """Adds an entry; the log of the process has it too."""
        with self._lock:
            entry = self._entry(who, text)
        _LOG.info("%s: %s", who, text)
        self._notify("operate.journal", {"entry": asdict(entry)})

    def alarm(self, subject: str, text: str) -> None:
        """Raises an alarm."""
        with self._lock:
            sounding = (alarm for alarm in self._alarms.values() if not alarm.silenced)
            if any((alarm.subject, alarm.text) == (subject, text) for alarm in sounding):
                return
            self._count += 1
            self._alarms[self._count] = Alarm(self._count, time.time(), subject, text)
            while len(self._alarms) > _MOST_ALARMS:
                del self._alarms[min(self._alarms)]
        self.note("alarm", f"{subject}: {text}")

    def silence(self, number: int, who: str, reason: str) -> bool:
        """Silences an alarm; False when there is none that sounds."""
        with self._lock:
            alarm = self._alarms.get(number)
            if alarm is None or alarm.silenced:
                return False
            alarm.silenced = f"{who}: {reason}"
            text = f"silenced the alarm {alarm.subject}: {alarm.text!a}, because {reason!a}"
        self.note(who, text)
        return True

    def _entry(self, who: str, text: str) -> JournalEntry:
        number = self._entries[-1].number + 1 if self._entries else 1
        entry = JournalEntry(number, time.time(), who, text)
        self._entries.append(entry)
        return entry
