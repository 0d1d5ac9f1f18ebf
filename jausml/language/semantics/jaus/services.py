"""Messages that a component takes and sends, inherited services included, and their layouts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, TypeAlias

from jausml.language import wire
from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.semantics.jaus.core_services import with_standard
from jausml.language.semantics.subject import Subject, remembered

if TYPE_CHECKING:
    from typing_extensions import TypeIs

Group: TypeAlias = "jaus.Record | jaus.Sequence"
Container: TypeAlias = "Group | jaus.List | jaus.Variant"
Provider: TypeAlias = "jaus.Component | jaus.PeerSearch"
"""A provider of services: a component, or whatever a search finds."""

# What does not change the bytes of a legal message.
_BESIDE_THE_WIRE = frozenset({"name", "documentation", "units", "legal"})


def class_name(element: EObject) -> str:
    """Returns the name of the metamodel class of an element."""
    return str(element.eClass.name)


def members(container: jaus.Field | None) -> list[jaus.Field]:
    """Returns the fields of a record or sequence, none for other fields."""
    return list(container.fields) if is_group(container) else []


def is_group(field: EObject | None) -> TypeIs[Group]:
    """Tells whether a field is a record or a sequence."""
    return isinstance(field, (jaus.Record, jaus.Sequence))


def is_container(field: EObject | None) -> TypeIs[Container]:
    """Tells whether a field is a record, sequence, list or variant (JSIDL's containers)."""
    return isinstance(field, (jaus.Record, jaus.Sequence, jaus.List, jaus.Variant))


def attributes(message: jaus.MessageDef) -> list[jaus.Field]:
    """Returns the fields that a codec exposes as attributes of the message.

    The top record or sequence is flattened; a list or variant is one attribute.
    """
    body = wire.target_of(message.body)
    if body is None or message.body is None:
        return []
    return members(body) if is_group(body) else [message.body]


@remembered
def signature(message: jaus.MessageDef) -> object:
    """Returns a comparable description of what a message body puts on the wire.

    Returns:
        None for a body without a layout.
    """
    try:
        return wire.comparable(wire.resolve(message).body, _BESIDE_THE_WIRE)
    except wire.LayoutError:
        return None


ACCESS_CONTROL = "AccessControl"

_PROVIDING = ("name", "external", "coreServices", "provides", "services")


def lineage(service: jaus.Service | None) -> list[jaus.Service]:
    """Returns a service and those that it inherits, nearest first; a cycle ends the list."""
    services: dict[jaus.Service, None] = {}
    while service is not None and service not in services:
        services[service] = None
        service = service.inherits
    return list(services)


def with_inherited(services: Iterable[jaus.Service]) -> list[jaus.Service]:
    """Returns services and those that they inherit, each once."""
    all_services: dict[jaus.Service, None] = {}
    for start in services:
        service: jaus.Service | None = start
        # What a service that was found inherits was found with it.
        while service is not None and service not in all_services:
            all_services[service] = None
            service = service.inherits
    return list(all_services)


def along_inheritance(services: Iterable[jaus.Service]) -> Iterator[tuple[jaus.Service, bool]]:
    """Yields services with their inherited ones, in one walk down the trees of inheritance.

    Every service is visited once, so that a walk costs no more than there are services, however
    deep they inherit. Services on a cycle, and their heirs, are left out.

    Yields:
        A service and True before its heirs, the service and False after them.
    """
    heirs: dict[jaus.Service, list[jaus.Service]] = {}
    roots = []
    for start in services:
        service = start
        while service not in heirs:
            heirs[service] = []
            parent = service.inherits
            if parent is None:
                roots.append(service)
                break
            service = parent
    for service in heirs:
        if service.inherits is not None:
            heirs[service.inherits].append(service)
    visits = [(root, True) for root in reversed(roots)]
    while visits:
        service, entering = visits.pop()
        yield service, entering
        if entering:
            visits.append((service, False))
            visits += [(heir, True) for heir in reversed(heirs[service])]


@remembered
def provided_services(component: jaus.Component) -> list[jaus.Service]:
    """Returns the services that a component provides, each once.

    Those that they inherit are among them, and the standard core services.
    """
    return with_inherited(with_standard(component))


def service_versions(component: jaus.Component) -> dict[str, tuple[int, int]]:
    """Returns the versions of the services that a component provides, by URN.

    Service sets of different age may inherit different versions of a core service; the component
    speaks the newest of them. Standard services raise no version of what the model names: peers
    of core 1.0 do not know, for example, that events of 1.1 lapse.
    """
    versions: dict[str, tuple[int, int]] = {}
    for service in with_inherited(component.provides):
        urn = str(service.urn)
        versions[urn] = max(versions.get(urn, (0, 0)), _version(service))
    for service in provided_services(component):
        versions.setdefault(str(service.urn), _version(service))
    return versions


def _version(service: jaus.Service) -> tuple[int, int]:
    major, minor = str(service.version).split(".")
    return int(major), int(minor)


def is_known(subject: Subject, provider: Provider | None) -> bool:
    """Tells whether all that a provider provides could be read.

    Only then is the absence of a message a finding of its own.
    """
    if provider is None or not subject.is_read(provider, _PROVIDING):
        return False
    return subject.is_intact(*services_of(provider))


def searched_services(search: jaus.PeerSearch) -> list[jaus.Service]:
    """Returns the services that whatever a search finds provides, inherited ones included."""
    return with_inherited(search.services)


@remembered
def inputs_by_name(service: jaus.Service) -> dict[str, jaus.MessageDef]:
    """Returns the messages that a service takes itself, of several with one name the first."""
    return {str(message.name): message for message in reversed(service.inputs)}


@remembered
def outputs_by_name(service: jaus.Service) -> dict[str, jaus.MessageDef]:
    """Returns the messages that a service sends itself, of several with one name the first."""
    return {str(output.name): output for output in reversed(service.outputs)}


@remembered
def inputs(provider: Provider) -> list[jaus.MessageDef]:
    """Returns the messages that the services of a provider take."""
    return [message for service in services_of(provider) for message in service.inputs]


@remembered
def outputs(provider: Provider) -> list[jaus.MessageDef]:
    """Returns the messages that the services of a provider send."""
    return [output for service in services_of(provider) for output in service.outputs]


@remembered
def services_of(provider: Provider) -> list[jaus.Service]:
    """Returns the services of a component, or of whatever a search finds."""
    if isinstance(provider, jaus.PeerSearch):
        return searched_services(provider)
    return provided_services(provider)


def peers_of(
    connection: bridge.Connection | bridge.RosServiceConnection | bridge.RosActionConnection,
) -> list[Provider]:
    """Returns the named peers of a connection, and those that are searched for."""
    peers: list[Provider] = list(connection.peers)
    return peers if connection.search is None else [*peers, connection.search]


def find_input(message: jaus.MessageDef, provider: Provider) -> jaus.MessageDef | None:
    """Returns the message that a provider takes which is the same on the wire, or None."""
    return find_same(message, _inputs_by_code(provider).get(code(message), ()))


def find_output(message: jaus.MessageDef, provider: Provider) -> jaus.MessageDef | None:
    """Returns the message that a provider sends which is the same on the wire, or None."""
    return find_same(message, _outputs_by_code(provider).get(code(message), ()))


@remembered
def _inputs_by_code(provider: Provider) -> dict[int, list[jaus.MessageDef]]:
    return _by_code(inputs(provider))


@remembered
def _outputs_by_code(provider: Provider) -> dict[int, list[jaus.MessageDef]]:
    return _by_code(outputs(provider))


def _by_code(messages: Iterable[jaus.MessageDef]) -> dict[int, list[jaus.MessageDef]]:
    messages_by_code: dict[int, list[jaus.MessageDef]] = {}
    for message in messages:
        messages_by_code.setdefault(code(message), []).append(message)
    return messages_by_code


@remembered
def _inputs_by_name(provider: Provider) -> dict[str | None, jaus.MessageDef]:
    return {message.name: message for message in reversed(inputs(provider))}


def find_same(
    message: jaus.MessageDef, candidates: Iterable[jaus.MessageDef]
) -> jaus.MessageDef | None:
    """Returns the candidate that is the same message on the wire, or None.

    Service sets repeat a message when several services take it: the code and the layout count.
    """
    for candidate in candidates:
        if candidate is message:
            return candidate
        if same_code(candidate, message) and signature(candidate) == signature(message):
            return candidate
    return None


def same_code(first: jaus.MessageDef, second: jaus.MessageDef) -> bool:
    """Tells whether two messages have the same message code."""
    return code(first) == code(second)


def code(message: jaus.MessageDef) -> int:
    """Returns the message code as a number, -1 when it has none."""
    text = message.code
    return int(text, 16) if text else -1


def provides_access_control(provider: Provider) -> bool:
    """Tells whether a provider can be controlled (AS5710, AccessControl)."""
    return any(service.name == ACCESS_CONTROL for service in services_of(provider))


def query_name(message: jaus.MessageDef) -> str:
    """Returns the name of the query that asks for a report: QueryX for ReportX, or X."""
    return f"Query{(message.name or '').removeprefix('Report')}"


def find_query(
    connection: jaus.ServiceConnection | bridge.Connection, provider: Provider
) -> jaus.MessageDef | None:
    """Returns the query of a connection among the inputs of the provider, or None."""
    if connection.query is not None:
        return find_input(connection.query, provider)
    if isinstance(connection, jaus.ServiceConnection):
        wanted = query_name(connection.message)
    else:
        wanted = query_name(connection.map.message)
    return _inputs_by_name(provider).get(wanted)
