"""A bridge that no file has, which takes values through a map and back, and the code of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.generation import native
from jausml.generation.rendering import render
from jausml.live.workers.worker import bridge_code, bridge_of_maps
from jausml.proving.layout import NOW
from jausml_generators.bridge.target import TARGET as BRIDGE
from jausml_generators.bridge.views import bridge_views
from jausml_generators.cpp.proof import proof_program
from jausml_generators.messages.target import TARGET as MESSAGES

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.language.model import Model
    from jausml.live.workers.worker import BridgeCode
    from jausml.proving.round_trips import RoundTrip

NAME = "proof"
TO_ROS_NAME, TO_JAUS_NAME = "to_ros", "to_jaus"
_CORE = f"{NAME}/{native.SOURCE.parent.as_posix()}/"


@dataclass(frozen=True)
class ProofCode:
    """The code of a map, as `jausml generate` makes it of a bridge, and the program of its proof.

    Attributes:
        directions: Those that are compiled, by whether they make messages of ROS.
        shortcuts: Paths of the numbers that the program sweeps without the rest of the message.
    """

    python: BridgeCode
    core: str
    headers: Mapping[str, str]
    directions: tuple[bool, ...]
    reasons: tuple[str, ...]
    program: str
    shortcuts: tuple[str, ...]


def proof_code(model: Model, trip: RoundTrip) -> ProofCode:
    """Returns the code of a map, with the policies and quantities of the bridge that has it."""
    made = _model(model, trip)
    files = {each.path: each.text for each in render(made, (BRIDGE, MESSAGES))}
    beside = {
        path.removeprefix(_CORE): text for path, text in files.items() if path.startswith(_CORE)
    }
    (view,) = made.made(bridge_views)
    translations, core = view.translations, view.core
    functions = {
        each.name == TO_ROS_NAME: each.compiled
        for each in translations.connections
        if each.compiled is not None
    }
    uses = translations.uses
    settings: dict[str, float | str] = {e.name: e.value for e in uses.quantities.values()}
    settings |= {each.name: each.value for each in uses.frames.values()}
    now = int(NOW.timestamp()), NOW.microsecond * 1000
    program, shortcuts = proof_program(core, functions, settings, now)
    return ProofCode(
        bridge_code(made),
        beside.pop(native.SOURCE.name, ""),
        beside,
        tuple(functions),
        tuple(f"{name}: {reason}" for name, reason in core.left.items()),
        program,
        tuple(shortcuts),
    )


def _model(model: Model, trip: RoundTrip) -> Model:
    """Makes a bridge with each direction, with the policies and quantities of its own."""
    ways = {TO_ROS_NAME: (trip.to_ros, True), TO_JAUS_NAME: (trip.to_jaus, False)}
    connections = {
        name: (used, to_ros)
        for name, (used, to_ros) in ways.items()
        if (used.toRos if to_ros else used.toJaus)
    }
    return bridge_of_maps(model.metamodels, NAME, connections, trip.connections)
