"""What new elements leave to their author, and how a model keeps what a person has to decide."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import Child
from jausml.language.validation.rules.bridge.maps import decisions_made

if TYPE_CHECKING:
    from collections.abc import Iterable

_OWN_RULE = decisions_made.id


@dataclass(frozen=True, slots=True)
class OpenPoint:
    """Something of a new element that its author should know.

    Attributes:
        rule: The rule that reports it until it is decided. Without one nothing has to be decided:
            the model says it by itself.
        is_blocking: Whether a safety or a meaning hangs on an open decision of the model.
    """

    text: str
    rule: str = ""
    is_blocking: bool = False

    def __str__(self) -> str:
        said = f"{self.rule}, blocking" if self.is_blocking else self.rule
        return f"{self.text} ({said})" if said else self.text


def blocking(text: str) -> OpenPoint:
    """Returns a decision on which a safety or the meaning of a value hangs."""
    return OpenPoint(text, _OWN_RULE, is_blocking=True)


def pending(text: str) -> OpenPoint:
    """Returns a decision that can wait: what holds until then does no harm."""
    return OpenPoint(text, _OWN_RULE)


def open_decisions(points: Iterable[OpenPoint]) -> tuple[Child, ...]:
    """Returns the open decisions of a model: what no other rule reports."""
    return tuple(
        Child(
            "openDecisions",
            "bridge.OpenDecision",
            {"text": (each.text,)} | ({} if each.is_blocking else {"blocking": ("false",)}),
        )
        for each in points
        if each.rule == _OWN_RULE
    )
