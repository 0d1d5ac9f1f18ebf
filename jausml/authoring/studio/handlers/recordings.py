"""Requests about recordings: the system at a time, and why messages were dropped."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from jausml.authoring.studio.context import StudioContext
from jausml.authoring.studio.live import live_values
from jausml.authoring.studio.live_places import places_of
from jausml.live.systems.explaining import Explanation, explained


def _files(context: StudioContext) -> dict[str, Any]:
    """Returns which recordings there are."""
    return {"files": context.recordings.files(), "given": context.recordings.given}


def _open(context: StudioContext, recording: str) -> dict[str, Any]:
    """Returns the share of a recording that has been read, and its contents once all has."""
    file = context.recordings.opened(recording)
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


def _state(context: StudioContext, recording: str, file: str, at: float) -> dict[str, Any]:
    """Returns the state of the system at a time, in the form of the live view."""
    model = context.project.model(file).model
    state = context.recordings.system(recording).state(at, model)
    return {"at": at, "state": live_values(state, model.derived(places_of))}


def _why(
    context: StudioContext, recording: str, file: str, bridge: str, connection: str, at: float
) -> Explanation:
    """Returns the reason why a connection dropped its last message."""
    system = context.recordings.system(recording)
    return explained(system, context.project.model(file).model, (bridge, connection), at)


METHODS: Mapping[str, Callable[..., object]] = {
    "recording.files": _files,
    "recording.open": _open,
    "recording.state": _state,
    "recording.why": _why,
}
"""Handlers of requests, by the names of these."""
