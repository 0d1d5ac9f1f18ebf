"""Rule about decisions that a person has yet to make."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.language.model.diagnostics import Severity
from jausml.language.validation.rule import Finding, rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.semantics.subject import Subject


@rule("JML498", Severity.ERROR, "decision that is open", is_decision=True)
def decisions_made(subject: Subject) -> Iterator[Finding]:
    """No decision of a map or connection is open.

    No tool can make it, since it depends on the vehicle. It is an error where a safety or the
    meaning of a value hangs on it, and a warning with `blocking` false. Decide, write that into
    the model, and remove the open decision.

    Bad: `<openDecisions text="state the top speed of the vehicle, instead of 1"/>`

    Good: no such element, and the top speed in the map
    """
    for each in subject.instances(bridge.OpenDecision, needs=("text", "blocking")):
        if each.text is None:
            continue
        owner = each.eContainer()
        place = f" in '{owner.name}'" if isinstance(owner, bridge.DecisionOwner) else ""
        severity = None if each.blocking else Severity.WARNING
        hint = "decide it, then remove the open decision"
        yield Finding(each, f"open{place}: {each.text}", "text", hint, severity=severity)
