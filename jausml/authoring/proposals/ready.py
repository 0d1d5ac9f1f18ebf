"""Ready maps: those of the project and the library between a message and a type."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import Add
from jausml.authoring.editing.describing import described
from jausml.authoring.proposals.elements import library
from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.model.names import name_of
from jausml.language.semantics.layouts import signature
from jausml.language.semantics.ros_paths import ros_name
from jausml.language.semantics.services import code

if TYPE_CHECKING:
    from jausml.authoring.editing.commands import Command
    from jausml.authoring.proposals.elements import Scope
    from jausml.language.metamodel.classes import ros


def maps_of(scope: Scope) -> list[bridge.AttributeMap]:
    """Returns the maps of the project, then those of the library."""
    own = scope.model.instances(bridge.AttributeMap, library=False)
    return [*own, *library().instances(bridge.AttributeMap)]


def between(
    scope: Scope, message: jaus.MessageDef, kind: ros.MessageType
) -> list[bridge.AttributeMap]:
    """Returns the maps between a message and a type, whatever their directions.

    One of the library gives way to one of its name in the project, which is mostly a copy.
    """
    ways = (fitting(scope, message, kind, to_ros=way) for way in (True, False))
    found = dict.fromkeys(each for way in ways for each in way)
    by_name: dict[str, bridge.AttributeMap] = {}
    for each in maps_of(scope):
        if each in found:
            by_name.setdefault(name_of(each), each)
    return list(by_name.values())


def copied(
    scope: Scope, owner: bridge.Bridge, used: bridge.AttributeMap, name: str
) -> list[Command]:
    """Returns what makes a copy of a map, with its tables, quantities and vectors."""
    described_map = described([(used, scope.model_of(used))], lambda each, _: scope.ref(each))
    place = scope.ref(owner)
    return [
        replace(each, owner=place, feature="maps", values={**each.values, "name": (name,)})
        if isinstance(each, Add) and not each.owner
        else each
        for each in described_map
    ]


def fitting(
    scope: Scope,
    message: jaus.MessageDef,
    kind: ros.MessageType | None,
    *,
    to_ros: bool,
) -> list[bridge.AttributeMap]:
    """Returns the maps between a message and a type that have assignments for a direction.

    Args:
        kind: The ROS type, None for any.
    """
    return [
        each
        for each in maps_of(scope)
        if each.message is not None
        and each.type is not None
        and (each.toRos if to_ros else each.toJaus)
        and code(each.message) == code(message)
        and signature(each.message) == signature(message)
        and (kind is None or ros_name(each.type) == ros_name(kind))
    ]
