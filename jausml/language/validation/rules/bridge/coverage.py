"""Rules about coverage: no attribute is assigned twice, nothing required is left out."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from typing import TypeAlias

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.connections.stops import with_constants
from jausml.language.semantics.paths.attributes import JausPart
from jausml.language.semantics.paths.jaus_paths import JausPlace
from jausml.language.semantics.paths.scopes import Direction, Placed, parse_path, target_paths
from jausml.language.semantics.paths.wholes import PathPlace
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, Note, rule

Owner: TypeAlias = "bridge.AttributeMap | bridge.Stop | bridge.ListAssignment | bridge.Connection"

Steps = tuple[str, ...]
_STOPS = {"safeValue": "safe value", "values": "stop"}


@rule("JML415", "target assigned twice", kinds=Direction)
def targets_unique(_: Subject, direction: Direction) -> Iterator[Finding]:
    """An attribute is the target of one assignment of a direction.

    An assignment of a whole, such as `pose.orientation`, and one of a part of it, such as
    `pose.orientation.w`, exclude each other; so do an assignment and an Ignore, and assignments to
    two options of one variant or to two alternatives of one variable field.

    Bad: two assignments with `target="twist.linear.x"`

    Good: one
    """
    for siblings in _siblings(direction):
        yield from _repeated(siblings)
        if not direction.to_ros:
            yield from _chosen_twice(siblings)


@rule(
    "JML416",
    "required JAUS field not assigned",
    severity=Severity.WARNING,
    is_decision=True,
    kinds=Direction,
)
def required_fields(subject: Subject, direction: Direction) -> Iterator[Finding]:
    """Each member of a JAUS message that is not optional is assigned, or ignored on purpose.

    It is always on the wire, with the smallest legal value if nothing is assigned. The members of a
    record, of an option or of a list element count once something in it is assigned. A safe value
    that sets some fields sets the required ones too.

    Bad: a map to SetTravelSpeed without an assignment to Speed

    Good: `<toJaus xsi:type="bridge:Ignore" target="Speed" documentation="..."/>`
    """
    if direction.to_ros or not direction.assignments or not subject.is_intact(direction.owner):
        return
    for siblings in _siblings(direction):
        scope = siblings[0].scope
        paths = [parse_path(path) for sibling in siblings for path, _ in sibling.targets]
        owner = siblings[0].assignment.eContainer()
        place = scope.target
        if owner is direction.owner and owner is not direction.map:
            paths += _filled_by_map(direction)
        if owner is not None and isinstance(place, JausPlace) and () not in paths:
            yield from _missing(owner, place, paths, direction)


def _filled_by_map(direction: Direction) -> list[Steps]:
    """Returns the paths that the map fills in a stop or safe value: constants and the clock."""
    constants = with_constants(direction.map, (), to_ros=False)
    return [parse_path(path) for constant in constants for path in target_paths(constant)]


def _siblings(direction: Direction) -> list[list[Placed[bridge.Assignment]]]:
    """The assignments of one owner each, in order."""
    assignments_by_owner: dict[EObject | None, list[Placed[bridge.Assignment]]] = {}
    for assignment in direction.assignments:
        assignments_by_owner.setdefault(assignment.assignment.eContainer(), []).append(assignment)
    return list(assignments_by_owner.values())


def _repeated(siblings: Sequence[Placed[bridge.Assignment]]) -> Iterator[Finding]:
    order = {id(sibling.assignment): number for number, sibling in enumerate(siblings)}
    assigned: dict[Steps, bridge.Assignment] = {}
    around: dict[Steps, bridge.Assignment] = {}  # the first assignment to a part of a path
    for sibling in siblings:
        for text, _ in sibling.targets:
            if not text:
                continue  # which leads nowhere
            path = parse_path(text)
            wholes = [path[:length] for length in range(len(path) + 1)]
            firsts = [assigned[whole] for whole in wholes if whole in assigned]
            firsts += [around[path]] if path in around else []
            if firsts:
                first = min(firsts, key=lambda other: order[id(other)])
                note = Note(first, f"'{first.target}'", "target")
                message = f"'{text}' is assigned already"
                yield Finding(sibling.assignment, message, "target", related=(note,))
            assigned.setdefault(path, sibling.assignment)
            for whole in wholes[:-1]:
                around.setdefault(whole, sibling.assignment)


def _chosen_twice(siblings: Iterable[Placed[bridge.Assignment]]) -> Iterator[Finding]:
    chosen: dict[str, tuple[str, bridge.Assignment]] = {}
    reported: set[tuple[str, str]] = set()
    for sibling in siblings:
        if isinstance(sibling.assignment, bridge.Ignore):
            continue
        for path in target_paths(sibling.assignment):
            for where, choice in _choices(sibling.scope.target, path):
                option, first = chosen.setdefault(where, (choice, sibling.assignment))
                if option != choice and (where, choice) not in reported:
                    reported.add((where, choice))
                    message = f"'{path}' selects {choice}, but {option} is selected already"
                    note = Note(first, f"'{first.target}'", "target")
                    yield Finding(sibling.assignment, message, "target", related=(note,))


def _choices(place: PathPlace, path: str) -> Iterator[tuple[str, str]]:
    """Yields the variants and variable fields on a path with what it takes of each."""
    steps = path.split(".")
    for position, step in enumerate(steps):
        before = ".".join(steps[:position])
        inner_place = place.follow(before or ".")
        if isinstance(inner_place, JausPlace) and _is_choice(inner_place.field):
            yield before, step


def _is_choice(field: EObject | None) -> bool:
    return isinstance(field, (jaus.Variant, jaus.VariableField, jaus.VariableFormatField))


def _missing(
    owner: Owner, place: JausPlace, paths: list[Steps], direction: Direction, before: str = ""
) -> Iterator[Finding]:
    """Yields findings for the required members of a place of which something is assigned."""
    is_choice = _is_choice(place.field)
    starting: defaultdict[str, list[Steps]] = defaultdict(list)
    for path in paths:
        starting[path[0] if path else ""].append(path)
    for field in place.members() or ():
        if not field.name:
            continue
        name = parse_path(field.name)
        beginning = starting[name[0]] if name else paths
        inner = [path[len(name) :] for path in beginning if path[: len(name)] == name]
        if not inner and not is_choice and not (isinstance(field, jaus.Field) and field.optional):
            yield _required(owner, f"{before}{field.name}", _feature(owner), direction)
        if inner and () not in inner:
            yield from _missing_inside(owner, place, field, inner, direction, before)


def _missing_inside(
    owner: Owner,
    place: JausPlace,
    field: JausPart,
    inner: list[Steps],
    direction: Direction,
    before: str,
) -> Iterator[Finding]:
    for index in sorted({path[0] for path in inner if path[0].startswith("[")} or {""}):
        inner_place = place.follow(f"{field.name}{index}")
        rest = [path[1:] if index else path for path in inner if path[0] == index or not index]
        if not isinstance(inner_place, JausPlace) or isinstance(inner_place.field, jaus.BitField):
            continue
        if () not in rest:
            name = f"{before}{field.name}{index}."
            yield from _missing(owner, inner_place, rest, direction, name)


def _required(owner: Owner, name: str, feature: str, direction: Direction) -> Finding:
    message = f"'{name}' of {direction.map.message.name} is required, but not assigned"
    if feature in _STOPS:
        message += f" in the {_STOPS[feature]}"
        return Finding(owner, message, feature, "assign it")
    return Finding(owner, message, feature, "assign it, or add an Ignore")


def _feature(owner: Owner) -> str:
    if isinstance(owner, bridge.ListAssignment):
        return "assignments"
    if isinstance(owner, bridge.Stop):
        return "values"
    return "safeValue" if isinstance(owner, bridge.Connection) else "toJaus"
