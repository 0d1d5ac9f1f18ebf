"""How much ROS types hold, counted once for each type however often others use it.

A few types that use each other make a message that no machine can hold: thirty of them, each with
two fields of the one before, have 2^30 numbers. Who walks along the tree of a type asks here first.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import ros

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

MOST_PARTS = 1 << 14
"""The most numbers, texts, arrays of numbers and sequences that code is generated for."""
MOST_VALUES = 4 << 20
"""The most values that a message may hold, those of fixed arrays each counted."""
DEEPEST = 64
"""How deep types may be nested."""


@dataclass(frozen=True, slots=True)
class Extent:
    """What a message consists of, sequences without their elements.

    Attributes:
        depth: How deep its types are nested; 1 when it has primitive fields alone.
    """

    parts: int = 1
    values: int = 1
    depth: int = 1


@dataclass(frozen=True, slots=True)
class Excess:
    """A field with which a type becomes too large."""

    field: ros.Field
    reason: str


def excesses(types: Iterable[ros.MessageType]) -> Iterator[Excess]:
    """Yields for each type that is too large the field that makes it so.

    Types that are too large only because of another one are left out.
    """
    extents: dict[ros.MessageType, Extent | None] = {}
    for each in types:
        for found in _inner_first(each, extents):
            extent, excess = _measured(found, extents)
            extents[found] = extent
            if excess is not None:
                yield excess


def _inner_first(
    start: ros.MessageType, known: dict[ros.MessageType, Extent | None]
) -> Iterator[ros.MessageType]:
    """Yields types that are not known yet, what they use before them; a cycle has no beginning."""
    pending = [(start, True)]
    entered: set[ros.MessageType] = set()
    while pending:
        each, is_new = pending.pop()
        if not is_new:
            yield each
        elif each not in known and each not in entered:
            entered.add(each)
            pending.append((each, False))
            pending += [(inner, True) for field in each.fields if (inner := _inner(field))]


def _measured(
    message_type: ros.MessageType, known: dict[ros.MessageType, Extent | None]
) -> tuple[Extent | None, Excess | None]:
    """Returns what a type holds, None where that is too much, and the field that makes it so."""
    parts = values = 0
    depth = 1
    for field in message_type.fields:
        inner = _inner(field)
        if inner is not None and inner not in known:
            return None, Excess(field, "contains itself")
        held = Extent() if inner is None else known[inner]
        if held is None:
            return None, None
        kind = field.arrayKind.name
        if kind in {"boundedSequence", "unboundedSequence"}:
            held = Extent(depth=held.depth)
        times = max(int(field.arraySize), 1) if kind == "fixedArray" else 1
        if times > MOST_VALUES:
            return None, None  # no array has that size, which is a finding of its own
        is_whole = inner is None and not _is_text(field)
        parts += held.parts * (1 if is_whole else times)
        values += held.values * times
        depth = max(depth, held.depth + (inner is not None))
        reason = _reason(Extent(parts, values, depth))
        if reason:
            return None, Excess(field, reason)
    return Extent(max(parts, 1), max(values, 1), depth), None


def _reason(extent: Extent) -> str:
    if extent.depth > DEEPEST:
        return f"nests types more than {DEEPEST} deep"
    if extent.parts > MOST_PARTS:
        return f"makes its type one of more than {MOST_PARTS} parts"
    if extent.values > MOST_VALUES:
        return f"makes its type one of more than {MOST_VALUES} values"
    return ""


def _inner(field: ros.Field) -> ros.MessageType | None:
    return field.messageType if isinstance(field, ros.MessageField) else None


def _is_text(field: ros.Field) -> bool:
    return isinstance(field, ros.PrimitiveField) and field.type.name in {"string", "wstring"}
