"""Services that components provide, and the messages that these take and send."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias

from jausml.language import wire
from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.semantics.jaus.core_services import with_standard
from jausml.language.semantics.jaus.inheritance import with_inherited
from jausml.language.semantics.subject import Subject, remembered

Provider: TypeAlias = "jaus.Component | jaus.PeerSearch"
"""A provider of services: a component, or whatever a search finds."""

# What does not change the bytes of a legal message.
_BESIDE_THE_WIRE = frozenset({"name", "documentation", "units", "legal"})


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
