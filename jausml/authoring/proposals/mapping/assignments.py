"""Assignments as commands: each stands in the place of what fills the same member."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import Remove
from jausml.authoring.proposals.mapping.statements import innermost
from jausml.authoring.proposals.mapping.tabling import additions
from jausml.language.metamodel.classes import bridge
from jausml.language.model.names import name_of
from jausml.language.semantics.paths import parse_path, source_paths, target_paths

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.authoring.editing.commands import Child, Command
    from jausml.authoring.proposals.elements import Scope
    from jausml.authoring.proposals.mapping.members import Member


def filling(
    scope: Scope,
    used: bridge.AttributeMap,
    child: Child,
    source: Member | None,
    target: Member,
    feature: str,
    tables: Sequence[Child] = (),
) -> tuple[Command, ...]:
    """Returns what adds an assignment, in the place of what fills the same.

    Args:
        feature: The direction: `toRos` or `toJaus`.
    """
    owner: bridge.AttributeMap | bridge.ListAssignment = used
    if source is not None and source.outer:
        around = _list_of(used, source, target, feature)
        if around is not None:
            owner, child, feature = around, innermost(child), "assignments"
    known = [(name_of(each), scope.ref(each)) for each in used.tables]
    adds = additions(scope.ref(owner), tables, [child], known, 0)
    filled = {parse_path(each) for each in child.values["target"][0].split(", ")}
    gone = [
        each
        for each in getattr(owner, feature)
        if any(parse_path(path) in filled for path in target_paths(each))
    ]
    # What is added stands behind what goes, whose places so stay until it goes.
    return (*adds, *(Remove(scope.ref(each)) for each in reversed(gone)))


def _list_of(
    used: bridge.AttributeMap, source: Member, target: Member, feature: str
) -> bridge.ListAssignment | None:
    """Returns the assignment of the lists in which two members lie, if there is one."""
    for each in getattr(used, feature):
        if isinstance(each, bridge.ListAssignment):
            ends = source_paths(each)[:1], target_paths(each)[:1]
            if ends == ([source.outer], [target.outer]):
                return each
    return None
