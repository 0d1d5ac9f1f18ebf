"""Requests about recordings: the system at a time, and why messages were dropped."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jausml.authoring.studio.context import StudioContext  # noqa: TC001 - typed at run time
from jausml.authoring.studio.live import live_values
from jausml.authoring.studio.live_places import Places, places_of
from jausml.live.serving.rpc import Method
from jausml.live.systems.explaining import Explanation, explained

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.language.model import Model


def methods(context: StudioContext) -> Mapping[str, Method]:
    """Returns the methods by name."""
    requests = _Requests(context)
    return {
        "recording.files": Method(requests.files),
        "recording.open": Method(requests.open),
        "recording.state": Method(requests.state),
        "recording.why": Method(requests.why),
    }


class _Requests:
    """Requests that show a recording by a model."""

    def __init__(self, context: StudioContext) -> None:
        self._context = context
        self._recordings = context.recordings
        self._places: tuple[Model | None, Places] = (None, Places())
        """The model that was asked for last, and its places."""

    def files(self) -> dict[str, Any]:
        """Returns which recordings there are."""
        return {"files": self._recordings.files(), "given": self._recordings.given}

    def open(self, recording: str) -> dict[str, Any]:
        """Returns how far a recording is read; once it is, what changed in it and when."""
        file = self._recordings.opened(recording)
        system = file.system
        if system is None:
            return {"share": file.share, "fault": file.fault, "read": None}
        read = {
            "duration": system.duration,
            "damage": system.damage,
            "sources": {name: fault for name, fault in system.sources.items() if fault},
            "unreadable": system.unreadable,
            "marks": system.marks,
            "unlisted": system.unlisted,
        }
        return {"share": 1.0, "fault": "", "read": read}

    def state(self, recording: str, file: str, at: float) -> dict[str, Any]:
        """Returns the system at a time as the live view tells it."""
        model, places = self._model(file)
        state = self._recordings.system(recording).state(at, model)
        return {"at": at, "state": live_values(state, places)}

    def why(
        self, recording: str, file: str, bridge: str, connection: str, at: float
    ) -> Explanation:
        """Returns why a connection did not pass on what it dropped last."""
        system = self._recordings.system(recording)
        model, _ = self._model(file)
        return explained(system, model, (bridge, connection), at)

    def _model(self, file: str) -> tuple[Model, Places]:
        model = self._context.project.model(file).model
        known, places = self._places
        if known is not model:
            places = places_of(model)
            self._places = model, places
        return model, places
