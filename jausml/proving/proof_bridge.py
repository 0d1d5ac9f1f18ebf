"""A bridge that no file has, with one map in each direction that it has, and the code of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.generation import native
from jausml.generation.rendering import render
from jausml.language.metamodel.classes import bridge
from jausml.live.workers.bridge_code import Maker, bridge_code, bridge_of_map
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


def proof_code(model: Model, used: bridge.AttributeMap) -> ProofCode:
    """Returns the code of a map, with the policies and quantities of the bridge that has it."""
    made = _model(model, used)
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


def _model(model: Model, used: bridge.AttributeMap) -> Model:
    """Makes a bridge with each direction of a map, with the policies and quantities of its own."""
    ways = ((TO_ROS_NAME, True, used.toRos), (TO_JAUS_NAME, False, used.toJaus))
    names = {name: to_ros for name, to_ros, assignments in ways if assignments}
    made = bridge_of_map(model.metamodels, used, NAME, names)
    (owner,) = made.instances(bridge.Bridge)
    connections = [each for each in model.instances(bridge.Connection) if each.map is used]
    for each in connections[::-1]:
        for own in owner.bridgeConnections:
            if own.direction is each.direction:
                own.outOfRange = each.outOfRange
    make = Maker(model.metamodels)
    holders = (each.eContainer() for each in connections)
    for known in next((e.quantities for e in holders if isinstance(e, bridge.Bridge)), ()):
        copied = make("bridge.Quantity", name=str(known.name), units=str(known.units or ""))
        copied.value = known.value
        make.own(owner, "quantities", copied)
    return made


def maps_of(model: Model) -> list[bridge.AttributeMap]:
    """Returns the maps of a model, and those of the library that its bridges use."""
    maps = model.instances(bridge.AttributeMap)
    own = [each for each in maps if (found := model.document_of(each)) and found.given]
    used = [each.map for each in model.instances(bridge.Connection, library=False)]
    return [each for each in dict.fromkeys((*own, *used)) if each is not None]
