"""Rules about whom a component obeys: commands that anyone may give."""

from __future__ import annotations

from collections.abc import Iterator

from jausml.language.metamodel.classes import jaus
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.jaus.commands import (
    CONTROLLER,
    asks_for_controller,
    controlled_by_nobody,
    is_command,
    needs_control,
)
from jausml.language.semantics.jaus.inheritance import lineage
from jausml.language.semantics.jaus.inherited_machines import is_core_trigger
from jausml.language.semantics.jaus.machines import behaviours_of
from jausml.language.semantics.jaus.services import ACCESS_CONTROL
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, Note, rule


@rule("JML351", "command that anyone may give", severity=Severity.WARNING, kinds=jaus.Service)
def commands(subject: Subject, service: jaus.Service) -> Iterator[Finding]:
    """In a machine that extends the core, the guard says who may give a command.

    Without `isControllingClient` in each alternative of `||`, every component may. An independent
    machine needs no such guard: there, as without a machine, the component obeys only its
    controller, and mostly only in Ready.

    Bad: `<transitions message="SetSpeed" target="Moving"/>` in ReceiveFSM

    Good: the same with `guard="isControllingClient"`
    """
    for behaviour in behaviours_of(subject, service):
        inherited_names = {ancestor.name for ancestor in lineage(behaviour.service)}
        if not behaviour.machine.extends_core or ACCESS_CONTROL not in inherited_names:
            continue
        for _, transition in behaviour.transitions():
            message = transition.message
            if message is None or not is_command(message) or is_core_trigger(transition):
                continue
            if not asks_for_controller(transition.guard):
                text = f"the command {message.name} is obeyed from every component"
                yield Finding(transition, text, "guard", f"add {CONTROLLER} to the guard")


@rule(
    "JML362",
    "message that anybody may send beside commands",
    severity=Severity.WARNING,
    kinds=jaus.Service,
)
def controlled_alike(_: Subject, service: jaus.Service) -> Iterator[Finding]:
    """What makes a component do something is a command, where its service has others.

    A message with a code of 2000h and above is a command if it says so (`isCommand`), or is obeyed
    as one if each transition that takes it has the guard `isControllingClient`. Anybody may send
    another one, without control. Queries and reports are no commands.

    Bad: a service with the command FreeHatch and an input LockHatch without `isCommand`

    Good: `isCommand: true` of LockHatch, or its guard
    """
    for message in controlled_by_nobody(service):
        sibling = next(command for command in service.inputs if needs_control(command, service))
        text = f"anybody may send {message.name}, without control of the component"
        note = Note(sibling, f"{sibling.name} is obeyed from the controller alone")
        hint = f"say isCommand of it, or {CONTROLLER} in the guards that take it"
        yield Finding(message, text, "isCommand", hint, (note,))
