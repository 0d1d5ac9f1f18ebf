"""Rules about the value tables of maps."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from jausml.language.metamodel.classes import bridge, ros
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.conversions.authored import LookUp
from jausml.language.semantics.paths import attributes
from jausml.language.semantics.paths.markers import VALUE, is_said, marks_of
from jausml.language.semantics.paths.scopes import Direction, Placed
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, Note, rule

_VALUES = (attributes.NUMBER, attributes.BOOL, attributes.TEXT)
_MOST_NAMES = 5


@rule("JML440", "table that does not fit", kinds=Direction)
def tables(_: Subject, direction: Direction) -> Iterator[Finding]:
    """The entries of a table are values of what look_up reads and fills.

    An entry is a number, or the name of an enumerated JAUS value or of a constant of the ROS type,
    which means its number. Of several entries with one value the first counts; one whose values
    both stand in earlier entries is never found. Each enumerated value of the source should be in
    the table, and each constant of a ROS field that no marker takes for none, since one that is not
    drops the message. Where both ends name their values, a number that no constant of the ROS type
    has means nothing there.

    Bad: a table `OPEN <-> true` for a JAUS field with the values Opened and Closed

    Good: `Opened <-> true`, `Closed <-> false`
    """
    reported: set[tuple[EObject, str]] = set()
    for placed in direction.of_kind(bridge.FieldAssignment):
        for position, conversion in enumerate(placed.assignment.conversions):
            table = conversion.table
            if conversion.kind.name != LookUp.name or table is None:
                continue
            for finding in _findings(placed, position, table):
                key = (finding.element, finding.message)
                if key not in reported:
                    reported.add(key)
                    yield finding
    for looked in _looked_up(direction):
        for finding in _unnamed(looked):
            if (finding.element, finding.message) not in reported:
                reported.add((finding.element, finding.message))
                yield finding


@rule("JML448", "named value with another number", kinds=Direction)
def renumbered(_: Subject, direction: Direction) -> Iterator[Finding]:
    """What both ends of an assignment call alike has one number, or a table maps the names.

    Without a conversion numbers pass as they are. Where `CLOSED` is 0 in ROS and `closed` is 1 in
    JAUS, a closed gate would be told as something else. A table that is written leads each of
    these names to its namesake, by name or by number. Names are compared without case and
    separators; constants of a ROS type that begin with the name of a field belong to that field.
    On and off, enabled and disabled, yes and no are true and false to a bool whose name has no
    other meaning, open and closed to one that is called like one of them.

    Bad: `State -> state`, with open 0 and closed 1 in JAUS, CLOSED 0 and OPEN 1 in ROS

    Good: `State -> state : look_up(gate)` with `table gate ( open <-> OPEN  closed <-> CLOSED )`
    """
    for placed, comparison in _enumerated(direction):
        if wrong := comparison.renumbered:
            examples = ", ".join(
                f"{one.name} is {one.number} and {other.name} {other.number}"
                for one, other in wrong[:_MOST_NAMES]
            )
            table = attributes.table_text(comparison, to_ros=placed.scope.to_ros)
            yield Finding(
                placed.assignment,
                f"names that both ends have stand for other numbers: {examples}",
                "source",
                f"look_up a table ( {table} )",
            )
    for looked in _looked_up(direction):
        if astray := looked.astray:
            examples = ", ".join(
                f"{one.name} becomes {number:g}, but {other.name} is {other.number}"
                for one, other, number in astray[:_MOST_NAMES]
            )
            message = (
                f"table '{looked.table.name}' leads names astray that both ends have: {examples}"
            )
            meant = attributes.table_text(looked.ends, to_ros=looked.placed.scope.to_ros)
            yield Finding(looked.placed.assignment, message, "conversions", f"it is ( {meant} )")


@rule("JML449", "named value that drops the message", severity=Severity.WARNING, kinds=Direction)
def unmatched(_: Subject, direction: Direction) -> Iterator[Finding]:
    """Each named value of the source has a counterpart in the JAUS field that it fills.

    A message with another value is dropped when it comes, which nobody sees before.

    Bad: `state -> State`, with STUCK 7 in ROS and the values open, closed and moving in JAUS

    Good: a table that maps STUCK to one of them, or a value set that has it
    """
    for placed, comparison in _enumerated(direction):
        (target,) = placed.target_attributes
        legal = target.values
        lost = [
            value
            for value in comparison.unmatched
            if legal and not any(low <= value.number <= high for low, high in legal)
        ]
        if lost and not target.is_ros and comparison.is_of_one_enumeration:
            names = ", ".join(f"{value.name} ({value.number})" for value in lost[:_MOST_NAMES])
            message = f"'{target.label}' has no value for {names}, which drops the message"
            yield Finding(placed.assignment, message, "source")


def _enumerated(
    direction: Direction,
) -> Iterator[tuple[Placed[bridge.FieldAssignment], attributes.Comparison]]:
    """Yields the assignments that pass numbers as they are between ends that both name values."""
    for placed in direction.of_kind(bridge.FieldAssignment):
        ends = placed.source_attributes, placed.target_attributes
        if placed.assignment.conversions or any(len(end) != 1 for end in ends):
            continue
        comparison = attributes.compared(ends[0][0], ends[1][0])
        if comparison is not None:
            yield placed, comparison


@dataclass(frozen=True)
class _LookedUp:
    """An assignment by a table alone, between ends that both name values."""

    placed: Placed[bridge.FieldAssignment]
    table: bridge.ValueTable
    ends: attributes.Comparison

    @property
    def given(self) -> list[tuple[bridge.TableEntry, str, str]]:
        """The entries, each with what it takes and gives, names as their numbers."""
        taken, target = map(
            _Meaning, (self.placed.source_attributes[0], self.placed.target_attributes[0])
        )
        sides = ("jaus", "ros") if self.placed.scope.to_ros else ("ros", "jaus")
        return [
            (entry, taken.of(_side(entry, sides[0])), target.of(_side(entry, sides[1])))
            for entry in self.table.entries
        ]

    @property
    def astray(self) -> list[tuple[attributes.NamedValue, attributes.NamedValue, float]]:
        """The values that both ends have by name, with the number that the table gives instead."""
        first = {
            taken: number for _, taken, number in reversed(self.given) if attributes.is_real(number)
        }
        pairs = ((one, other, first.get(str(one.number))) for one, other in self.ends.common)
        return [
            (one, other, float(number))
            for one, other, number in pairs
            if number is not None and float(number) != other.number
        ]


def _looked_up(direction: Direction) -> Iterator[_LookedUp]:
    for placed in direction.of_kind(bridge.FieldAssignment):
        steps = placed.assignment.conversions
        ends = placed.source_attributes, placed.target_attributes
        if len(steps) != 1 or any(len(end) != 1 for end in ends):
            continue
        table, comparison = steps[0].table, attributes.compared(ends[0][0], ends[1][0])
        if steps[0].kind.name == LookUp.name and table is not None and comparison is not None:
            yield _LookedUp(placed, table, comparison)


def _findings(
    placed: Placed[bridge.FieldAssignment], position: int, table: bridge.ValueTable
) -> Iterator[Finding]:
    to_ros = placed.scope.to_ros
    target_side, taken = ("ros", "jaus") if to_ros else ("jaus", "ros")
    conversions = placed.assignment.conversions
    if position == 0 and len(placed.source_attributes) == 1:
        source = placed.source_attributes[0]
        faults = list(_entry_findings(table, taken, source))
        yield from faults
        yield from [] if faults else _lacking(table, taken, source)
    if len(conversions) == len(placed.source_attributes) == len(placed.target_attributes) == 1:
        yield from _repeated(table, taken, placed)
    if position == len(conversions) - 1 and len(placed.target_attributes) == 1:
        yield from _entry_findings(table, target_side, placed.target_attributes[0])


def _entry_findings(
    table: bridge.ValueTable, feature: str, attribute: attributes.Attribute
) -> Iterator[Finding]:
    if attribute.kind not in _VALUES:
        return
    names = dict(attribute.constants)
    for entry in table.entries:
        value = _side(entry, feature)
        fault = attributes.constant_fault(value, attribute, names) if value is not None else ""
        if fault:
            hint = _known(attribute)
            yield Finding(entry, f"{value!r} for '{attribute.label}' {fault}", feature, hint)


def _repeated(
    table: bridge.ValueTable, feature: str, placed: Placed[bridge.FieldAssignment]
) -> Iterator[Finding]:
    """Yields findings for entries that neither direction finds."""
    ends = [placed.source_attributes[0], placed.target_attributes[0]]
    jaus, ros = map(_Meaning, ends if feature == "jaus" else reversed(ends))
    seen: tuple[dict[str, bridge.TableEntry], dict[str, bridge.TableEntry]] = ({}, {})
    for entry in table.entries:
        values = jaus.of(entry.jaus), ros.of(entry.ros)
        firsts = [known.setdefault(value, entry) for known, value in zip(seen, values, strict=True)]
        if all(first is not entry for first in firsts):
            message = f"{entry.jaus!r} and {entry.ros!r} stand in earlier entries, which count"
            note = Note(firsts[0], "the earlier entry", "jaus")
            yield Finding(entry, message, "jaus", related=(note,), severity=Severity.WARNING)


def _unnamed(looked: _LookedUp) -> Iterator[Finding]:
    """Yields findings for entries with a number that the ROS enumeration does not name."""
    if not looked.ends.is_of_one_enumeration:
        return
    to_ros = looked.placed.scope.to_ros
    named = (looked.ends.target if to_ros else looked.ends.source).values()
    known = {str(value.number) for value in named}
    for entry, taken, result in looked.given:
        if (result if to_ros else taken) not in known:
            message = f"no constant of the ROS type is {entry.ros!r}"
            hint = f"it has {', '.join(value.name for value in named)}"
            yield Finding(entry, message, "ros", hint, severity=Severity.WARNING)


def _side(entry: bridge.TableEntry, feature: str) -> str:
    return entry.jaus if feature == "jaus" else entry.ros


def _lacking(
    table: bridge.ValueTable, feature: str, attribute: attributes.Attribute
) -> Iterator[Finding]:
    meaning = _Meaning(attribute)
    known = {meaning.of(_side(entry, feature)) for entry in table.entries}
    listed = attribute.constants if not attribute.is_ros else _own_constants(known, meaning)
    if attribute.kind == attributes.BOOL:
        listed = (("true", "true"), ("false", "false"))
    names = [name for name, value in listed if meaning.of(value) not in known]
    if names:
        more = " ..." if len(names) > _MOST_NAMES else ""
        message = f"table '{table.name}' lacks {', '.join(names[:_MOST_NAMES])}{more}"
        message += f" of '{attribute.label}', which drops the message"
        yield Finding(table, message, "entries", severity=Severity.WARNING)


def _own_constants(known: set[str], meaning: _Meaning) -> list[tuple[str, str]]:
    """Returns the constants of a ROS field, as far as a table of some values means them.

    Constants belong to a type, not to a field: where a table has values without a name, or of
    other names, it says nothing of them.
    """
    own = [
        (value.name, str(value.number))
        for value in attributes.named_values(meaning.attribute).values()
        if not _is_none(value.number, meaning.attribute)
    ]
    return own if known <= {meaning.of(name) for name, _ in own} else []


def _is_none(number: int, attribute: attributes.Attribute) -> bool:
    """Whether a marker takes a value of a ROS field for none, which no table is asked for."""
    marks = marks_of(attribute.field) if isinstance(attribute.field, ros.Field) else ()
    return any(is_said(mark.condition, {VALUE: number}) for mark in marks)


_FLAGS = {"true": "1", "false": "0"}


class _Meaning:
    """The meaning of entries for an attribute."""

    def __init__(self, attribute: attributes.Attribute) -> None:
        self.attribute = attribute
        self._names = dict(attribute.constants)

    def of(self, value: str | None) -> str:
        """Returns one text for one value: numbers and their names alike."""
        text = self._names.get(value or "", value or "").strip()
        if self.attribute.kind == attributes.BOOL:
            return _FLAGS.get(text, text)
        if self.attribute.kind == attributes.NUMBER and attributes.is_real(text):
            return f"{float(text):.17g}"
        return text


def _known(attribute: attributes.Attribute) -> str:
    names = [name for name, _ in attribute.constants]
    if attribute.is_ros or not 0 < len(names) <= 2 * _MOST_NAMES:
        return ""
    return f"it has {', '.join(names)}"
