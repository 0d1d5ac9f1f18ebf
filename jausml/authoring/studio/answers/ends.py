"""Ends of lines in the view of a map: which member a row stands for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.proposals.mapping.members import member
from jausml.language.metamodel.classes import bridge

if TYPE_CHECKING:
    from jausml.authoring.proposals.elements import Scope
    from jausml.authoring.proposals.mapping.members import Member

JAUS_END, ROS_END = "!jaus", "!ros"


def end_of(scope: Scope, used: bridge.AttributeMap, node: str, port: str) -> Member:
    """Returns the member that ids of the map view name."""
    if not port:
        raise AnswerError("draw from a member to a member")
    if node.endswith(JAUS_END):
        return member(used, port, is_jaus=True)
    if node.endswith(ROS_END):
        return member(used, port, is_jaus=False)
    for join in (*used.joins, *used.reportJoins):
        if scope.model.fragment(join) == node.rpartition("#")[2]:
            is_jaus = isinstance(join, bridge.ReportJoin)
            return member(used, f"{join.name}.{port}", is_jaus=is_jaus)
    raise AnswerError("that box is no end of the map")
