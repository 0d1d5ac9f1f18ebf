"""Ready maps: those of the project and the library between a message and a type."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.metamodel.classes import bridge, jaus
from jausml.proposals.elements import library
from jausml.semantics.layouts import signature
from jausml.semantics.ros_paths import ros_name
from jausml.semantics.services import code

if TYPE_CHECKING:
    from jausml.metamodel.classes import ros
    from jausml.proposals.elements import Scope


def maps_of(scope: Scope) -> list[bridge.AttributeMap]:
    """Returns the maps of the project, then those of the library."""
    own = scope.model.instances(bridge.AttributeMap, library=False)
    return [*own, *library().instances(bridge.AttributeMap)]


def fitting(
    scope: Scope,
    message: jaus.MessageDef,
    kind: ros.MessageType | None,
    *,
    to_ros: bool,
) -> list[bridge.AttributeMap]:
    """Returns the maps between a message and a type that have assignments for a direction.

    Args:
        scope: The model.
        message: The JAUS message.
        kind: The ROS type, None for any.
        to_ros: The direction.
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
