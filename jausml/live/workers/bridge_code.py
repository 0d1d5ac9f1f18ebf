"""Bridges for a worker: elements that no file has, and the code that jausml generates of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.generation.artifact import text_digest
from jausml.generation.checks import find_problems
from jausml.generation.errors import GenerationError
from jausml.generation.rendering import render
from jausml.language.metamodel.filling import link, new_object, set_value
from jausml.language.model.model import made_model
from jausml.language.semantics.connections.exchanges import TO_JAUS, TO_ROS
from jausml_generators.bridge.target import TARGET as BRIDGE
from jausml_generators.messages.target import TARGET as MESSAGES

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.language.metamodel import Metamodels
    from jausml.language.metamodel.classes import bridge
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model import Model


@dataclass(frozen=True)
class BridgeCode:
    """The generated code of bridges."""

    files: Mapping[str, str]
    digest: str


def bridge_code(model: Model) -> BridgeCode:
    """Returns the generated code of the bridges of a model, without the runtime."""
    made = render(model, (BRIDGE, MESSAGES))
    problems = find_problems(made)
    if problems:
        raise GenerationError(next(iter(problems.values())))
    files = {
        each.path: each.text
        for each in made
        if each.path.endswith(".py") and each.path.count("/") == 2 and "/test/" not in each.path
    }
    digest = text_digest("\n".join(f"{path}\n{text}" for path, text in sorted(files.items())))
    return BridgeCode(files, digest)


class Maker:
    """Makes elements of metamodels."""

    def __init__(self, metamodels: Metamodels) -> None:
        self._metamodels = metamodels

    def __call__(self, kind: str, **values: str) -> Any:
        """Returns an element of a class with some attributes."""
        table = self._metamodels.classes[kind]
        made = new_object(table)
        for name, value in values.items():
            feature = table.features[name]
            literals = feature.data_type.literals if feature.data_type is not None else {}
            set_value(made, feature, literals.get(value, value))
        return made

    def own(self, owner: EObject, feature: str, element: EObject) -> None:
        """Lets an element own another."""
        link(owner, self._metamodels.class_of(owner).features[feature], element)

    def refer(self, owner: EObject, feature: str, element: EObject) -> None:
        """Lets an element refer to another."""
        self.own(owner, feature, element)


def bridge_of_maps(
    metamodels: Metamodels,
    name: str,
    connections: Mapping[str, tuple[bridge.AttributeMap, bool]],
) -> Model:
    """Makes a system with a bridge that has connections by maps, whatever else their model holds.

    Args:
        connections: Their maps, and whether they go to ROS, by name.
    """
    make = Maker(metamodels)
    owner = make("bridge.Bridge", name=name, address="1.1.1")
    made = []
    for connection, (used, to_ros) in connections.items():
        made.append(_connection(make, used, connection, to_ros=to_ros))
        make.own(owner, "bridgeConnections", made[-1])
    whole = make("system.System", name=f"{name}_system")
    make.own(whole, "bridges", owner)
    return made_model(metamodels, whole, owner, *made)


def _connection(make: Maker, used: bridge.AttributeMap, name: str, *, to_ros: bool) -> EObject:
    made: EObject = make("bridge.Connection", name=name, direction=TO_ROS if to_ros else TO_JAUS)
    make.own(made, "topics", make("bridge.Topic", name=name))
    if to_ros:
        for report in used.reportJoins:
            source = make("bridge.ReportSource")
            make.refer(source, "join", report)
            make.own(made, "sources", source)
    else:
        for join in used.joins:
            topic = make("bridge.Topic", name=str(join.name))
            make.refer(topic, "join", join)
            make.own(made, "topics", topic)
    make.refer(made, "map", used)
    return made
