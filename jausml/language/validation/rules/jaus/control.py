"""Rules about services, and about whom components obey."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.metamodel.filling import is_set
from jausml.language.model.diagnostics import Severity
from jausml.language.model.values import show
from jausml.language.semantics.connections import calls
from jausml.language.semantics.connections.calls import driver_messages
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.jaus.commands import is_emergency, is_steering
from jausml.language.semantics.jaus.core_services import with_standard
from jausml.language.semantics.jaus.inheritance import along_inheritance, lineage, with_inherited
from jausml.language.semantics.jaus.services import code, signature
from jausml.language.semantics.names import urn_fault
from jausml.language.semantics.paths.scopes import Carrier, carriers_of
from jausml.language.semantics.subject import Subject, remembered
from jausml.language.validation.rule import Finding, Note, rule


@rule("JML364", "control that is never granted", kinds=jaus.Component)
def authority_suffices(subject: Subject, component: jaus.Component) -> Iterator[Finding]:
    """A component that controls another one has at least the authority that the other one requires.

    With less, each RequestControl is rejected for insufficient authority (AS5710, AccessControl),
    and no command passes.

    Bad: `controls="vehicle" authority="100"` where vehicle has `defaultAuthority="200"`

    Good: the same with `authority="200"`
    """
    for place, feature, target in _controlled(component):
        if not subject.is_intact(target) or component.authority >= target.defaultAuthority:
            continue
        message = f"'{target.name}' obeys authority {target.defaultAuthority} and above,"
        message += f" '{component.name}' has {component.authority}"
        note = Note(target, f"'{target.name}'", "defaultAuthority")
        yield Finding(place, message, feature, "raise its authority", (note,))


@rule("JML366", "control that lapses without a word", severity=Severity.INFO, kinds=bridge.Bridge)
def lapse_is_decided(subject: Subject, owner: bridge.Bridge) -> Iterator[Finding]:
    """A bridge that takes commands of clients outside of the model says when control lapses.

    Without a `controlTimeout`, control lapses 5 s after it was requested last, and what is driven
    stops. Clients of v1.0 of the core services, and many of others, request control once and never
    again: they lose the vehicle in mid-drive. 0 keeps control until it is released or preempted;
    then nothing notices a client that is gone but the silence of its commands. Components of jausml
    renew control: where the peers are of the model and not external, nothing is to be decided.

    Bad: a connection with commands of an external operator, or of anybody, without `controlTimeout`

    Good: `controlTimeout="0"` for a client that asks once, `controlTimeout="5"` for one that renews
    """
    table = subject.model.metamodels.class_of(owner).features["controlTimeout"]
    if is_set(owner, table):
        return
    for connection in carriers_of(owner):
        if not _takes_commands(subject, connection):
            continue
        known = list(connection.peers)
        outside = [component for component in known if component.external]
        if outside or not known:
            client = f"'{outside[0].name}'" if outside else "its client"
            message = f"control of '{owner.name}' lapses {owner.controlTimeout} s after "
            message += f"{client} has requested it last"
            hint = "state controlTimeout: 0 for clients that request control once"
            note = Note(connection, f"'{connection.name}' takes its commands", "peers")
            yield Finding(owner, message, hint=hint, related=(note,))
            break


def _takes_commands(subject: Subject, connection: Carrier) -> bool:
    """Tells whether components may command the ROS side by a connection."""
    if not is_to_ros(connection):
        return False
    if isinstance(connection, bridge.RosActionConnection):
        return True
    if isinstance(connection, bridge.RosServiceConnection):
        message = calls.asking(connection)
    else:
        map_ = connection.map
        message = (
            map_.message if map_ is not None and connection.exchange.name == "message" else None
        )
    return message is not None and subject.is_intact(message) and is_steering(message)


@rule("JML368", "controllers of one authority", severity=Severity.INFO)
def authorities_differ(subject: Subject) -> Iterator[Finding]:
    """Of several controllers of a component, one has more authority than the other.

    A component that is controlled obeys nobody else but who has more authority (AS5710,
    AccessControl, RequestControl): between equals, whoever asked first keeps control until it is
    released, and the other one is told that it is not available.

    Bad: two components with `controls="vehicle"`

    Good: `authority="200"` at the one that may take over
    """
    first: dict[tuple[jaus.Component, int], tuple[jaus.Component, EObject]] = {}
    reported_pairs: set[tuple[jaus.Component, jaus.Component]] = set()
    for component in subject.instances(jaus.Component):
        for place, feature, target in _controlled(component):
            other, note = first.setdefault((target, component.authority), (component, place))
            if other is component or (component, target) in reported_pairs:
                continue
            reported_pairs.add((component, target))
            message = f"'{component.name}' and '{other.name}' control '{target.name}' with one"
            message += f" authority, {component.authority}: whoever asks first keeps it"
            hint = "raise the authority of the one that may take over"
            yield Finding(place, message, feature, hint, (Note(note, f"'{other.name}'"),))


@rule(
    "JML365",
    "component that is its own peer",
    kinds=(bridge.Connection, bridge.RosServiceConnection, bridge.RosActionConnection),
    needs=("name", "peers"),
)
def no_own_peers(
    _: Subject,
    connection: bridge.Connection | bridge.RosServiceConnection | bridge.RosActionConnection,
) -> Iterator[Finding]:
    """The peers of a connection are other components than the one that has it.

    An emergency alone may be one of the bridge itself: an emergency stop of ROS presses it.

    Bad: `peers="front"` in a connection of the bridge front

    Good: `peers="vehicle"`
    """
    owner = connection.eContainer()
    map_ = connection.map if isinstance(connection, bridge.Connection) else None
    is_own = map_ is not None and map_.message is not None and is_emergency(map_.message)
    if owner is not None and not is_own and any(peer is owner for peer in connection.peers):
        message = f"'{connection.name}' has its own bridge '{owner.name}' as a peer"
        yield Finding(connection, message, "peers")


@no_own_peers.also(jaus.ServiceConnection, needs=("name", "provider"))
def _no_own_provider(_: Subject, asked: jaus.ServiceConnection) -> Iterator[Finding]:
    component = asked.eContainer()
    if component is not None and asked.provider is component:
        message = f"'{asked.name}' asks '{component.name}', which has it"
        yield Finding(asked, message, "provider")


@remembered
def _controlled(component: jaus.Component) -> list[tuple[EObject, str, jaus.Component]]:
    """Returns whom a component controls, with the element and the feature that say so."""
    return list(_all_controlled(component))


def _all_controlled(component: jaus.Component) -> Iterator[tuple[EObject, str, jaus.Component]]:
    for target in component.controls:
        yield component, "controls", target
    if not isinstance(component, bridge.Bridge):
        return
    for connection in component.bridgeConnections:
        sends = not is_to_ros(connection) and connection.exchange.name == "message"
        message = connection.map.message if connection.map is not None else None
        if sends and connection.control and message is not None and is_steering(message):
            for peer in connection.peers:
                yield connection, "peers", peer
    yield from _controlled_for_clients(component)


def _controlled_for_clients(owner: bridge.Bridge) -> Iterator[tuple[EObject, str, jaus.Component]]:
    """Yields whom a bridge controls for the clients of its ROS services and actions."""
    for call in owner.serviceConnections:
        asking = calls.asking(call)
        if calls.serves(call) and call.control and asking is not None and is_steering(asking):
            for peer in call.peers:
                yield call, "peers", peer
    for action in owner.actionConnections:
        if not is_to_ros(action) and action.control:
            for peer in action.peers:
                yield action, "peers", peer


# The characters of RFC 8141, without components that services do not use.


@rule("JML311", "service inherits from itself")
def inheritance_cycle(subject: Subject) -> Iterator[Finding]:
    """The services that a service inherits from are not the service itself.

    Bad: A inherits B, B inherits A

    Good: A inherits B, B inherits Events
    """
    services = list(subject.instances(jaus.Service))
    sound = {service for service, _ in along_inheritance(services)}
    for service in services:
        if service in sound:
            continue
        last = lineage(service)[-1]
        if last.inherits is service:
            names = " -> ".join(ancestor.name or "?" for ancestor in (*lineage(service), service))
            yield Finding(service, f"service '{service.name}' inherits itself: {names}", "inherits")


@rule("JML312", "message code used twice in a service")
def code_unique(subject: Subject) -> Iterator[Finding]:
    """A message code means one message within a service and those that it inherits.

    The code alone determines how a message is read. One message may be input and output. For
    services of the library, which are as they were published, this is a warning.

    Bad: inputs SetSpeed and SetSteering, both with `code="0x0415"`

    Good: `0x0415` and `0x0416`
    """
    services = list(subject.instances(jaus.Service))
    judged = set(services)
    seen: dict[int, jaus.MessageDef] = {}
    for service, entering in along_inheritance(services):
        for message in _messages(service):
            number = code(message)
            if number < 0 or not subject.is_intact(message):
                continue
            first = seen.setdefault(number, message)
            if not entering:
                if first.eContainer() is service:
                    del seen[number]
            elif service in judged and _differ(first, message):
                owner = first.eContainer()
                path = subject.path(owner) if owner is not None else ""
                note = Note(first, f"{first.name} of {path}", "code")
                text = f"code {message.code} of {message.name} is that of {first.name}"
                severity = subject.severity(message)
                yield Finding(message, text, "code", related=(note,), severity=severity)


@rule("JML313", "messages of one code in one process", kinds=jaus.Component)
def code_unambiguous(subject: Subject, component: jaus.Component) -> Iterator[Finding]:
    """Messages with one code that meet in a process have one layout and one name.

    A process finds the codec of a message by its code. The messages of a component are those of its
    services, of the services that it uses, of its connections and of its maps. Two of one service
    of the library are a warning: it was published like this, and CBRNSensor has such a pair.

    Bad: a component that provides a service of core-1.0 and uses one of core-1.1 whose message
    of the same code has another field

    Good: both from the same service set
    """
    by_code: dict[int, list[jaus.MessageDef]] = defaultdict(list)
    for message in _messages_of(component):
        number = code(message)
        if number >= 0 and subject.is_intact(message):
            by_code[number].append(message)
    for messages in by_code.values():
        first = messages[0]
        for other in messages[1:]:
            if _differ(first, other):
                yield _ambiguous(subject, component, first, other)
                break


@rule("JML314", "illegal URN", kinds=jaus.Service)
def urns(_: Subject, service: jaus.Service) -> Iterator[Finding]:
    """A service is named by a URN of at most 255 characters (RFC 8141; AS5710, ReportServices).

    Bad: `urn="PrimitiveDriver"`

    Good: `urn="urn:jaus:jss:mobility:PrimitiveDriver"`
    """
    fault = urn_fault(service.urn) if service.urn is not None else ""
    if fault:
        message = f"urn {show(service.urn)} of '{service.name}' {fault}"
        example = f"urn:acme:jaus:{service.name}"
        hint = f"a namespace of 2 to 32 letters and digits, and a name, such as {example}"
        yield Finding(service, message, "urn", hint)


def _ambiguous(
    subject: Subject, component: jaus.Component, first: jaus.MessageDef, other: jaus.MessageDef
) -> Finding:
    how = "another name" if first.name != other.name else "another layout"
    # No document of the model has the messages of standard services.
    written = [
        message for message in (first, other) if subject.model.document_of(message) is not None
    ]
    return Finding(
        component,
        f"'{component.name}' has two messages of the code {first.code}: {first.name} and"
        f" {other.name} with {how}",
        hint="" if len(written) > 1 else 'with coreServices="none" it has no core services',
        related=tuple(Note(message, subject.path(message), "code") for message in written),
        severity=subject.severity(first) if first.eContainer() is other.eContainer() else None,
    )


def _differ(first: jaus.MessageDef, other: jaus.MessageDef) -> bool:
    if first is other:
        return False
    return first.name != other.name or signature(first) != signature(other)


def _messages(service: jaus.Service) -> list[jaus.MessageDef]:
    return [*service.inputs, *service.outputs]


def _messages_of(component: jaus.Component) -> list[jaus.MessageDef]:
    messages: dict[jaus.MessageDef | None, None] = {}
    for service in with_inherited((*with_standard(component), *component.uses)):
        messages.update(dict.fromkeys(_messages(service)))
    for connection in component.connections:
        messages.update(dict.fromkeys((connection.message, connection.query)))
    if isinstance(component, bridge.Bridge):
        for bridge_connection in component.bridgeConnections:
            carried = bridge_connection.map.message if bridge_connection.map is not None else None
            messages.update(dict.fromkeys((carried, bridge_connection.query)))
        for call in component.serviceConnections:
            messages.update(dict.fromkeys(calls.messages(call)))
        for action in component.actionConnections:
            driven = driver_messages(action.driver)
            if driven is not None:
                messages.update(dict.fromkeys(driven.all))
            messages[action.element.message if action.element is not None else None] = None
    return [message for message in messages if message is not None]
