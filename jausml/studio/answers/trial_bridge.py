"""A bridge for one translation: the code that `jausml generate` makes, for values to be tried."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.generation.artifact import text_digest
from jausml.generation.errors import GenerationError
from jausml.generation.paths import find_problems
from jausml.generation.rendering import render
from jausml.generators.bridge.target import TARGET as BRIDGE
from jausml.generators.messages.target import TARGET as MESSAGES
from jausml.metamodel.filling import link, new_object, set_value
from jausml.semantics.ways import TO_JAUS, TO_ROS
from jausml.studio.answers.made_models import made_model

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.metamodel import Metamodels
    from jausml.metamodel.classes import bridge
    from jausml.metamodel.classes.ecore import EObject
    from jausml.model import Model

BRIDGE_NAME, CONNECTION_NAME = "trial", "tried"
_SYSTEM = "trial_system"


@dataclass(frozen=True)
class TrialBridge:
    """The generated code of one translation.

    Attributes:
        files: The Python files by path, relative to the folder of the workspace.
        digest: What tells them from others.
        packages: The folders of the packages.
    """

    files: Mapping[str, str]
    digest: str

    @property
    def packages(self) -> list[str]:
        """The folders that hold packages."""
        return sorted({path.partition("/")[0] for path in self.files})


def trial_bridge(metamodels: Metamodels, used: bridge.AttributeMap, *, to_ros: bool) -> TrialBridge:
    """Returns the generated code of one direction of a map, whatever else its model holds.

    Args:
        metamodels: The metamodels of the map.
        used: The map.
        to_ros: The direction.

    Raises:
        GenerationError: The map has what cannot be generated.
    """
    model = _model(metamodels, used, to_ros=to_ros)
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
    return TrialBridge(files, digest)


def _model(metamodels: Metamodels, used: bridge.AttributeMap, *, to_ros: bool) -> Model:
    """Makes a system with a bridge that has one connection, by the map."""
    make = _Maker(metamodels)
    connection = make(
        "bridge.Connection", name=CONNECTION_NAME, direction=TO_ROS if to_ros else TO_JAUS
    )
    make.own(connection, "topics", make("bridge.Topic", name=CONNECTION_NAME))
    if to_ros:
        for report in used.reportJoins:
            source = make("bridge.ReportSource")
            make.refer(source, "join", report)
            make.own(connection, "sources", source)
    else:
        for join in used.joins:
            topic = make("bridge.Topic", name=str(join.name))
            make.refer(topic, "join", join)
            make.own(connection, "topics", topic)
    make.refer(connection, "map", used)
    owner = make("bridge.Bridge", name=BRIDGE_NAME, address="1.1.1")
    make.own(owner, "bridgeConnections", connection)
    whole = make("system.System", name=_SYSTEM)
    make.own(whole, "bridges", owner)
    return made_model(metamodels, whole, owner, connection)


class _Maker:
    """Makes elements that no file has."""

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
