"""Rule about installed interfaces: ROS types of a model are those that are there."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

from jausml.language.interfaces import Installation
from jausml.language.metamodel.classes import bridge, ros
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.ros_types import (
    InterfaceType,
    installed_differences,
    package_of,
    parts_of,
)
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, rule

User: TypeAlias = "ros.TopicEndpoint | ros.ServiceEndpoint | bridge.AttributeMap | bridge.Join"
Use: TypeAlias = "tuple[EObject, str | None]"


@rule("JML409", "ROS type that is installed with other fields", severity=Severity.WARNING)
def installed_types(subject: Subject) -> Iterator[Finding]:
    """The ROS types that a model uses are those of the installed packages.

    Generated code relies on the fields of the model: with other fields, a topic is not connected,
    or a message cannot be read. The rule reads the definition files of packages in the share
    folders of AMENT_PREFIX_PATH or of the running Python, and ignores types of packages that are
    not installed. Defaults may differ.

    Bad: a model of winch_msgs/Winch with a field speed, which winch_msgs has renamed to rope_speed

    Good: the same model after `jausml import ros winch_msgs --force`
    """
    installation = Installation()
    for kind, (element, feature) in _uses(subject).items():
        for difference in installed_differences(kind, installation):
            message = f"{package_of(kind)}/{kind.name} is not as installed: {difference.message}"
            if subject.model.is_library(kind):
                hint = "import the installed package (jausml import ros) and refer to its types"
                yield Finding(element, message, feature, hint)
            else:
                yield Finding(difference.element, message)


def _uses(subject: Subject) -> dict[InterfaceType, Use]:
    """Returns the types that a model declares or uses, each with the first use."""
    uses: dict[InterfaceType, Use] = {}
    types: tuple[type[InterfaceType], ...] = (ros.MessageType, ros.ServiceType, ros.ActionType)
    for own in (interface for kind in types for interface in subject.instances(kind)):
        if isinstance(own.eContainer(), ros.InterfacePackage):
            uses[own] = (own, None)
    users: tuple[type[User], ...] = (
        *(ros.TopicEndpoint, ros.ServiceEndpoint, bridge.AttributeMap, bridge.Join),
    )
    pending: list[tuple[InterfaceType | None, Use]] = [
        (user.type, (user, "type")) for kind in users for user in subject.instances(kind)
    ]
    pending += [(kind, use) for own, use in uses.items() for kind in _held(own)]
    for kind, use in pending:
        if kind is not None and kind not in uses and kind.eContainer() is not None:
            uses[kind] = use
            pending += [(message_type, use) for message_type in _held(kind)]
    return uses


def _held(kind: InterfaceType) -> list[ros.MessageType]:
    """Returns the types of the fields of a type."""
    fields = [
        field for message in parts_of(kind) if message is not None for field in message.fields
    ]
    return [field.messageType for field in fields if isinstance(field, ros.MessageField)]
