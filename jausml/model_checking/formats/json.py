"""What was found, for programs."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from jausml.language.model.model import digests

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.language.model import Model
    from jausml.model_checking.checking import CounterExample, Outcome


def render(outcomes: Sequence[Outcome], model: Model) -> str:
    """Returns an object with all products and their counter-examples."""
    products = [_product(each, model) for each in outcomes]
    return json.dumps({"digests": digests(model), "products": products}, indent=2) + "\n"


def _product(outcome: Outcome, model: Model) -> dict[str, Any]:
    subject = outcome.subject
    return {
        "name": subject.name,
        "location": str(model.location(subject.element, None, 0)),
        "states": outcome.states,
        "transitions": outcome.transitions,
        "complete": outcome.is_complete,
        "tick": subject.tick,
        "stop_within": round(subject.product.bound * subject.tick, 3) or None,
        "held": subject.held or None,
        "found": [_found(each) for each in outcome.found],
        "allowed": [{"rule": e.diagnostic.rule, "reason": e.reason} for e in outcome.allowed],
    }


def _found(example: CounterExample) -> dict[str, Any]:
    return {
        "rule": example.rule,
        "message": example.message,
        "repeats": example.repeats,
        "steps": [
            {
                "seconds": each.seconds,
                "actor": each.step.actor,
                "what": each.step.what,
                "receiver": each.step.receiver or None,
            }
            for each in example.moments
        ],
    }
