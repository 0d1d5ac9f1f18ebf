"""Conflicts: where two sides of a merge do not go together."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

from jausml.language.model.diagnostics import RuleInfo

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.language.metamodel.classes.ecore import EObject

CHANGED_TWICE, GONE_HERE, LOST_TARGET, ELSEWHERE, AS_LINES = (
    "JML811",
    "JML812",
    "JML813",
    "JML814",
    "JML815",
)

_RULES = {
    CHANGED_TWICE: RuleInfo(
        "merge: changed on both sides",
        "Both sides of a merge gave an element other values of the same feature, changed the same "
        "assignment or scale, or added elements of the same name that differ. Our side is kept. "
        "Good: write the intended value, and commit.",
    ),
    GONE_HERE: RuleInfo(
        "merge: removed on one side, used on the other",
        "One side removed an element that the other side changed, or refers to. Our side is kept: "
        "the element stays if it is there, and stays away if it is not. Good: remove it and what "
        "refers to it, or keep it.",
    ),
    LOST_TARGET: RuleInfo(
        "merge: reference to what is not there",
        "The other side refers to an element that our side removed, so the merge could not apply "
        "this reference. Good: refer to another element.",
    ),
    ELSEWHERE: RuleInfo(
        "merge: references of another file do not follow",
        "Another file refers to elements of the merged file by their positions, which the merge "
        "shifts. Good: look at the references of that file; ids (xmi:id) do not shift.",
    ),
    AS_LINES: RuleInfo(
        "merge: merged as lines",
        "One of the three states cannot be read as a model, or has references that lead nowhere "
        "and do not name an id in another file, so the file was merged as git merges lines. Good: "
        "look at the result, and validate it.",
    ),
}

MERGE_RULES: Mapping[str, RuleInfo] = MappingProxyType(_RULES)
"""The rules of conflicts by id."""


@dataclass(frozen=True)
class Conflict:
    """A place where two sides of a merge do not go together.

    Attributes:
        feature: The feature, empty for the whole element.
        file: The file where another one is meant than that which is merged, else empty.
    """

    rule: str
    element: EObject
    message: str
    feature: str = ""
    file: str = ""
