"""Changes of one feature of an element, each of which knows what undoes it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from jausml.language.metamodel.filling import contents, is_set, unset

if TYPE_CHECKING:
    from jausml.language.metamodel import FeatureTable

_LONGEST = 60


@dataclass(frozen=True, eq=False)
class Change:
    """A feature of an element that gets another value.

    Attributes:
        value: What the feature is to hold; a list of all its values where it has many.
        unsets: Whether the feature was not given its value before, which is its default then.
    """

    element: Any
    feature: FeatureTable
    value: Any
    unsets: bool = False

    def made(self) -> Change:
        """Makes the change, and returns the one that undoes it."""
        before = held(self.element, self.feature)
        was_set = is_set(self.element, self.feature)
        if self.feature.many:
            values = getattr(self.element, self.feature.name)
            values.clear()
            values.extend(self.value)
        else:
            setattr(self.element, self.feature.name, self.value)
        if self.unsets:
            unset(self.element, self.feature)
        return replace(self, value=before, unsets=not was_set)

    def words(self) -> str:
        """Says what changes, before and after."""
        before, after = held(self.element, self.feature), self.value
        if self.feature.many:
            before, after = _differing(before, after)
        return f"{self.feature.name}: {_shown(before)} -> {_shown(after)}"


def held(element: Any, feature: FeatureTable) -> Any:
    """Returns what a feature holds; a list where it has many values."""
    if feature.many:
        return list(contents(element, feature))
    return getattr(element, feature.name)


def _differing(before: list[Any], after: list[Any]) -> tuple[list[Any], list[Any]]:
    """Returns two lists without what they have in common at both ends."""
    while before and after and before[0] is after[0]:
        before, after = before[1:], after[1:]
    while before and after and before[-1] is after[-1]:
        before, after = before[:-1], after[:-1]
    return before, after


def _shown(value: Any) -> str:
    if isinstance(value, list):
        text = ", ".join(_shown(each) for each in value)
    elif hasattr(value, "eClass"):
        text = _named(value)
    else:
        text = "nothing" if value is None or value == "" else str(value)
    return (text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}...") or "nothing"


def _named(element: Any) -> str:
    """Returns a few words for an element, which mostly has a name, a kind or a target."""
    for feature in ("name", "target", "kind", "jaus", "guard", "topic"):
        value = getattr(element, feature, None)
        if value is not None and value != "":
            return str(value)
    return str(element.eClass.name)
