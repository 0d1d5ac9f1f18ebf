"""A feature of an element, and what else could stand there: members, units, states."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from jausml.language.attributes.units import UnitError, conversion_between, parse_unit
from jausml.mutating.changes import held

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.metamodel import FeatureTable
    from jausml.language.semantics.paths.scopes import Placed


@dataclass(frozen=True)
class Site:
    """A feature of an element that an operator may change."""

    element: Any
    feature: FeatureTable
    placed: Placed[Any] | None

    @cached_property
    def value(self) -> Any:
        """What the feature holds; a list where it has many values."""
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
    for each in _UNITS:
        try:
            if conversion_between(unit, parse_unit(each)) != (1.0, 0.0):
                yield each
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
    own = scope.followed.attribute(find(site.value))
    names = [str(each.name) for each in _members(owner)]
    if name not in names:
        return
    at = names.index(name)
    for each in names[at + 1 :] + names[:at]:
        other = scope.followed.attribute(find(f"{before}{dot}{each}"))
        if _is_alike(own, other):
            yield f"{before}{dot}{each}"
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
        getattr(one, each, None) == getattr(other, each, None) for each in same
    )


def next_entry(site: Site) -> Iterator[Any]:
    """Yields what the next entry of a table has."""
    entries = list(site.element.eContainer().entries)
    after = entries[(entries.index(site.element) + 1) % len(entries)]
    yield getattr(after, site.feature.name)


def other_state(site: Site) -> Iterator[Any]:
    """Yields the target of another transition of the same machine, the next one."""
    if not site.value:
        return
    machine = site.element
    while machine.eClass.name != "StateMachine":
        machine = machine.eContainer()
    targets = sorted(
        {each.target for each in machine.eAllContents() if getattr(each, "event", 0) != 0} - {None}
    )
    at = targets.index(site.value)
    yield targets[(at + 1) % len(targets)]
