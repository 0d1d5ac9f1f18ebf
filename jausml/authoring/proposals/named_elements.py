"""Maps that know the elements of a list by names, such as joints: each robot has its own."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import Add
from jausml.authoring.proposals.bridging import copied
from jausml.language.metamodel.classes import bridge
from jausml.language.model.names import name_of
from jausml.language.project.library import library

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.authoring.editing.commands import AddedT, Command
    from jausml.authoring.proposals.elements import Scope

_LIST = "bridge.ListAssignment"


def names_in(used: bridge.AttributeMap) -> list[str]:
    """Returns the names by which a map knows the elements of lists; none for most maps."""
    found = (name for each in (*used.toRos, *used.toJaus) for name in _names(each))
    return list(dict.fromkeys(found))


def _names(assignment: bridge.Assignment) -> Iterator[str]:
    if isinstance(assignment, bridge.ListAssignment):
        yield from assignment.names
        for each in assignment.assignments:
            yield from _names(each)


def are_examples(used: bridge.AttributeMap) -> bool:
    """Tells whether the names of a map are invented: with them, it would drop every message."""
    return bool(names_in(used)) and library().document_of(used) is not None


def copied_with_names(
    scope: Scope, place: str, used: bridge.AttributeMap, name: str, names: Sequence[str]
) -> list[Command]:
    """Returns what makes a copy of a map with other names of elements.

    Its test vectors have the names of the original, so that the copy is without.
    """
    about = (
        f"{', '.join(names)}: by these names in ROS, in this order in JAUS.\n\n"
        f"Made of the ready map {name_of(used)}."
    )
    made = copied(scope, place, used, name)
    return [
        replace(_with_names(each, names), values={**each.values, "documentation": (about,)})
        if isinstance(each, Add) and each.kind == "bridge.AttributeMap"
        else each
        for each in made
    ]


def _with_names(made: AddedT, names: Sequence[str]) -> AddedT:
    values = dict(made.values)
    if "names" in values:
        values["names"] = tuple(names)
    children = tuple(
        _with_names(each, names) for each in made.children if each.feature != "vectors"
    )
    return replace(made, values=values, children=children)
