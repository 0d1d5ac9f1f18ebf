"""Rules about names that become code (generator readiness)."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from jausml.language.attributes.guards import GuardError, conditions, parse_guard
from jausml.language.metamodel.classes import bridge, jaus, ros, system
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.jaus.inherited_machines import DEEPEST, too_deep
from jausml.language.semantics.jaus.machines import behaviours
from jausml.language.semantics.jaus.services import with_inherited
from jausml.language.semantics.names import DEVICES, is_identifier, package_key, snake_case, taken
from jausml.language.validation.rule import Finding, Note, rule

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.semantics.jaus.machines import Behaviour
    from jausml.language.semantics.subject import Subject

    Named = jaus.NamedElement | ros.NamedElement | bridge.NamedElement | system.NamedElement

_LETTER = re.compile("[A-Za-z]")


@rule("JML501", Severity.ERROR, "name is no identifier")
def identifiers(subject: Subject) -> Iterator[Finding]:
    """Names of elements that become names in code are of letters, digits and underscores.

    They start with a letter. Those that become names of files are not names of devices on Windows
    (con, nul). Names of message fields are converted and may be any text that has a letter.

    Bad: `<bridgeConnections name="tyre angle">`

    Good: `<bridgeConnections name="tyre_angle">`
    """
    kinds: tuple[type[Named], ...] = (
        *(jaus.Component, jaus.ServiceSet, jaus.Service, jaus.MessageDef, jaus.InternalEvent),
        *(jaus.StateMachine, jaus.ServiceConnection),
        *(ros.TopicEndpoint, ros.ServiceEndpoint, ros.Parameter, ros.Node),
        *(bridge.AttributeMap, bridge.Connection),
        *(bridge.RosServiceConnection, bridge.RosActionConnection),
        *(system.System, system.Host),
    )
    files = (jaus.Component, jaus.Service, ros.Node, system.System)
    for element in (each for kind in kinds for each in subject.instances(kind, needs=("name",))):
        name = element.name
        if name is not None and not is_identifier(name):
            noun = element.eClass.name
            hint = "letters, digits and underscores, with a letter first"
            yield Finding(element, f"{noun} name {name!a} is no identifier", "name", hint)
        elif isinstance(element, files) and snake_case(name or "") in DEVICES:
            message = f"{element.eClass.name} name '{name}' is a device name on Windows"
            yield Finding(element, message, "name", "files would have that name")
    fields: tuple[type[Named], ...] = (jaus.Field, jaus.SubField)
    for field in (each for kind in fields for each in subject.instances(kind, needs=("name",))):
        name = field.name
        if name is not None and not _LETTER.search(name):
            message = f"field name {name!a} has no letter to make a name in code of"
            yield Finding(field, message, "name")


@rule("JML502", Severity.ERROR, "name of an interface package is taken")
def interface_names(subject: Subject) -> Iterator[Finding]:
    """Interface packages of a system hide no module that generated code imports.

    Their names are those of Python packages and cannot be changed in generated code. Names of
    components, bridges and nodes can: the package of a node named json is json_jaus.

    Bad: `<interfaces name="json">`

    Good: `<interfaces name="robot_interfaces">`
    """
    for package in subject.instances(ros.InterfacePackage, needs=("name",)):
        reason = taken(package.name or "")
        if reason and not subject.model.is_library(package):
            yield Finding(package, f"interface package name '{package.name}' {reason}", "name")


@rule("JML503", Severity.ERROR, "packages of one name")
def package_collisions(subject: Subject) -> Iterator[Finding]:
    """The packages of a system have different names, regardless of upper and lower case.

    There is one for each component, bridge and node, and those named <system>_bringup and
    <system>_messages; their names are the names in the model in snake case. The interface packages
    that the model uses are packages too.

    Bad: a component named Vehicle and a node named vehicle

    Good: vehicle and vehicle_display
    """
    for whole in subject.instances(system.System, needs=("components", "bridges", "nodes")):
        interfaces = subject.model.instances(ros.InterfacePackage)
        holders: dict[str, Named] = {
            package_key(each.name): each for each in interfaces if each.name
        }
        if whole.name:
            for ending in ("bringup", "messages"):
                holders.setdefault(package_key(f"{whole.name}_{ending}"), whole)
        elements: list[Named] = [*whole.components, *whole.bridges, *whole.nodes]
        for element in elements:
            if not element.name or not is_identifier(element.name):
                continue
            first = holders.setdefault(package_key(element.name), element)
            if first is not element:
                message = f"{element.eClass.name} '{element.name}' has the package name of"
                yield Finding(
                    element,
                    f"{message} {first.eClass.name} '{first.name}'",
                    "name",
                    related=(Note(first, f"'{first.name}'", "name"),),
                )


@rule("JML504", Severity.ERROR, "siblings of one name")
def sibling_names(subject: Subject) -> Iterator[Finding]:
    """Elements that lie side by side have names that differ in code as well.

    VelocityX and velocity_x become the same attribute.

    Bad: two connections of a bridge, both named pose

    Good: vehicle_pose and estimated_pose
    """
    for siblings in _siblings(subject):
        holders: dict[str, Named] = {}
        for element in siblings:
            in_code = snake_case(element.name or "")
            if not in_code:
                continue
            first = holders.setdefault(in_code, element)
            if first is not element:
                message = f"{element.eClass.name} '{element.name}' has the name of another one"
                if first.name != element.name:
                    message += f" in code, '{first.name}'"
                note = Note(first, f"'{first.name}'", "name")
                yield Finding(element, message, "name", related=(note,))


@rule("JML505", Severity.ERROR, "messages of one name in one process")
def message_names(subject: Subject) -> Iterator[Finding]:
    """Messages that meet in a process have different names, or are the same message.

    Each becomes a class in the package of the component.

    Bad: a component that provides two services with a message QueryStatus of different codes

    Good: QueryDriveStatus and QueryLampStatus
    """
    for component in subject.instances(jaus.Component):
        holders: dict[str, jaus.MessageDef] = {}
        services = with_inherited((*component.provides, *component.uses))
        messages = sorted(
            (m for each in services for m in (*each.inputs, *each.outputs) if m.name and m.code),
            key=lambda m: (m.name, m.code),
        )
        for message in messages:
            first = holders.setdefault(snake_case(message.name), message)
            if first.code.lower() != message.code.lower():
                text = f"'{component.name}' has two messages named {message.name}"
                text += f", of codes {first.code} and {message.code}"
                notes = tuple(Note(m, subject.path(m), "name") for m in (first, message))
                yield Finding(component, text, related=notes)


@rule("JML506", Severity.ERROR, "names in a state machine that no code can have")
def machine_names(subject: Subject) -> Iterator[Finding]:
    """States, actions and guards have names of letters, digits and underscores, joined by dots.

    Actions and guards become methods of one class: what differs in the model differs in code. An
    action may stand in many places under one name; it is the same action everywhere. States lie
    at most 20 deep.

    Bad: an action setSpeed and another one set_speed

    Good: setSpeed in both places
    """
    for state in subject.instances(jaus.State, needs=("name",)):
        yield from _dotted(state, "state")
    for action in subject.instances(jaus.Action, needs=("name",)):
        yield from _dotted(action, "action")
    for machine in subject.instances(jaus.StateMachine):
        for state in too_deep(machine):
            yield Finding(state, f"a state lies more than {DEEPEST} states deep", "name")
    for behaviour in behaviours(subject):
        holders: dict[str, tuple[str, EObject, str]] = {}
        for kind, name, element, feature in _methods(behaviour):
            first_kind, first, written = holders.setdefault(snake_case(name), (kind, element, name))
            if (first_kind, written) != (kind, name):
                text = f"{kind} '{name}' has the name of the {first_kind} '{written}' in code"
                note = Note(first, f"{first_kind} '{written}'")
                yield Finding(element, text, feature, related=(note,))


def _dotted(element: jaus.State | jaus.Action, noun: str) -> Iterator[Finding]:
    name = element.name
    if name is not None and not all(is_identifier(part) for part in name.split(".")):
        hint = "letters, digits and underscores, with a letter first, joined by dots"
        yield Finding(element, f"{noun} name {name!a} is no identifier", "name", hint)


def _methods(behaviour: Behaviour) -> Iterator[tuple[str, str, EObject, str]]:
    """Yields the methods that a machine needs: kind, name, element and its feature."""
    for _, transition in behaviour.transitions():
        try:
            names = list(conditions(parse_guard(transition.guard)))
        except GuardError:
            continue
        for name in names:
            yield "guard", name, transition, "guard"
    for action in behaviour.actions():
        if action.name and action.sends is None:
            yield "action", action.name.rpartition(".")[2], action, "name"


def _siblings(subject: Subject) -> Iterator[Sequence[Named]]:
    """Yields elements that become names in one scope of the code."""
    yield from (each.fields for each in subject.instances(jaus.Record))
    yield from (each.fields for each in subject.instances(jaus.Sequence))
    yield from (each.subFields for each in subject.instances(jaus.BitField))
    for service_set in subject.instances(jaus.ServiceSet, needs=()):
        yield from (service_set.services, service_set.types)
    for service in subject.instances(jaus.Service, needs=()):
        yield from (service.inputs, service.outputs, service.events, service.machines)
    yield from (each.states for each in subject.instances(jaus.StateMachine))
    yield from (each.states for each in subject.instances(jaus.State))
    yield from (each.connections for each in subject.instances(jaus.Component, needs=()))
    for owner in subject.instances(bridge.Bridge, needs=()):
        yield owner.maps
        yield [*owner.bridgeConnections, *owner.serviceConnections, *owner.actionConnections]
    for node in subject.instances(ros.Node, needs=()):
        yield [*node.publishers, *node.serviceClients]
        yield [*node.subscriptions, *node.serviceServers]
        yield node.parameters
    yield from (each.messages for each in subject.instances(ros.InterfacePackage, needs=()))
    for message_type in subject.instances(ros.MessageType, needs=()):
        yield from (message_type.fields, message_type.constants)
    yield from (each.hosts for each in subject.instances(system.System, needs=()))
