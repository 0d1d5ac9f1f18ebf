"""Rules about names that become code (generator readiness)."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import TypeAlias

from jausml.language.attributes.guards import GuardError, conditions, parse_guard
from jausml.language.interfaces.definitions import RESERVED
from jausml.language.metamodel.classes import bridge, jaus, ros, system
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.semantics.jaus.inheritance import with_inherited
from jausml.language.semantics.jaus.inherited_machines import DEEPEST, too_deep
from jausml.language.semantics.jaus.machines import Behaviour, behaviours_of
from jausml.language.semantics.names import DEVICES, is_identifier, package_key, snake_case, taken
from jausml.language.semantics.paths.scopes import carriers_of
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, Note, rule

Inner: TypeAlias = "jaus.Record | jaus.Sequence | jaus.BitField | jaus.StateMachine | jaus.State"
Named: TypeAlias = (
    "jaus.NamedElement | ros.NamedElement | bridge.NamedElement | system.NamedElement"
)

_LETTER = re.compile("[A-Za-z]")

_NAMED = (
    *(jaus.Component, jaus.ServiceSet, jaus.Service, jaus.MessageDef, jaus.InternalEvent),
    *(jaus.StateMachine, jaus.ServiceConnection),
    *(ros.TopicEndpoint, ros.ServiceEndpoint, ros.Parameter, ros.Node),
    *(bridge.AttributeMap, bridge.Connection),
    *(bridge.RosServiceConnection, bridge.RosActionConnection),
    *(system.System, system.Host),
)


@rule("JML501", "name is no identifier", kinds=_NAMED, needs=("name",))
def identifiers(_: Subject, element: Named) -> Iterator[Finding]:
    """Names of elements that become names in code are of letters, digits and underscores.

    They start with a letter. Those that become names of files are not names of devices on Windows
    (con, nul). Names of message fields are converted and may be any text that has a letter.

    Bad: `<bridgeConnections name="tyre angle">`

    Good: `<bridgeConnections name="tyre_angle">`
    """
    files = (jaus.Component, jaus.Service, ros.Node, system.System)
    name = element.name
    if name is not None and not is_identifier(name):
        noun = element.eClass.name
        hint = "letters, digits and underscores, with a letter first"
        yield Finding(element, f"{noun} name {name!r} is no identifier", "name", hint)
    elif isinstance(element, files) and snake_case(name or "") in DEVICES:
        message = f"{element.eClass.name} name '{name}' is a device name on Windows"
        yield Finding(element, message, "name", "files would have that name")


@identifiers.also((jaus.Field, jaus.SubField), needs=("name",))
def _field_names(_: Subject, field: jaus.Field | jaus.SubField) -> Iterator[Finding]:
    name = field.name
    if name is not None and not _LETTER.search(name):
        message = f"field name {name!r} has no letter to make a name in code of"
        yield Finding(field, message, "name")


@rule(
    "JML502", "name of an interface package is taken", kinds=ros.InterfacePackage, needs=("name",)
)
def interface_names(subject: Subject, package: ros.InterfacePackage) -> Iterator[Finding]:
    """Interface packages of a system hide no module that generated code imports.

    Their names are those of Python packages and of namespaces of C++, and cannot be changed in
    generated code. Names of
    components, bridges and nodes can: the package of a node named json is json_jaus.

    Bad: `<interfaces name="json">`

    Good: `<interfaces name="robot_interfaces">`
    """
    reason = taken(package.name or "")
    if not reason and package.name in RESERVED:
        reason = "is a word of C++, which its namespace cannot have"
    if reason and not subject.model.is_library(package):
        yield Finding(package, f"interface package name '{package.name}' {reason}", "name")


@rule(
    "JML503", "packages of one name", kinds=system.System, needs=("components", "bridges", "nodes")
)
def package_collisions(subject: Subject, whole: system.System) -> Iterator[Finding]:
    """The packages of a system have different names, regardless of upper and lower case.

    There is one for each component, bridge and node, and those named <system>_bringup and
    <system>_messages; their names are the names in the model in snake case. The interface packages
    that the model uses are packages too.

    Bad: a component named Vehicle and a node named vehicle

    Good: vehicle and vehicle_display
    """
    interfaces = subject.model.instances(ros.InterfacePackage)
    holders: dict[str, Named] = {
        package_key(interface.name): interface for interface in interfaces if interface.name
    }
    elements: list[Named] = [*whole.components, *whole.bridges, *whole.nodes]
    packages: list[tuple[str, Named]] = [
        *((f"{whole.name}_{ending}", whole) for ending in ("bringup", "messages")),
        *((element.name or "", element) for element in elements),
    ]
    for name, element in packages:
        if not element.name or not is_identifier(element.name):
            continue
        first = holders.setdefault(package_key(name), element)
        if first is not element:
            message = f"{element.eClass.name} '{element.name}' has the package name of"
            yield Finding(
                element,
                f"{message} {first.eClass.name} '{first.name}'",
                "name",
                related=(Note(first, f"'{first.name}'", "name"),),
            )


_SCOPES = (
    *(jaus.ServiceSet, jaus.Service, jaus.Component, bridge.Bridge, ros.Node),
    *(ros.InterfacePackage, ros.MessageType, system.System),
)


@rule("JML504", "siblings of one name", kinds=_SCOPES, needs=())
def sibling_names(_: Subject, owner: EObject) -> Iterator[Finding]:
    """Elements that lie side by side have names that differ in code as well.

    VelocityX and velocity_x become the same attribute.

    Bad: two connections of a bridge, both named pose

    Good: vehicle_pose and estimated_pose
    """
    for siblings in _siblings(owner):
        yield from _alike(siblings)


@sibling_names.also((jaus.Record, jaus.Sequence, jaus.BitField, jaus.StateMachine, jaus.State))
def _inner_names(_: Subject, owner: Inner) -> Iterator[Finding]:
    yield from _alike(_inner_siblings(owner))


def _alike(siblings: Sequence[Named]) -> Iterator[Finding]:
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


@rule("JML505", "messages of one name in one process", kinds=jaus.Component)
def message_names(subject: Subject, component: jaus.Component) -> Iterator[Finding]:
    """Messages that meet in a process have different names, or are the same message.

    Each becomes a class in the package of the component.

    Bad: a component that provides two services with a message QueryStatus of different codes

    Good: QueryDriveStatus and QueryLampStatus
    """
    holders: dict[str, jaus.MessageDef] = {}
    services = with_inherited((*component.provides, *component.uses))
    messages = sorted(
        (
            message
            for service in services
            for message in (*service.inputs, *service.outputs)
            if message.name and message.code
        ),
        key=lambda message: (message.name, message.code),
    )
    for message in messages:
        first = holders.setdefault(snake_case(message.name), message)
        if first.code.lower() != message.code.lower():
            text = f"'{component.name}' has two messages named {message.name}"
            text += f", of codes {first.code} and {message.code}"
            notes = tuple(Note(held, subject.path(held), "name") for held in (first, message))
            yield Finding(component, text, related=notes)


@rule(
    "JML506",
    "names in a state machine that no code can have",
    kinds=(jaus.State, jaus.Action),
    needs=("name",),
)
def machine_names(_: Subject, element: jaus.State | jaus.Action) -> Iterator[Finding]:
    """States, actions and guards have names of letters, digits and underscores, joined by dots.

    Actions and guards become methods of one class: what differs in the model differs in code. An
    action may stand in many places under one name; it is the same action everywhere. States lie
    at most 20 deep.

    Bad: an action setSpeed and another one set_speed

    Good: setSpeed in both places
    """
    name = element.name
    if name is not None and not all(is_identifier(part) for part in name.split(".")):
        hint = "letters, digits and underscores, with a letter first, joined by dots"
        message = f"{element.eClass.name.lower()} name {name!r} is no identifier"
        yield Finding(element, message, "name", hint)


@machine_names.also(jaus.StateMachine)
def _machine_names_state_machine(_: Subject, machine: jaus.StateMachine) -> Iterator[Finding]:
    for state in too_deep(machine):
        yield Finding(state, f"a state lies more than {DEEPEST} states deep", "name")


@machine_names.also(jaus.Service)
def _machine_names_service(subject: Subject, service: jaus.Service) -> Iterator[Finding]:
    for behaviour in behaviours_of(subject, service):
        holders: dict[str, tuple[str, EObject, str]] = {}
        for kind, name, element, feature in _methods(behaviour):
            first_kind, first, written = holders.setdefault(snake_case(name), (kind, element, name))
            if (first_kind, written) != (kind, name):
                text = f"{kind} '{name}' has the name of the {first_kind} '{written}' in code"
                note = Note(first, f"{first_kind} '{written}'")
                yield Finding(element, text, feature, related=(note,))


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


def _siblings(owner: EObject) -> Iterator[Sequence[Named]]:
    """Yields elements that become names in one scope of the code."""
    if isinstance(owner, jaus.ServiceSet):
        yield from (owner.services, owner.types)
    if isinstance(owner, jaus.Service):
        yield from (owner.inputs, owner.outputs, owner.events, owner.machines)
    if isinstance(owner, jaus.Component):
        yield owner.connections
    if isinstance(owner, bridge.Bridge):
        yield owner.maps
        yield carriers_of(owner)
    if isinstance(owner, ros.Node):
        yield [*owner.publishers, *owner.serviceClients]
        yield [*owner.subscriptions, *owner.serviceServers]
        yield owner.parameters
    if isinstance(owner, ros.InterfacePackage):
        yield from (owner.messages, owner.services, owner.actions)
    if isinstance(owner, ros.MessageType):
        yield from (owner.fields, owner.constants)
    if isinstance(owner, system.System):
        yield owner.hosts


def _inner_siblings(owner: Inner) -> Sequence[Named]:
    if isinstance(owner, jaus.Record | jaus.Sequence):
        return owner.fields
    return owner.subFields if isinstance(owner, jaus.BitField) else owner.states
