"""What comes back for a command: its confirmation or rejection, and the report of what it sets."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.semantics.jaus.answers import Answer, answer_by, named
from jausml.language.semantics.jaus.core_services import CORE
from jausml.language.semantics.jaus.inherited_machines import states_of
from jausml.language.semantics.jaus.services import lineage, same_code

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.metamodel.classes import jaus

_REJECTING = "Reject"
_ANSWERING = ("Confirm", _REJECTING)
_MANAGEMENT = f"{CORE}Management"


def responses(message: jaus.MessageDef, service: jaus.Service) -> list[jaus.MessageDef]:
    """Returns the messages with which who provides a service answers a command of it.

    Its machine says them. Most services of the standards have none here: then those that confirm or
    reject what the command is named after, as ConfirmElementRequest does for SetElement.
    """
    found = dict.fromkeys(_sent_by_machine(message, service))
    return list(found) or [
        each for each in service.outputs if (topic := _topic(each)) and topic in str(message.name)
    ]


def is_rejection(message: jaus.MessageDef) -> bool:
    """Tells whether an answer says that what was asked for is not done."""
    return str(message.name).startswith(_REJECTING)


def told_after(message: jaus.MessageDef, service: jaus.Service) -> Answer | None:
    """Returns the query and the report that tell what a command has set; None without any.

    The commands of Management set the state of a component, SetX what QueryX asks for.
    """
    topic = "Status" if service.urn == _MANAGEMENT else str(message.name).removeprefix("Set")
    report = named(f"Report{topic}", (m for each in lineage(service) for m in each.outputs))
    return answer_by(service, report)


def _sent_by_machine(message: jaus.MessageDef, service: jaus.Service) -> Iterator[jaus.MessageDef]:
    for machine in service.machines:
        for _, state in states_of(machine):
            for each in (*state.transitions, *state.defaults):
                if each.message is not None and same_code(each.message, message):
                    yield from (done.sends for done in each.actions if done.sends is not None)


def _topic(answer: jaus.MessageDef) -> str:
    """Returns what an answer confirms or rejects by its name; empty when it does neither."""
    name = str(answer.name)
    verb = next((each for each in _ANSWERING if name.startswith(each)), None)
    return "" if verb is None else name.removeprefix(verb).removesuffix("Request")
