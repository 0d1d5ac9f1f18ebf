"""Rules about JAUS services and their messages."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.model.diagnostics import Severity
from jausml.language.model.values import show
from jausml.language.semantics.connections import calls
from jausml.language.semantics.connections.list_drivers import driver_messages
from jausml.language.semantics.jaus.core_services import with_standard
from jausml.language.semantics.jaus.layouts import signature
from jausml.language.semantics.jaus.services import along_inheritance, code, lineage, with_inherited
from jausml.language.semantics.names import urn_fault
from jausml.language.validation.rule import Finding, Note, rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.semantics.subject import Subject

# The characters of RFC 8141, without components that services do not use.


@rule("JML311", Severity.ERROR, "service inherits from itself")
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
            names = " -> ".join(each.name or "?" for each in (*lineage(service), service))
            yield Finding(service, f"service '{service.name}' inherits itself: {names}", "inherits")


@rule("JML312", Severity.ERROR, "message code used twice in a service")
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
            if code(message) < 0 or not subject.is_intact(message):
                continue
            first = seen.setdefault(code(message), message)
            if not entering:
                if first.eContainer() is service:
                    del seen[code(message)]
            elif service in judged and _differ(first, message):
                owner = first.eContainer()
                path = subject.path(owner) if owner is not None else ""
                note = Note(first, f"{first.name} of {path}", "code")
                text = f"code {message.code} of {message.name} is that of {first.name}"
                severity = subject.severity(message)
                yield Finding(message, text, "code", related=(note,), severity=severity)


@rule("JML313", Severity.ERROR, "messages of one code in one process")
def code_unambiguous(subject: Subject) -> Iterator[Finding]:
    """Messages with one code that meet in a process have one layout and one name.

    A process finds the codec of a message by its code. The messages of a component are those of its
    services, of the services that it uses, of its connections and of its maps. Two of one service
    of the library are a warning: it was published like this, and CBRNSensor has such a pair.

    Bad: a component that provides a service of core-1.0 and uses one of core-1.1 whose message
    of the same code has another field

    Good: both from the same service set
    """
    for component in subject.instances(jaus.Component):
        by_code: dict[int, list[jaus.MessageDef]] = defaultdict(list)
        for message in _messages_of(component):
            if code(message) >= 0 and subject.is_intact(message):
                by_code[code(message)].append(message)
        for messages in by_code.values():
            first = messages[0]
            for other in messages[1:]:
                if _differ(first, other):
                    yield _ambiguous(subject, component, first, other)
                    break


@rule("JML314", Severity.ERROR, "illegal URN")
def urns(subject: Subject) -> Iterator[Finding]:
    """A service is named by a URN of at most 255 characters (RFC 8141; AS5710, ReportServices).

    Bad: `urn="PrimitiveDriver"`

    Good: `urn="urn:jaus:jss:mobility:PrimitiveDriver"`
    """
    for service in subject.instances(jaus.Service):
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
    written = [each for each in (first, other) if subject.model.document_of(each) is not None]
    return Finding(
        component,
        f"'{component.name}' has two messages of the code {first.code}: {first.name} and"
        f" {other.name} with {how}",
        hint="" if len(written) > 1 else 'with coreServices="none" it has no core services',
        related=tuple(Note(each, subject.path(each), "code") for each in written),
        severity=subject.severity(first) if first.eContainer() is other.eContainer() else None,
    )


def _differ(first: jaus.MessageDef, other: jaus.MessageDef) -> bool:
    if first is other:
        return False
    return first.name != other.name or signature(first) != signature(other)


def _messages(service: jaus.Service) -> list[jaus.MessageDef]:
    return [*service.inputs, *service.outputs]


def _messages_of(component: jaus.Component) -> list[jaus.MessageDef]:
    found: dict[jaus.MessageDef | None, None] = {}
    for service in with_inherited((*with_standard(component), *component.uses)):
        found.update(dict.fromkeys(_messages(service)))
    for connection in component.connections:
        found.update(dict.fromkeys((connection.message, connection.query)))
    if isinstance(component, bridge.Bridge):
        for each in component.bridgeConnections:
            carried = each.map.message if each.map is not None else None
            found.update(dict.fromkeys((carried, each.query)))
        for call in component.serviceConnections:
            found.update(dict.fromkeys(calls.messages(call)))
        for action in component.actionConnections:
            used = driver_messages(action.driver)
            if used is not None:
                found.update(dict.fromkeys((used.execute, used.query, used.report)))
            found[action.element.message if action.element is not None else None] = None
    return [message for message in found if message is not None]
