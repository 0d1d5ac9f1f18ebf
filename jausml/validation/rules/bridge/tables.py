"""Rules about the value tables of maps."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.metamodel.classes import bridge
from jausml.model.diagnostics import Severity
from jausml.semantics.attributes import BOOL, NUMBER, TEXT, Attribute
from jausml.semantics.conversions.authored import LookUp
from jausml.semantics.directions import directions
from jausml.semantics.values import constant_fault, is_real
from jausml.validation.rule import Finding, Note, rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.metamodel.classes.ecore import EObject
    from jausml.semantics.paths import Placed
    from jausml.semantics.subject import Subject

_VALUES = (NUMBER, BOOL, TEXT)
_MOST_NAMES = 5


@rule("JML440", Severity.ERROR, "table that does not fit")
def tables(subject: Subject) -> Iterator[Finding]:
    """The entries of a table are values of what look_up reads and fills.

    An entry is a number, or the name of an enumerated JAUS value or of a constant of the ROS type,
    which means its number. Of several entries with one value the first counts; one whose values
    both stand in earlier entries is never found. Each enumerated value of the source should be in
    the table, since one that is not drops the message.

    Bad: a table `OPEN <-> true` for a JAUS field with the values Opened and Closed

    Good: `Opened <-> true`, `Closed <-> false`
    """
    reported: set[tuple[EObject, str]] = set()
    for direction in directions(subject):
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


def _findings(
    placed: Placed[bridge.FieldAssignment], position: int, table: bridge.ValueTable
) -> Iterator[Finding]:
    to_ros = placed.scope.to_ros
    given, taken = ("ros", "jaus") if to_ros else ("jaus", "ros")
    conversions = placed.assignment.conversions
    if position == 0 and len(placed.source_attributes) == 1:
        source = placed.source_attributes[0]
        faults = list(_entry_findings(table, taken, source))
        yield from faults
        yield from [] if faults else _lacking(table, taken, source)
    if len(conversions) == len(placed.source_attributes) == len(placed.target_attributes) == 1:
        yield from _repeated(table, taken, placed)
    if position == len(conversions) - 1 and len(placed.target_attributes) == 1:
        yield from _entry_findings(table, given, placed.target_attributes[0])


def _entry_findings(
    table: bridge.ValueTable, feature: str, attribute: Attribute
) -> Iterator[Finding]:
    if attribute.kind not in _VALUES:
        return
    for entry in table.entries:
        value = _side(entry, feature)
        fault = constant_fault(value, attribute) if value is not None else ""
        if fault:
            hint = _known(attribute)
            yield Finding(entry, f"{value!a} for '{attribute.label}' {fault}", feature, hint)


def _repeated(
    table: bridge.ValueTable, feature: str, placed: Placed[bridge.FieldAssignment]
) -> Iterator[Finding]:
    """Yields findings for entries that neither direction finds."""
    ends = [placed.source_attributes[0], placed.target_attributes[0]]
    jaus, ros = ends if feature == "jaus" else reversed(ends)
    seen: tuple[dict[str, bridge.TableEntry], dict[str, bridge.TableEntry]] = ({}, {})
    for entry in table.entries:
        values = _resolved(entry.jaus, jaus), _resolved(entry.ros, ros)
        firsts = [known.setdefault(value, entry) for known, value in zip(seen, values, strict=True)]
        if all(first is not entry for first in firsts):
            message = f"{entry.jaus!a} and {entry.ros!a} stand in earlier entries, which count"
            note = Note(firsts[0], "the earlier entry", "jaus")
            yield Finding(entry, message, "jaus", related=(note,), severity=Severity.WARNING)


def _side(entry: bridge.TableEntry, feature: str) -> str:
    return entry.jaus if feature == "jaus" else entry.ros


def _lacking(table: bridge.ValueTable, feature: str, attribute: Attribute) -> Iterator[Finding]:
    known = {_resolved(_side(entry, feature), attribute) for entry in table.entries}
    listed = attribute.constants if not attribute.is_ros else ()
    if attribute.kind == BOOL:
        listed = (("true", "true"), ("false", "false"))
    names = [name for name, value in listed if _resolved(value, attribute) not in known]
    if names:
        more = " ..." if len(names) > _MOST_NAMES else ""
        message = f"table '{table.name}' lacks {', '.join(names[:_MOST_NAMES])}{more}"
        message += f" of '{attribute.label}', which drops the message"
        yield Finding(table, message, "entries", severity=Severity.WARNING)


def _resolved(value: str | None, attribute: Attribute) -> str:
    """One text for one value: numbers and their names alike."""
    text = dict(attribute.constants).get(value or "", value or "").strip()
    if attribute.kind == NUMBER and is_real(text):
        return f"{float(text):.17g}"
    return text


def _known(attribute: Attribute) -> str:
    names = [name for name, _ in attribute.constants]
    if attribute.is_ros or not 0 < len(names) <= 2 * _MOST_NAMES:
        return ""
    return f"it has {', '.join(names)}"
