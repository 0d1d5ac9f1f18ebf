"""A rule about what a bridge is asked for: whoever provides a service answers its queries."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.connections.unanswered import sent_reports, unanswered
from jausml.language.semantics.jaus.answers import told_by_command
from jausml.language.semantics.jaus.services import code, is_known
from jausml.language.validation.rule import Finding, rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.semantics.subject import Subject


@rule("JML367", Severity.INFO, "query that nothing answers")
def answers_queries(subject: Subject) -> Iterator[Finding]:
    """A bridge answers the queries of the services that it provides.

    Discovery announces the whole service. Who asks what no connection answers waits in vain, and
    may take the bridge for dead. The runtime answers the core services, a list driver tells its
    speed and its active element, and a connection of commands tells the last one that it passed
    on. What is left needs a connection to JAUS with the report, or an answer in the code of the
    bridge, which no rule sees: so this is no warning.

    Bad: a bridge that provides VelocityStateSensor, with no connection for ReportVelocityState

    Good: with a connection to JAUS for ReportVelocityState
    """
    for owner in subject.instances(bridge.Bridge):
        if not is_known(subject, owner) or not _is_read(subject, owner):
            continue
        sent = sent_reports(owner) | set(_meant(owner))
        for service in owner.provides:
            if queries := unanswered(service, sent):
                names = ", ".join(str(each.name) for each in queries)
                message = f"no connection of '{owner.name}' answers {names} of {service.name}"
                hint = "add a connection to JAUS with the report, or answer in its code"
                yield Finding(owner, message, "provides", hint)


def _meant(owner: bridge.Bridge) -> Iterator[int]:
    """Yields the codes of reports that connections without another end would send the right way.

    One that goes the wrong way has a finding of its own.
    """
    for connection in owner.bridgeConnections:
        if not (connection.peers or connection.search):
            message = connection.map.message
            answer = told_by_command(message, owner.provides)
            yield code(message if answer is None else answer.report)


def _is_read(subject: Subject, owner: bridge.Bridge) -> bool:
    """Whether all that the bridge may send is known."""
    carried = [each.map for each in owner.bridgeConnections]
    elements = [each.element for each in owner.actionConnections]
    drivers = [each.driver for each in owner.actionConnections]
    messages = [each.message for each in (*carried, *elements) if each is not None]
    return subject.is_intact(*carried, *elements, *drivers, *messages, *owner.serviceConnections)
