"""Quick fixes of what is wrong with attribute maps: paths, conversions, policies, headers."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from jausml.authoring.editing.commands import Add, Remove, Set
from jausml.authoring.proposals.quick_fixes.found import (
    Fixer,
    Found,
    QuickFix,
    renamed_as_meant,
    unset,
)
from jausml.language.metamodel.classes import bridge
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.names import around, name_of
from jausml.language.semantics.conversions import CONVERSIONS
from jausml.language.semantics.names import snake_case
from jausml.language.semantics.paths.jaus_paths import JausPlace
from jausml.language.semantics.paths.ros_paths import RosPlace
from jausml.language.semantics.paths.scopes import place

_MISSING = re.compile(r"has no (?:attribute|field) '([^']*)'")
_HEADER = re.compile(r"([\w.]+\.(?:stamp|frame_id))")


def path(finding: Found) -> Iterator[QuickFix]:
    """Writes the member that is meant into a path."""
    side, _, rest = finding.message.partition(" ")
    wrong = _MISSING.search(finding.message)
    if side not in ("source", "target") or wrong is None or not finding.meant:
        return
    text, own = str(getattr(finding.element, side)), re.match(r"'([^']*)'", rest)
    if own is None:
        return
    fitting = _with_step(own[1], wrong[1], finding.meant[0])
    if not _is_found(finding.element, fitting, is_source=side == "source"):
        return
    paths = [fitting if word.strip() == own[1] else word.strip() for word in text.split(",")]
    yield finding.set(f"write {finding.meant[0]}", side, ", ".join(paths))


def _with_step(whole: str, wrong: str, meant: str) -> str:
    start = "/" if whole.startswith("/") else ""
    steps = whole.removeprefix("/").split(".")
    return start + ".".join(
        meant + step[len(wrong) :] if step.partition("[")[0] == wrong else step for step in steps
    )


def _is_found(assignment: bridge.Assignment, path: str, *, is_source: bool) -> bool:
    """Tells whether a path leads somewhere from where an assignment stands."""
    map_ = around(assignment, bridge.AttributeMap)
    placed = None
    if map_ is not None and map_.message is not None and map_.type is not None:
        placed = place(map_, assignment, to_ros=_to_ros(assignment))
    if placed is None:
        return False
    scope = placed.scope
    path_place = scope.find_source(path) if is_source else scope.find_target(path)
    return isinstance(path_place, JausPlace | RosPlace) and bool(path_place.attribute().kind)


def _to_ros(assignment: bridge.Assignment) -> bool:
    around: EObject | None = assignment
    while around is not None and not isinstance(around.eContainer(), bridge.AttributeMap):
        around = around.eContainer()
    feature = around.eContainmentFeature() if around is not None else None
    return feature is not None and feature.name in ("toRos", "stopRos")


def conversion(finding: Found) -> Iterator[QuickFix]:
    """Adds, leaves out or exchanges the conversion that the rule names."""
    names = [match for match in re.findall(r"\w+", finding.hint) if match in CONVERSIONS]
    if isinstance(finding.element, bridge.Conversion):
        if finding.hint.startswith("use ") and names:
            yield finding.set(f"use {names[0]}", "kind", names[0])
        return
    if not isinstance(finding.element, bridge.FieldAssignment) or len(names) != 1:
        return
    [name] = names
    if finding.hint.startswith("leave out"):
        gone = [step for step in finding.element.conversions if step.kind.name == name]
        if gone:
            yield QuickFix(f"leave out {name}", (Remove(finding.scope.ref(gone[-1])),))
    elif finding.hint.startswith(("add the conversion", "convert it by")):
        values = {"kind": (name,)}
        add = Add(finding.ref, "conversions", "bridge.Conversion", values)
        yield QuickFix(f"convert it by {name}", (add,))


def absent(finding: Found) -> Iterator[QuickFix]:
    """States a policy for a target without its source: the likeliest comes first."""
    if "whenStale" in finding.hint:
        yield from stale_join(finding)
    if "receptionTime" in finding.hint:
        yield finding.set("take the time of reception then", "whenAbsent", "receptionTime")
    yield finding.set("drop the message then", "whenAbsent", "dropMessage")
    yield finding.set("leave its default on purpose", "whenAbsent", "leave")


def out_of_range(finding: Found) -> Iterator[QuickFix]:
    """States a policy for values that do not fit."""
    if "outOfRange" in finding.table.features:
        words = "move them to the end of the range"
        if finding.diagnostic.rule == "JML418":
            yield finding.set("drop the message then", "outOfRange", "dropMessage")
        else:
            yield finding.set(words, "outOfRange", "clamp")


def default_value(finding: Found) -> Iterator[QuickFix]:
    """Uses a default that is stated, or asks for none."""
    if "is not used" in finding.message:
        yield finding.set("use it", "whenAbsent", "useDefault")
    elif "has no defaultValue" in finding.message:
        yield finding.set("drop the message then", "whenAbsent", "dropMessage")


def ignored(finding: Found) -> Iterator[QuickFix]:
    """Leaves out a required member on purpose."""
    if "Ignore" in finding.hint and finding.quoted:
        target = finding.quoted[0]
        feature = "assignments" if isinstance(finding.element, bridge.ListAssignment) else "toJaus"
        add = Add(finding.ref, feature, "bridge.Ignore", {"target": (target,)})
        yield QuickFix(f"leave {target} out on purpose", (add,))


def header(finding: Found) -> Iterator[QuickFix]:
    """Stamps a message by the clock, and leaves out its frame on purpose."""
    words, commands = [], []
    for target in _HEADER.findall(finding.message):
        is_stamp = target.endswith(".stamp")
        kind = "bridge.ClockAssignment" if is_stamp else "bridge.Ignore"
        words.append(f"{target} by the clock" if is_stamp else f"leave out {target}")
        commands.append(Add(finding.ref, "toRos", kind, {"target": (target,)}))
    if commands:
        yield QuickFix(", ".join(words), tuple(commands))


def repeated(finding: Found) -> Iterator[QuickFix]:
    """Removes a repetition."""
    if finding.message.endswith("is assigned already"):
        yield QuickFix("take this assignment away", (Remove(finding.ref),))


def frame_id(finding: Found) -> Iterator[QuickFix]:
    """Writes the id of a frame without a slash."""
    value = str(finding.element.value).lstrip("/")
    yield finding.set(f"write {value}", "value", value)


def arguments(finding: Found) -> Iterator[QuickFix]:
    """Leaves out what a conversion does not take."""
    if "takes no arguments" in finding.message or re.match(r"\w+ has no \w+$", finding.message):
        yield from unset(finding)


def table_entry(finding: Found) -> Iterator[QuickFix]:
    """Takes away an entry that never counts."""
    if "stand in earlier entries" in finding.message:
        yield QuickFix("take this entry away", (Remove(finding.ref),))


def unused_join(finding: Found) -> Iterator[QuickFix]:
    """Removes a join that no assignment uses, or gives one a topic."""
    if finding.message.startswith("no assignment takes anything of"):
        feeding = (
            topic
            for connection in finding.scope.model.instances(bridge.Connection, library=False)
            for topic in connection.topics
            if topic.join is finding.element
        )
        topics = (Remove(finding.scope.ref(topic)) for topic in feeding)
        yield QuickFix("take the join away", (*topics, Remove(finding.ref)))
    elif isinstance(finding.element, bridge.Connection) and finding.hint.startswith("add a topic"):
        name = finding.quoted[-1]
        for join in finding.element.map.joins:
            if join.name == name:
                values = {"name": (name,), "join": (finding.scope.ref(join),)}
                add = Add(finding.ref, "topics", "bridge.Topic", values)
                yield QuickFix(f"add a topic {name} for it", (add,))


def stale_join(finding: Found) -> Iterator[QuickFix]:
    """Drops messages without a fresh message of a join."""
    map_ = around(finding.element, bridge.AttributeMap)
    for join in (*map_.joins, *map_.reportJoins) if map_ is not None else ():
        if name_of(join) in finding.quoted[-1:]:
            ref = finding.scope.ref(join)
            commands = (Set(ref, "whenStale", ("dropMessage",)),)
            yield QuickFix(f"drop the message without a fresh {join.name}", commands)


def quantity(finding: Found) -> Iterator[QuickFix]:
    """Sets unit or name of a quantity to those of the overridden one, or removes it."""
    if finding.hint.startswith("state it in "):
        unit = finding.hint.removeprefix("state it in ")
        yield finding.set(f"state it in {unit}", "units", unit)
    elif finding.hint.startswith("they have ") and "," not in finding.hint:
        name = finding.hint.removeprefix("they have ")
        yield finding.set(f"name it {name}", "name", name)
    elif finding.hint == "take it away":
        yield QuickFix(finding.hint, (Remove(finding.ref),))


def method(finding: Found) -> Iterator[QuickFix]:
    """Writes the name of a method as Python has it."""
    name = snake_case(str(finding.element.method))
    if "is no name" in finding.message and name and name != finding.element.method:
        yield finding.set(f"name it {name}", "method", name)


def precision(finding: Found) -> Iterator[QuickFix]:
    """Leaves out a precision that is none."""
    if finding.message.endswith("is no distance"):
        yield from unset(finding)


QUICK_FIXES: Mapping[str, Fixer] = {
    "JML411": path,
    "JML412": conversion,
    "JML413": default_value,
    "JML414": arguments,
    "JML415": repeated,
    "JML416": ignored,
    "JML417": out_of_range,
    "JML418": out_of_range,
    "JML431": conversion,
    "JML432": renamed_as_meant,
    "JML433": conversion,
    "JML434": out_of_range,
    "JML436": precision,
    "JML438": conversion,
    "JML440": table_entry,
    "JML441": renamed_as_meant,
    "JML442": unused_join,
    "JML444": renamed_as_meant,
    "JML445": quantity,
    "JML446": method,
    "JML458": conversion,
    "JML459": absent,
    "JML460": header,
    "JML461": frame_id,
    "JML494": unused_join,
}
"""The quick fixes by rule."""
