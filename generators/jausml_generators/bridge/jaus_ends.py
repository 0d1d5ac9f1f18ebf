"""The JAUS ends of connections of all kinds: who is there, what is asked, whom commands obey."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.generation.errors import GenerationError
from jausml_generators.bridge.topics import list_of
from jausml_generators.common.components import (
    address_call,
    query_for,
    search_call,
    with_inherited,
)
from jausml_generators.python.statements import call

if TYPE_CHECKING:
    from collections.abc import Container

    from jausml.language.metamodel.classes import bridge, jaus
    from jausml_generators.python.codec.messages import MessageView
from jausml.language.semantics.jaus.commands import PRESENCE_VECTOR


def query_call(query: MessageView, report: MessageView | None, fields: Container[str]) -> str:
    """Returns a query as it is asked: its presence vector names the fields that are read.

    Args:
        report: The report, if something of it is read.
    """
    presence = query.find(PRESENCE_VECTOR)
    if not presence or report is None:
        return call(query.class_name)
    bits = (m.bit for m in report.body.members if m.jaus_name in fields)
    return call(query.class_name, f"{presence[0].attribute}=0x{sum(bits):04X}")


def query_of(connection: bridge.Connection) -> jaus.MessageDef | None:
    """Returns the query for the report of a connection; None for single messages.

    Raises:
        GenerationError: Neither the service of the report nor another of the sender has one.
    """
    if connection.exchange.name == "message":
        return None
    if connection.query is not None:
        return connection.query
    report = connection.map.message
    to_ros = connection.direction.name == "jausToRos"
    senders = connection.peers if to_ros else [connection.eContainer()]
    services = [each for sender in senders if sender is not None for each in sender.provides]
    if to_ros and connection.search is not None:
        services += connection.search.services
    provided = with_inherited(services)
    own = report.eContainer()
    query = query_for(report, provided if own is None else [own, *provided])
    if query is None:
        raise GenerationError(f"connection '{connection.name}': no query for {report.name}")
    return query


def peers_of(connection: bridge.Connection | bridge.RosServiceConnection) -> str:
    """Returns the components at the other end of a connection, or how they are found, as Python."""
    if connection.search is not None:
        return search_call(connection.search)
    return list_of(map(address_call, connection.peers))


def priority_of(
    connection: bridge.Connection | bridge.RosServiceConnection,
) -> list[tuple[str, str]]:
    """Returns the argument of the priority of a connection; none for the usual one."""
    if connection.priority.name == "standard":
        return []
    names = {"low": "LOW", "high": "HIGH", "safetyCritical": "SAFETY_CRITICAL"}
    return [("priority", f"Priority.{names[connection.priority.name]}")]
