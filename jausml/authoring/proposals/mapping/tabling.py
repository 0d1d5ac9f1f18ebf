"""Tables: they map values by their names, where both ends name them and number them otherwise."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import NEW, Add, Child
from jausml.authoring.proposals.fresh import free_name
from jausml.language.semantics.conversions.authored import LookUp
from jausml.language.semantics.paths.attributes import compared, table_entries
from jausml.language.semantics.paths.jaus_paths import JausPlace
from jausml.language.semantics.paths.ros_paths import RosPlace
from jausml.language.semantics.paths.scopes import outer_scope

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from jausml.language.metamodel.classes import bridge
    from jausml.language.model.refs import Ref
    from jausml.language.semantics.paths.attributes import Comparison

_TABLES, _TABLE = "tables", "table"

Pairs = tuple[tuple[str, str], ...]
"""The entries of a table: names of JAUS and of ROS."""


@dataclass(frozen=True)
class Tabled:
    """Assignments with the tables that they need.

    Attributes:
        assignments: All assignments; those by a table name it in their conversion.
    """

    tables: tuple[Child, ...]
    assignments: tuple[Child, ...]


def tabled(used: bridge.AttributeMap, assignments: Iterable[Child]) -> Tabled:
    """Has a table map what both ends of an assignment name alike and number otherwise.

    Args:
        assignments: Those that are to be. What lies in lists, or has conversions, stays as it is.
    """
    names = {each.name: _pairs_of(each) for each in used.tables}
    found, made = [], []
    for each in assignments:
        pairs = _needed(used, each)
        if not pairs:
            made.append(each)
            continue
        name = next((name for name, known in names.items() if known == pairs), "")
        if not name:
            jaus = "source" if each.feature == "toRos" else "target"
            name = free_name(each.values[jaus][0].rpartition(".")[2], names)
            names[name] = pairs
            found.append(_table(name, pairs))
        values = {"kind": (LookUp.name,), _TABLE: (name,)}
        conversion = Child("conversions", "bridge.Conversion", values)
        made.append(replace(each, children=(conversion,)))
    return Tabled(tuple(found), tuple(made))


def table_of(conversion: Child) -> str:
    """Returns the name of the table of a conversion that is to be, empty for one without."""
    return conversion.values.get(_TABLE, ("",))[0]


def additions(
    owner: Ref,
    tables: Sequence[Child],
    assignments: Iterable[Child],
    known: Iterable[tuple[str, Ref]],
    first: int,
) -> list[Add]:
    """Returns what adds tables to a map, and then the assignments, which refer to them.

    Args:
        first: How many elements the batch of commands has made before.
    """
    refs = dict(known)
    refs |= {each.values["name"][0]: f"{NEW}{first + at}" for at, each in enumerate(tables)}
    children = (*tables, *(_referring(each, refs) for each in assignments))
    return [Add(owner, each.feature, each.kind, each.values, each.children) for each in children]


def _referring(child: Child, refs: dict[str, Ref]) -> Child:
    steps = tuple(
        replace(each, values={**each.values, _TABLE: (refs[name],)})
        if (name := table_of(each))
        else each
        for each in child.children
    )
    return replace(child, children=steps)


def _needed(used: bridge.AttributeMap, child: Child) -> Pairs:
    """Returns the entries that an assignment needs; none where the numbers mean the same."""
    if child.kind != "bridge.FieldAssignment" or child.children:
        return ()
    to_ros = child.feature == "toRos"
    found = _compared(used, child.values["source"][0], child.values["target"][0], to_ros=to_ros)
    if found is None or not (found.renumbered and found.is_of_one_enumeration):
        return ()
    return tuple((jaus.name, ros.name) for jaus, ros in table_entries(found, to_ros=to_ros))


def _compared(
    used: bridge.AttributeMap, source: str, target: str, *, to_ros: bool
) -> Comparison | None:
    scope = outer_scope(used, to_ros=to_ros)
    ends = [scope.find_source(source), scope.find_target(target)]
    places = [each for each in ends if isinstance(each, JausPlace | RosPlace)]
    return compared(*(each.attribute() for each in places)) if len(places) == len(ends) else None


def _pairs_of(table: bridge.ValueTable) -> Pairs:
    return tuple((each.jaus, each.ros) for each in table.entries)


def _table(name: str, pairs: Pairs) -> Child:
    entries = (
        Child("entries", "bridge.TableEntry", {"jaus": (jaus,), "ros": (ros,)})
        for jaus, ros in pairs
    )
    return Child(_TABLES, "bridge.ValueTable", {"name": (name,)}, tuple(entries))
