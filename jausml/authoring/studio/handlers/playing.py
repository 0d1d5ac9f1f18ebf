"""Requests about recordings: the system at a time, why messages were dropped, two compared."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.studio.context import StudioContext  # noqa: TC001 - typed at run time
from jausml.authoring.studio.live import live_values
from jausml.authoring.studio.live_places import Places, places_of
from jausml.authoring.studio.operating.values import decimated
from jausml.authoring.studio.recordings import Recordings  # noqa: TC001 - typed at run time
from jausml.authoring.studio.rpc import Method
from jausml.live.recording.mcap_files import RecordingError
from jausml.live.recording.ros_values import numbers_in
from jausml.live.systems.explaining import explained
from jausml.live.systems.tables import state_text

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from jausml.language.model import Model
    from jausml.live.systems.playback import Mark, RecordedSystem
    from jausml.live.systems.state import ConnectionState, SystemState

MOST_VALUES = 50_000
"""Messages of which one number is plotted."""

MOST_POINTS = 4_000
"""Points that a page is given of a number."""

RATE_DIFFERENCE = 0.1
"""Share by which two rates must differ to be told as different."""


def methods(context: StudioContext) -> Mapping[str, Method]:
    """Returns the methods by name."""
    requests = _Requests(context)
    return {
        "recording.files": Method(requests.files),
        "recording.open": Method(requests.open),
        "recording.state": Method(requests.state),
        "recording.why": Method(requests.why),
        "recording.compare": Method(requests.compare),
        "recording.numbers": Method(partial(_numbers, context.recordings)),
        "recording.series": Method(partial(_series, context.recordings)),
    }


class _Requests:
    """Requests that show a recording by a model."""

    def __init__(self, context: StudioContext) -> None:
        self._context = context
        self._recordings = context.recordings
        self._places: tuple[Model | None, Places] = (None, Places())

    def files(self) -> dict[str, Any]:
        """Returns which recordings there are."""
        return {"files": self._recordings.files(), "given": self._recordings.given}

    def open(self, recording: str) -> dict[str, Any]:
        """Returns how far a recording is read; once it is, what changed in it and when."""
        found = self._recordings.opened(recording)
        system = found.system
        if system is None:
            return {"share": found.share, "fault": found.fault, "read": None}
        read = {
            "duration": system.recording.duration,
            "damage": system.recording.fault,
            "sources": {name: fault for name, fault in system.sources.items() if fault},
            "unreadable": system.unreadable,
            "marks": [_mark(each) for each in system.marks],
            "unlisted": system.unlisted,
            "topics": system.recording.topics,
        }
        return {"share": 1.0, "fault": "", "read": read}

    def state(self, recording: str, file: str, at: float) -> dict[str, Any]:
        """Returns the system at a time as the live view tells it."""
        model, places = self._model(file)
        state = self._recordings.system(recording).state(at, model)
        return {"at": at, "state": live_values(state, places)}

    def why(
        self, recording: str, file: str, bridge: str, connection: str, at: float
    ) -> dict[str, Any]:
        """Returns why a connection did not pass on what it dropped last."""
        system, (model, _) = self._recordings.system(recording), self._model(file)
        try:
            found = explained(system, model, (bridge, connection), at)
        except RecordingError as error:
            raise AnswerError(str(error)) from error
        return {
            "at": found.at,
            "counter": found.counter,
            "state": found.state,
            "ros": "\n".join(found.ros),
            "jaus": "\n".join(found.jaus),
        }

    def compare(
        self, file: str, recording: str, at: float, other: str, other_at: float
    ) -> dict[str, Any]:
        """Returns the connections of two recordings side by side, each at its time."""
        model, _ = self._model(file)
        sides = [
            self._recordings.system(name).state(time, model)
            for name, time in ((recording, at), (other, other_at))
        ]
        keys = dict.fromkeys(key for side in sides for key in side.connections)
        return {"rows": [_compared(key, *sides) for key in keys]}

    def _model(self, file: str) -> tuple[Model, Places]:
        model = self._context.project.model(file).model
        known, places = self._places
        if known is not model:
            places = places_of(model)
            self._places = model, places
        return model, places


def _mark(mark: Mark) -> dict[str, Any]:
    bridge, connection = mark.subject
    return {
        "kind": mark.kind,
        "since": mark.since,
        "time": mark.time,
        "bridge": bridge,
        "connection": connection,
        "counter": mark.counter,
        "before": mark.before,
        "after": mark.after,
    }


def _compared(key: tuple[str, str], first: SystemState, second: SystemState) -> dict[str, Any]:
    sides = [_side(each.connections.get(key)) for each in (first, second)]
    differing = [
        name for name in ("rate", "drops", "state") if _differs(*(each[name] for each in sides))
    ]
    return {"bridge": key[0], "connection": key[1], "sides": sides, "differing": differing}


def _side(connection: ConnectionState | None) -> dict[str, Any]:
    if connection is None:
        return {"rate": None, "drops": None, "state": "not there"}
    dropped = connection.dropped if connection.told is not None else None
    return {"rate": connection.rate, "drops": dropped, "state": state_text(connection)}


def _differs(first: Any, second: Any) -> bool:
    if isinstance(first, float) and isinstance(second, float):
        return abs(first - second) > RATE_DIFFERENCE * max(first, second)
    return bool(first != second)


def _numbers(recordings: Recordings, recording: str, topic: str) -> dict[str, Any]:
    """Returns the paths of the numbers in the last message of a topic."""
    system = recordings.system(recording)
    try:
        last = system.recording.last(topic, system.recording.duration)
        value = system.recording.value_of(last[1]) if last is not None else {}
    except RecordingError as error:
        raise AnswerError(str(error)) from error
    return {"paths": list(numbers_in(_fields(value)))}


def _series(
    recordings: Recordings,
    recording: str,
    topic: str,
    path: str,
    start: float,
    end: float,
    points: int,
) -> dict[str, Any]:
    """Returns a number of a topic over time, with the peaks of what is left out."""
    system = recordings.system(recording)
    try:
        found = list(_points(system, topic, path, start, end))
    except RecordingError as error:
        raise AnswerError(str(error)) from error
    kept = decimated(found, max(2, min(points, MOST_POINTS)))
    return {"times": [time for time, _ in kept], "values": [value for _, value in kept]}


def _points(
    system: RecordedSystem, topic: str, path: str, start: float, end: float
) -> Iterator[tuple[float, float]]:
    for number, (time, each) in enumerate(system.recording.between(topic, start, end)):
        if number == MOST_VALUES:
            raise AnswerError(
                f"{topic} has more than {MOST_VALUES} messages there; choose a shorter span"
            )
        value = numbers_in(_fields(system.recording.value_of(each))).get(path)
        if value is not None:
            yield time, value


def _fields(value: dict[str, Any]) -> dict[str, Any]:
    """Returns the fields of a message; those of JAUS stand below their header."""
    fields = value.get("fields")
    return fields if isinstance(fields, dict) and "payload" in value else value
