"""Assignments in words, as people say them on a command line: a target, and what fills it.

Velocity_X                    a member of the other side, converted as the rules want it
Velocity_Y : negate           by these conversions; behind a bare colon, by none
Roll, Pitch, Yaw : frd_angles_to_flu_quaternion
"odom"    2.5    true         a constant
clock                         the present time
ignore                        nothing, on purpose
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import Child
from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.proposals.mapping.assigning import ways
from jausml.authoring.proposals.mapping.members import member
from jausml.authoring.proposals.mapping.statements import innermost
from jausml.authoring.proposals.mapping.trial import judge
from jausml.language.model.values import suggest
from jausml.language.semantics.conversions import CONVERSIONS

if TYPE_CHECKING:
    from jausml.authoring.proposals.elements import Scope
    from jausml.authoring.proposals.mapping.assigning import Ways
    from jausml.language.metamodel.classes import bridge

_FIELD = "bridge.FieldAssignment"
_SOURCELESS = {"clock": "bridge.ClockAssignment", "ignore": "bridge.Ignore"}
_CONSTANT = re.compile(r'"(?P<text>.*)"|(?P<plain>[-+]?\.?\d[^\s,:]*|true|false)', re.DOTALL)
_CALL = re.compile(r"(?P<name>\w+)\s*(?:\((?P<arguments>[^()]*)\))?\s*")


def assignments_of(
    scope: Scope, used: bridge.AttributeMap, target: str, source: str, *, to_ros: bool
) -> list[Child]:
    """Returns the ways to fill a target as words say, the likeliest first."""
    feature = "toRos" if to_ros else "toJaus"
    path, colon, chain = (each.strip() for each in source.partition(":"))
    if not colon and (plain := _sourceless(feature, target, source)) is not None:
        return [_allowed(scope, used, plain)]
    found = _ways(scope, used, target, path.partition(",")[0], to_ros=to_ros)
    known = [] if found is None else [each.assignment for each in found.ways]
    if not colon and "," not in path:
        if found is not None and not known:
            raise AnswerError(f"{source} -> {target}: {found.refusal}")
        if known:
            return known
    values = {"target": (target,), "source": (path,)}
    child = Child(feature, _FIELD, values, _conversions(chain))
    alike = (each for each in known if words_of(each) == words_of(child))
    return [next(alike, None) or _allowed(scope, used, child)]


def words_of(child: Child) -> str:
    """Returns the words by which `assignments_of` gives an assignment of a field again."""
    inner = innermost(child)
    calls = []
    for each in inner.children:
        name, arguments = each.values["kind"][0], each.values.get("arguments", ())
        calls.append(f"{name}({', '.join(arguments)})" if arguments else name)
    return f"{inner.values['source'][0]} : {', '.join(calls)}".rstrip()


def _sourceless(feature: str, target: str, source: str) -> Child | None:
    """Returns an assignment without a source, None where the words name one."""
    values: dict[str, tuple[str, ...]] = {"target": (target,)}
    if source in _SOURCELESS:
        return Child(feature, _SOURCELESS[source], values)
    if constant := _CONSTANT.fullmatch(source):
        text = constant["plain"] if constant["text"] is None else constant["text"]
        return Child(feature, "bridge.ConstantAssignment", {**values, "value": (text,)})
    return None


def _ways(
    scope: Scope, used: bridge.AttributeMap, target: str, source: str, *, to_ros: bool
) -> Ways | None:
    """Returns the ways from member to member; None for paths with an index."""
    try:
        start = member(used, source, is_jaus=to_ros)
        end = member(used, target.partition(",")[0], is_jaus=not to_ros)
    except AnswerError:
        return None
    return ways(scope, used, start, end)


def _conversions(text: str) -> tuple[Child, ...]:
    found: list[Child] = []
    rest = text.strip()
    while rest:
        call = _CALL.match(rest)
        if call is None or call["name"] not in CONVERSIONS:
            name = call["name"] if call else rest
            hint = suggest(name, CONVERSIONS)
            raise AnswerError(f"there is no conversion {name!a}{f'; {hint}' if hint else ''}")
        values: dict[str, tuple[str, ...]] = {"kind": (call["name"],)}
        if arguments := tuple(each.strip() for each in (call["arguments"] or "").split(",")):
            values |= {"arguments": arguments} if any(arguments) else {}
        found.append(Child("conversions", "bridge.Conversion", values))
        rest = rest[call.end() :].lstrip(", ")
    return tuple(found)


def _allowed(scope: Scope, used: bridge.AttributeMap, child: Child) -> Child:
    [judged] = judge(scope.model.metamodels, used, [child])
    if not judged.is_possible:
        raise AnswerError(judged.said)
    return child


def shown(words: str) -> str:
    """Returns words as people read them where they choose."""
    return f"{words.removesuffix(' :')} as it is" if words.endswith(":") else words
