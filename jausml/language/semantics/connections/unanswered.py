"""What a bridge answers of the queries of its services, and what it leaves unanswered."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.semantics.connections import calls
from jausml.language.semantics.connections.list_drivers import answers, driver_messages
from jausml.language.semantics.jaus.answers import command_answer
from jausml.language.semantics.jaus.core_services import SERVED_BY_RUNTIME
from jausml.language.semantics.jaus.services import code, lineage, query_name

if TYPE_CHECKING:
    from collections.abc import Container, Iterator

    from jausml.language.metamodel.classes import bridge, jaus
    from jausml.language.semantics.jaus.answers import Answer


def unanswered(service: jaus.Service, sent: Container[int]) -> list[jaus.MessageDef]:
    """Returns the queries of a service that get no report; those that it inherits are not asked."""
    if str(service.urn) in SERVED_BY_RUNTIME:
        return []
    # A service may send a report for which one that it inherits has the query.
    asked = {each.name: each for one in lineage(service) for each in one.inputs}
    reports = (each for each in service.outputs if code(each) not in sent)
    found = (asked.get(query_name(each)) for each in reports)
    return [each for each in found if each is not None]


def sent_reports(owner: bridge.Bridge) -> set[int]:
    """Returns the codes of the reports that a bridge answers with.

    Args:
        owner: The bridge, with all that its connections refer to.
    """
    commands = map(command_answer, owner.bridgeConnections)
    return {
        *map(code, _carried(owner)),
        *(code(each.report) for each in commands if each is not None),
    }


def told_command(connection: bridge.Connection) -> Answer | None:
    """Returns how a connection of commands tells what it obeys, unless something else answers."""
    answer, owner = command_answer(connection), connection.eContainer()
    if answer is None or owner is None:
        return None
    return None if code(answer.report) in set(map(code, _carried(owner))) else answer


def _carried(owner: bridge.Bridge) -> Iterator[jaus.MessageDef]:
    """Yields what connections of a bridge send to whoever asks."""
    for connection in owner.bridgeConnections:
        if connection.direction.name == "rosToJaus" and connection.exchange.name != "message":
            yield connection.map.message
    for call in owner.serviceConnections:
        yield from calls.messages(call)
    for action in owner.actionConnections:
        messages = driver_messages(action.driver)
        if messages is not None:
            yield messages.report
        yield from (each.report for each in answers(action))
