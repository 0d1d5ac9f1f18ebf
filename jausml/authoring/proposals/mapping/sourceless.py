"""Members that are filled without a source: by a constant, by the clock, or not at all."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import Child
from jausml.authoring.proposals.mapping.assignments import filling
from jausml.authoring.proposals.mapping.statements import statement
from jausml.authoring.proposals.mapping.trial import judge
from jausml.authoring.proposals.options import Option, Options

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.authoring.proposals.elements import Scope
    from jausml.authoring.proposals.mapping.members import Member
    from jausml.language.metamodel.classes import bridge


def constant(scope: Scope, used: bridge.AttributeMap, target: Member, value: str) -> Options:
    """Returns how a member becomes a constant, or why it cannot have the value."""
    values = {"target": (target.inner,), "value": (value,)}
    return _sourceless(scope, used, target, "bridge.ConstantAssignment", values, "constant")


def clock(scope: Scope, used: bridge.AttributeMap, target: Member) -> Options:
    """Returns how a member becomes the present time, or why it cannot."""
    return _sourceless(
        scope, used, target, "bridge.ClockAssignment", {"target": (target.inner,)}, "present time"
    )


def ignore(scope: Scope, used: bridge.AttributeMap, target: Member) -> Options:
    """Returns how a member is left out on purpose."""
    return _sourceless(
        scope, used, target, "bridge.Ignore", {"target": (target.inner,)}, "leave out"
    )


def _sourceless(
    scope: Scope,
    used: bridge.AttributeMap,
    target: Member,
    kind: str,
    values: Mapping[str, tuple[str, ...]],
    label: str,
) -> Options:
    feature = "toJaus" if target.is_jaus else "toRos"
    if target.outer:
        return Options(refusal=f"'{target.path}' is of each element of '{target.outer}'")
    child = Child(feature, kind, values)
    [found] = judge(scope.model.metamodels, used, [child])
    if not found.is_possible:
        return Options(refusal=found.said)
    commands = filling(scope, used, child, None, target, feature)
    return Options((Option(label, found.said or label, statement(child), commands, is_best=True),))
