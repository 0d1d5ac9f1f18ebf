"""Journal of commands with their senders and outcomes, and alarms until a person silences them."""

from __future__ import annotations

import logging
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from threading import Lock
from typing import Any

_LOG = logging.getLogger("jausml.operating")
_MOST = 2000
_MOST_ALARMS = 200


@dataclass(frozen=True)
class JournalEntry:
    """An act of a person or an event (`time`: seconds since 1970)."""

    number: int
    time: float
    who: str
    text: str


@dataclass
class Alarm:
    """An event that sounds on all pages until it is silenced.

    Attributes:
        time: Seconds since 1970.
        cause: The name of its cause, by which pages group alarms.
        subject: The connection or component; while an alarm sounds, it is not raised again with the
            same subject and text.
        back: Time at which the subject worked again; 0 before.
        silenced: The person who silenced it and the reason; empty while it sounds.
    """

    number: int
    time: float
    cause: str
    subject: str
    text: str
    back: float = 0.0
    silenced: str = ""


class Journal:
    """The latest entries and alarms; any thread may call it."""

    def __init__(self, notify: Callable[[str, object], None]) -> None:
        """Creates an empty journal (`notify`: sends a notification with its parameters)."""
        self._notify = notify
        self._entries: deque[JournalEntry] = deque(maxlen=_MOST)
        self._alarms: dict[int, Alarm] = {}
        self._count = 0
        self._lock = Lock()

    @property
    def entries(self) -> list[dict[str, Any]]:
        """The entries as JSON values, the latest last."""
        with self._lock:
            return [asdict(entry) for entry in self._entries]

    @property
    def alarms(self) -> list[dict[str, Any]]:
        """The alarms that sound as JSON values, the latest first."""
        with self._lock:
            alarms = reversed(self._alarms.values())
            return [asdict(alarm) for alarm in alarms if not alarm.silenced]

    def note(self, who: str, text: str) -> None:
        """Adds an entry, also to the log of the process (`who`: a person, a component, `unit`)."""
        with self._lock:
            entry = self._entry(who, text)
        _LOG.info("%s: %s", who, text)
        self._notify("operate.journal", {"entry": asdict(entry)})

    def alarm(self, cause: str, text: str, subject: str = "") -> None:
        """Raises an alarm, unless it sounds already (`subject`: by default the cause)."""
        about = subject or cause
        with self._lock:
            for alarm in self._alarms.values():
                is_same = (alarm.subject, alarm.text) == (about, text)
                if is_same and not alarm.silenced and not alarm.back:
                    return
            self._count += 1
            self._alarms[self._count] = Alarm(self._count, time.time(), cause, about, text)
            if len(self._alarms) > _MOST_ALARMS:
                # One that sounds is kept longer than any that somebody has silenced.
                del self._alarms[
                    min(
                        self._alarms, key=lambda number: (not self._alarms[number].silenced, number)
                    )
                ]
        self.note("alarm", f"{about}: {text}")

    def returned(self, subject: str) -> None:
        """Marks the alarms of a subject that works again; they still sound."""
        with self._lock:
            alarms = self._alarms.values()
            lost = [alarm for alarm in alarms if alarm.subject == subject and not alarm.back]
            for alarm in lost:
                alarm.back = time.time()
        if lost:
            self.note("unit", f"{subject} is back")

    def silence(self, numbers: Sequence[int], who: str, reason: str) -> bool:
        """Silences alarms by their numbers; returns False when none of them sounds."""
        with self._lock:
            known = (self._alarms.get(number) for number in numbers)
            alarms = [alarm for alarm in known if alarm is not None and not alarm.silenced]
            for alarm in alarms:
                alarm.silenced = f"{who}: {reason}"
        for alarm in alarms:
            text = f"silenced the alarm {alarm.subject}: {alarm.text!r}, because {reason!r}"
            self.note(who, text)
        return bool(alarms)

    def _entry(self, who: str, text: str) -> JournalEntry:
        number = self._entries[-1].number + 1 if self._entries else 1
        entry = JournalEntry(number, time.time(), who, text)
        self._entries.append(entry)
        return entry
