"""Queries and the reports that answer them: what a bridge tells, and what it leaves unanswered.

Whoever provides a service answers its queries (AS5684). A command that a bridge has obeyed answers
the query for it, as its report is laid out in the same way.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import jaus
from jausml.language.semantics.jaus.commands import is_command
from jausml.language.semantics.jaus.layouts import attributes, signature
from jausml.language.semantics.jaus.services import code, lineage, query_name

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.language.metamodel.classes import bridge


PRESENCE_VECTOR = "PresenceVector"
"""Field of a query that names the optional fields which its report shall hold (AS6009)."""


@dataclass(frozen=True)
class Answer:
    """A query that is answered, and how."""

    query: jaus.MessageDef
    report: jaus.MessageDef


def answer_by(service: jaus.Service, report: jaus.MessageDef | None) -> Answer | None:
    """Returns the answer that a report of a service is; None when nobody can ask for it.

    Args:
        report: The report; None where there is none.
    """
    if report is None:
        return None
    query = named(query_name(report), (m for each in lineage(service) for m in each.inputs))
    return None if query is None else Answer(query, report)


def answer_alike(service: jaus.Service, message: jaus.MessageDef) -> Answer | None:
    """Returns how a service tells what was set by a message; None when it is not asked for that.

    The report is laid out as the message is, so that nothing has to be translated.
    """
    wanted = f"Report{(message.name or '').removeprefix('Set')}"
    report = named(wanted, (m for each in lineage(service) for m in each.outputs))
    is_alike = report is not None and signature(report) == signature(message)
    return answer_by(service, report) if is_alike else None


def named(name: str, messages: Iterable[jaus.MessageDef]) -> jaus.MessageDef | None:
    """Returns the first message of a name."""
    return next((each for each in messages if each.name == name), None)


def chosen_fields(answer: Answer) -> list[str] | None:
    """Returns the fields of a query that say which report is wanted, besides what is in it.

    QueryVelocityCommand, for example, names the type of the command.

    Returns:
        The names of plain fields of both; None when the query says it in another way.
    """
    asked = [each for each in attributes(answer.query) if each.name != PRESENCE_VECTOR]
    told = {each.name for each in attributes(answer.report) if isinstance(each, jaus.FixedField)}
    if all(isinstance(each, jaus.FixedField) and each.name in told for each in asked):
        return [str(each.name) for each in asked]
    return None


def told_by_command(message: jaus.MessageDef, services: Iterable[jaus.Service]) -> Answer | None:
    """Returns how whoever obeys a command tells it when asked; None when that cannot be.

    It can be of what moves something: of a SetLocalPose nobody knows whether it still holds.
    """
    if not (is_command(message) and message.moves):
        return None
    for service in services:
        answer = answer_alike(service, message)
        if answer is not None and chosen_fields(answer) is not None:
            return answer
    return None


def command_answer(connection: bridge.Connection) -> Answer | None:
    """Returns how a connection tells the command that it carries to ROS; None when it cannot."""
    owner, message = connection.eContainer(), connection.map.message
    if owner is None or not _carries(connection, message):
        return None
    # Of several for one command, for several peers, none knows which came last.
    if sum(_carries(each, message) for each in owner.bridgeConnections) > 1:
        return None
    return told_by_command(message, owner.provides)


def _carries(connection: bridge.Connection, message: jaus.MessageDef) -> bool:
    """Tells whether a connection takes a message from JAUS as it comes.

    On the wire it is its code alone: several services have a SetTravelSpeed.
    """
    is_taken = connection.direction.name == "jausToRos" and connection.exchange.name == "message"
    taken = connection.map.message if connection.map is not None else None
    return is_taken and taken is not None and code(taken) == code(message)
