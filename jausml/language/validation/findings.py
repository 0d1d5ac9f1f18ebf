"""Findings that several rules have: about who provides services, and about times."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TypeAlias

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.semantics.connections.limits import LONGEST_TIME
from jausml.language.semantics.jaus.services import (
    Provider,
    is_known,
    provides_access_control,
    query_name,
)
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, Note

AnyConnection: TypeAlias = "jaus.ServiceConnection | bridge.Connection"


def provider_name(provider: Provider) -> str:
    """Returns the name of a provider for messages: a component, or the services of a search."""
    if isinstance(provider, jaus.PeerSearch):
        services = " and ".join(str(service.name) for service in provider.services)
        return f"what the search for {services} finds"
    return f"'{provider.name}'"


def unprovided(
    element: EObject,
    provider: Provider,
    message: jaus.MessageDef,
    verb: str,
    feature: str,
    purpose: str = "",
) -> Finding:
    """Returns the finding that no service of a provider takes or sends a message.

    Args:
        verb: `takes` or `sends`.
        purpose: What the message is for, as the end of the sentence.
    """
    who, service, hint = provider_name(provider), message.eContainer(), ""
    if service is not None and message in (service.inputs if verb == "takes" else service.outputs):
        is_searched = isinstance(provider, jaus.PeerSearch)
        hint = f"search for {service.name}" if is_searched else f"add {service.name} to what it"
        hint += "" if is_searched else " provides"
    text = f"{who} provides no service that {verb} {message.name}{purpose}"
    return Finding(element, text, feature, hint, (Note(provider, who),))


def missing_query(
    connection: AnyConnection, message: jaus.MessageDef, provider: Provider
) -> Finding:
    """Returns the finding about a connection whose provider takes no query for the report."""
    query = connection.query
    wanted = query.name if query is not None else query_name(message)
    note = (Note(provider, provider_name(provider)),)
    text = f"{provider_name(provider)} takes no {wanted}, which asks for {message.name}"
    if query is not None:
        return Finding(connection, text, "query", related=note)
    hint = f"let it provide a service with the input {wanted}, or name the query in 'query'"
    return Finding(connection, text, None, hint, note)


def uncontrollable(
    subject: Subject,
    connection: bridge.Connection | bridge.RosServiceConnection,
    peers: Iterable[Provider],
) -> Iterator[Finding]:
    """Yields a finding for each peer whose control a connection could not get."""
    for peer in peers:
        if is_known(subject, peer) and not provides_access_control(peer):
            who = provider_name(peer)
            message = f"{who} provides no AccessControl, so control of it cannot be had"
            feature = "search" if connection.search is not None else "peers"
            hint = f"set {subject.assigned(connection, {'control': 'false'})}"
            yield Finding(connection, message, feature, hint, (Note(peer, who),))


def time_findings(
    element: jaus.ServiceConnection | bridge.Connection | bridge.AttributeMap | bridge.Stop,
    feature: str,
) -> Iterator[Finding]:
    """Yields a finding where a time is stated that is negative, or that no parameter takes."""
    value = getattr(element, feature)
    if value is not None and not 0 <= value <= LONGEST_TIME:
        named = element.eContainer() if isinstance(element, bridge.Stop) else element
        name = "" if named is None else named.name
        message = f"{feature} {value:g} of '{name}' is not 0 to {LONGEST_TIME:g} s"
        yield Finding(element, message, feature)
