"""A bridge that no file has, which takes values through a map and back, and the code of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.generation import native
from jausml.generation.rendering import render
from jausml.language.metamodel.classes import bridge
from jausml.live.workers.bridge_code import Maker, bridge_code, bridge_of_maps
from jausml.proving.layout import NOW
from jausml_generators.bridge.target import TARGET as BRIDGE
from jausml_generators.bridge.views import bridge_views
from jausml_generators.cpp.proof import proof_program
from jausml_generators.messages.target import TARGET as MESSAGES

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.language.model import Model
    from jausml.live.workers.bridge_code import BridgeCode

NAME = "proof"
TO_ROS_NAME, TO_JAUS_NAME = "to_ros", "to_jaus"
_CORE = f"{NAME}/{native.SOURCE.parent.as_posix()}/"


@dataclass(frozen=True)
class RoundTrip:
    """The way of values through a map and back, in the directions that there are.

    Attributes:
        to_ros: The map that makes messages of ROS.
        to_jaus: The map that makes JAUS messages: the same one, or that of another connection.
        connections: Those whose policies and quantities count; of several, those of the first.
    """

    name: str
    to_ros: bridge.AttributeMap
    to_jaus: bridge.AttributeMap
    connections: tuple[bridge.Connection, ...] = ()


@dataclass(frozen=True)
class ProofCode:
    """The code of a map, as `jausml generate` makes it of a bridge, and the program of its proof.

    Attributes:
        core: The source of the compiled core.
        headers: What it includes, by name.
        directions: Those that are compiled, by whether they make messages of ROS.
        reasons: Why the others are left to Python.
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
    made = bridge_of_maps(
        model.metamodels,
        NAME,
        {
            name: (used, to_ros)
            for name, (used, to_ros) in ways.items()
            if (used.toRos if to_ros else used.toJaus)
        },
    )
    (owner,) = made.instances(bridge.Bridge)
    for each in reversed(trip.connections):
        for own in owner.bridgeConnections:
            if own.direction is each.direction:
                own.outOfRange = each.outOfRange
    make = Maker(model.metamodels)
    holders = (each.eContainer() for each in trip.connections)
    for known in next((e.quantities for e in holders if isinstance(e, bridge.Bridge)), ()):
        copied = make("bridge.Quantity", name=str(known.name), units=str(known.units or ""))
        copied.value = known.value
        make.own(owner, "quantities", copied)
    return made


def round_trips(model: Model) -> list[RoundTrip]:
    """Returns those of the maps of a model, and of those of the library that its bridges use."""
    maps = model.instances(bridge.AttributeMap)
    own = [each for each in maps if (found := model.document_of(each)) and found.given]
    connections = model.instances(bridge.Connection)
    used = [each.map for each in model.instances(bridge.Connection, library=False)]
    return [
        RoundTrip(str(each.name), each, each, tuple(one for one in connections if one.map is each))
        for each in dict.fromkeys((*own, *used))
        if each is not None
    ]
