"""Changes of features of elements, what undoes each, and what else could stand in a feature."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from jausml.language.attributes.units import UnitError, conversion_between, parse_unit
from jausml.language.metamodel import FeatureTable
from jausml.language.metamodel.classes import bridge
from jausml.language.metamodel.filling import contents, is_set, unset
from jausml.language.semantics.paths.scopes import Placed, attribute_at

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

    def apply(self) -> Change:
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
        """Returns the change in words, before and after."""
        before, after = held(self.element, self.feature), self.value
        if self.feature.many:
            before, after = _differing(before, after)
        return f"{self.feature.name}: {_shown(before)} -> {_shown(after)}"


@dataclass(frozen=True, eq=False)
class Together:
    """Changes that are made at once, such as one mistake in both directions."""

    changes: tuple[Change | Together, ...]

    @property
    def element(self) -> Any:
        """The element of the first one."""
        return self.changes[0].element

    def apply(self) -> Together:
        """Makes the changes, and returns those that undo them."""
        return Together(tuple(change.apply() for change in self.changes)[::-1])

    def words(self) -> str:
        """Returns all changes in words."""
        return "; ".join(change.words() for change in self.changes)


def held(element: Any, feature: FeatureTable) -> Any:
    """Returns the value of a feature; a list where it has many values."""
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
        text = ", ".join(_shown(item) for item in value)
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


@dataclass(frozen=True)
class Site:
    """A feature of an element that an operator may change."""

    element: Any
    feature: FeatureTable
    placed: Placed[Any] | None

    @cached_property
    def value(self) -> Any:
        """The value of the feature; a list where it has many values."""
        return held(self.element, self.feature)


_UNITS = (
    *("millimeter", "kilometer per hour", "degree", "degree per second", "millisecond", "hour"),
    *("kilonewton", "gram", "degree Fahrenheit", "kilopascal", "millivolt", "milliampere"),
    *("kilohertz", "kilowatt", "liter", "1"),
)


def other_unit(site: Site) -> Iterator[Any]:
    """Yields the first unit that measures the same by another factor."""
    try:
        unit = parse_unit(site.value or "")
    except UnitError:
        return
    for candidate in _UNITS:
        try:
            if conversion_between(unit, parse_unit(candidate)) != (1.0, 0.0):
                yield candidate
                return
        except ValueError:  # another dimension
            continue


def other_member(site: Site) -> Iterator[Any]:
    """Yields the path of the next member of the same kind beside the one of a path."""
    if site.placed is None or not site.value or "," in site.value:
        return
    scope, is_source = site.placed.scope, site.feature.name == "source"
    find = scope.find_source if is_source else scope.find_target
    before, dot, name = site.value.rpartition(".")
    owner = find(before or ".")
    own = attribute_at(find(site.value))
    names = [str(member.name) for member in _members(owner)]
    if name not in names:
        return
    at = names.index(name)
    for sibling in names[at + 1 :] + names[:at]:
        other = attribute_at(find(f"{before}{dot}{sibling}"))
        if _is_alike(own, other):
            yield f"{before}{dot}{sibling}"
            return


def _members(owner: Any) -> list[Any]:
    if callable(getattr(owner, "members", None)):
        return list(owner.members() or ())
    kind = getattr(owner, "type", None)
    return list(kind.fields) if kind is not None else []


def _is_alike(one: Any, other: Any) -> bool:
    """Whether one attribute can stand where the other does."""
    same = ("kind", "integral", "named", "units")
    return bool(getattr(one, "kind", "")) and all(
        getattr(one, field, None) == getattr(other, field, None) for field in same
    )


def next_entry(site: Site) -> Iterator[Any]:
    """Yields the value of the next entry of a table."""
    entries = list(site.element.eContainer().entries)
    after = entries[(entries.index(site.element) + 1) % len(entries)]
    yield getattr(after, site.feature.name)


def _exchange(site: Site, one: Any, other: Any) -> tuple[Change, Change]:
    """Returns the changes that exchange the values of two elements."""
    feature = site.feature
    first, second = held(one, feature), held(other, feature)
    return Change(one, feature, second), Change(other, feature, first)


def exchanged_entries(site: Site) -> Iterator[Together]:
    """Yields the exchange of the values of an entry of a table and of the one behind it."""
    entries = list(site.element.eContainer().entries)
    at = entries.index(site.element) + 1
    if at < len(entries):
        yield Together(_exchange(site, site.element, entries[at]))


def partner(placed: Placed[Any] | None) -> Any:
    """Returns the assignment to JAUS that is the way back of one to ROS; None without one."""
    if placed is None or not placed.scope.to_ros or placed.scope.is_nested:
        return None
    goes = placed.assignment
    candidates = (
        back
        for back in placed.scope.map.toJaus
        if isinstance(back, bridge.FieldAssignment)
        and (back.source, back.target) == (goes.target, goes.source)
    )
    return next(candidates, None)


def crossed_members(site: Site) -> Iterator[Together]:
    """Yields the exchange of the targets of two assignments alike, and of their ways back."""
    placed = site.placed
    back = partner(placed)
    if placed is None or back is None:
        return
    siblings = list(placed.scope.map.toRos)
    own = attribute_at(placed.scope.find_target(site.value))
    for other in siblings[siblings.index(site.element) + 1 :]:
        if not isinstance(other, bridge.FieldAssignment):
            continue
        its = partner(Placed(other, placed.scope))
        if its is not None and _is_alike(own, attribute_at(placed.scope.find_target(other.target))):
            pairs = (site.element, other), (back, its)
            yield Together(tuple(change for way in pairs for change in _exchange(site, *way)))
            return


def other_state(site: Site) -> Iterator[Any]:
    """Yields the target of another transition of the same machine, the next one."""
    if not site.value:
        return
    machine = site.element
    while machine.eClass.name != "StateMachine":
        machine = machine.eContainer()
    targets = sorted(
        {element.target for element in machine.eAllContents() if getattr(element, "event", 0) != 0}
        - {None}
    )
    at = targets.index(site.value)
    yield targets[(at + 1) % len(targets)]
