"""Rules about lists and about messages within messages."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.semantics.paths import scopes
from jausml.language.semantics.paths.attributes import LIST, TEXT, Attribute, PathFault
from jausml.language.semantics.paths.jaus_paths import JausPlace
from jausml.language.semantics.paths.ros_paths import RosPlace, is_sequence, ros_name
from jausml.language.semantics.paths.wholes import FoundPlace
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, Note, rule

_INDEX = re.compile(r"(.*)\[([0-9]{1,9})\]", re.DOTALL)


@rule("JML447", "list used wrongly", kinds=scopes.Direction)
def lists(_: Subject, direction: scopes.Direction) -> Iterator[Finding]:
    """A ListAssignment goes from a list or array to another.

    Elements that are matched by name have `keys`, a ROS sequence of texts, and `names`, each of
    which stands for one element on the JAUS side. Elements of a list or sequence that are targets
    by index begin with 0 and have no gap.

    Bad: `<toRos xsi:type="bridge:ListAssignment" target="header" source="WaypointList">`

    Good: `<toRos xsi:type="bridge:ListAssignment" target="poses" source="WaypointList">`
    """
    for placed in direction.of_kind(bridge.ListAssignment):
        yield from _end_findings(placed)
        yield from _name_findings(placed)
    yield from _gaps(direction)


@rule("JML443", "message in a message used wrongly", kinds=scopes.Direction)
def nested_messages(subject: Subject, direction: scopes.Direction) -> Iterator[Finding]:
    """A MessageAssignment leads between a field with a JAUS message and a ROS message of its map.

    The JAUS end is a field of variable length or format, the ROS end has the type of the map. The
    map has assignments for the direction and no joins, which only connections feed, and does not
    lead back to the map that uses it.

    Bad: `source="TimeStamp"` with a map of SetLocalWaypoint

    Good: `source="ElementData"`
    """
    for placed in direction.of_kind(bridge.MessageAssignment):
        map_ = placed.assignment.map
        if map_ is not None and subject.is_intact(map_.message, map_.type):
            yield from _message_findings(placed, map_, direction)


def _end_findings(placed: scopes.Placed[bridge.ListAssignment]) -> Iterator[Finding]:
    assignment = placed.assignment
    paths = [("target", *target) for target in placed.targets]
    paths += [("source", *source) for source in placed.sources[:1]]
    for feature, path, attribute in paths:
        find = placed.scope.find_target if feature == "target" else placed.scope.find_source
        if isinstance(attribute, Attribute) and not scopes.is_many(find(path)):
            message = f"'{path}' is {attribute.name}, no list and no array"
            yield Finding(assignment, message, feature)
    if len(placed.targets) > 1:
        yield Finding(assignment, "a ListAssignment has one target", "target")
    ends = [*placed.target_attributes, *placed.source_attributes[:1]]
    counts = {end.count for end in ends if end.kind == LIST and end.count is not None}
    if len(ends) == 2 and len(counts) == 2:
        message = f"'{assignment.source}' and '{assignment.target}' have different sizes"
        yield Finding(assignment, message, "target")


def _name_findings(placed: scopes.Placed[bridge.ListAssignment]) -> Iterator[Finding]:
    assignment = placed.assignment
    if bool(assignment.keys) != bool(assignment.names):
        message = f"'{assignment.target}' has {'keys' if assignment.keys else 'names'} alone"
        yield Finding(assignment, message, "keys" if assignment.keys else "names")
        return
    repeated = sorted({name for name in assignment.names if assignment.names.count(name) > 1})
    if repeated:
        message = f"{repeated[0]!r} stands twice among the names of '{assignment.target}'"
        yield Finding(assignment, message, "names")
    if not assignment.keys:
        return
    scope = placed.scope
    find = scope.find_target if scope.to_ros else scope.find_source
    place = find(assignment.keys)
    if isinstance(place, PathFault):
        message = f"keys '{assignment.keys}': {place.message}"
        yield Finding(assignment, message, "keys", place.hint)
    elif isinstance(place, RosPlace):
        element = place.element() if place.is_array else None
        if element is None or element.attribute().kind != TEXT:
            message = f"keys '{assignment.keys}' is {place.attribute().name}, no sequence of texts"
            yield Finding(assignment, message, "keys")


def _gaps(direction: scopes.Direction) -> Iterator[Finding]:
    seen: set[tuple[EObject | None, str]] = set()
    for placed in direction.assignments:
        for path in scopes.target_paths(placed.assignment):
            for start, index in _indexed_prefixes(path):
                owner = placed.assignment.eContainer()
                seen.add((owner, f"{start}[{index}]"))
                place = placed.scope.find_target(start)
                element = placed.scope.find_target(f"{start}[{index}]")
                if index == 0 or not _grows(place) or isinstance(element, PathFault):
                    continue
                if (owner, f"{start}[{index - 1}]") not in seen:
                    message = f"'{path}' comes before an assignment to {start}[{index - 1}]"
                    yield Finding(placed.assignment, message, "target", "begin with [0]")


def _grows(place: FoundPlace) -> bool:
    """Tells whether a place is a list that a message has as many elements of as it is given."""
    if isinstance(place, RosPlace):
        return place.field is not None and is_sequence(place.field)
    return isinstance(place, JausPlace) and isinstance(place.field, jaus.List)


def _indexed_prefixes(path: str) -> Iterator[tuple[str, int]]:
    steps = path.split(".")
    for position in range(len(steps)):
        match = _INDEX.fullmatch(".".join(steps[: position + 1]))
        if match is not None:
            yield match[1], int(match[2])


def _message_findings(
    placed: scopes.Placed[bridge.MessageAssignment],
    map_: bridge.AttributeMap,
    direction: scopes.Direction,
) -> Iterator[Finding]:
    assignment, to_ros = placed.assignment, direction.to_ros
    ends = {"source": placed.source_attributes, "target": placed.target_attributes}
    for feature, attributes in ends.items():
        path = getattr(assignment, feature)
        is_jaus = (feature == "source") == to_ros
        if len(attributes) > 1:
            yield Finding(assignment, f"a MessageAssignment has one {feature}", feature)
        elif attributes and is_jaus and not attributes[0].carries:
            message = f"'{path}' is {attributes[0].name}, which carries no JAUS message"
            yield Finding(assignment, message, feature)
        elif attributes and not is_jaus and attributes[0].kind != ros_name(map_.type):
            message = f"'{path}' is {attributes[0].name}, but map '{map_.name}' is for"
            note = Note(map_, f"map '{map_.name}'", "type")
            yield Finding(assignment, f"{message} {ros_name(map_.type)}", feature, related=(note,))
    yield from _map_findings(assignment, map_, direction)


def _map_findings(
    assignment: bridge.MessageAssignment, map_: bridge.AttributeMap, direction: scopes.Direction
) -> Iterator[Finding]:
    feature = "toRos" if direction.to_ros else "toJaus"
    note = Note(map_, f"map '{map_.name}'")
    if not _assignments(map_, feature):
        message = f"map '{map_.name}' has no {feature} assignments"
        yield Finding(assignment, message, "map", related=(note,))
    if map_.reportJoins if direction.to_ros else map_.joins:
        message = f"map '{map_.name}' has joins, which only a connection feeds"
        yield Finding(assignment, message, "map", related=(note,))
    if _leads_to(map_, direction.map, feature):
        message = f"map '{map_.name}' leads back to map '{direction.map.name}'"
        yield Finding(assignment, message, "map", related=(note,))


def _leads_to(start: bridge.AttributeMap, end: bridge.AttributeMap, feature: str) -> bool:
    seen: set[bridge.AttributeMap] = set()
    pending = [start]
    while pending:
        attribute_map = pending.pop()
        if attribute_map is end:
            return True
        if attribute_map not in seen:
            seen.add(attribute_map)
            pending += _maps_in(_assignments(attribute_map, feature))
    return False


def _assignments(attribute_map: bridge.AttributeMap, feature: str) -> Sequence[bridge.Assignment]:
    return attribute_map.toRos if feature == "toRos" else attribute_map.toJaus


def _maps_in(assignments: Sequence[bridge.Assignment]) -> Iterator[bridge.AttributeMap]:
    for assignment in assignments:
        if isinstance(assignment, bridge.MessageAssignment) and assignment.map is not None:
            yield assignment.map
        if isinstance(assignment, bridge.ListAssignment):
            yield from _maps_in(assignment.assignments)
