"""ROS types: how much they hold, and how they differ from those that are installed.

A few types that use each other make a message that no machine can hold: thirty of them, each with
two fields of the one before, have 2^30 numbers. Who walks along the tree of a type asks here first.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

from jausml.language.interfaces import FieldDefinition, Installation, Section
from jausml.language.interfaces.definitions import FieldType, is_type_name
from jausml.language.interfaces.idl import SUFFIX as IDL
from jausml.language.interfaces.idl import parse_interface
from jausml.language.metamodel.classes import ros
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.files import read_text
from jausml.language.model.names import around

InterfaceType: TypeAlias = "ros.MessageType | ros.ServiceType | ros.ActionType"

MOST_PARTS = 1 << 14
"""The most numbers, texts, arrays of numbers and sequences that code is generated for."""
MOST_VALUES = 4 << 20
"""The most values that a message may hold, those of fixed arrays each counted."""
DEEPEST = 64
"""How deep types may be nested."""


@dataclass(frozen=True, slots=True)
class Extent:
    """The extent of a message, sequences without their elements.

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
    for message_type in types:
        for inner_type in _inner_first(message_type, extents):
            extent, excess = _measured(inner_type, extents)
            extents[inner_type] = extent
            if excess is not None:
                yield excess


def _inner_first(
    start: ros.MessageType, known: dict[ros.MessageType, Extent | None]
) -> Iterator[ros.MessageType]:
    """Yields new types, inner ones first; a cycle has no first."""
    pending = [(start, True)]
    entered: set[ros.MessageType] = set()
    while pending:
        message_type, is_new = pending.pop()
        if not is_new:
            yield message_type
        elif message_type not in known and message_type not in entered:
            entered.add(message_type)
            pending.append((message_type, False))
            pending += [(inner, True) for field in message_type.fields if (inner := _inner(field))]


def _measured(
    message_type: ros.MessageType, known: dict[ros.MessageType, Extent | None]
) -> tuple[Extent | None, Excess | None]:
    """Returns the extent of a type, None where that is too much, and the field that makes it so."""
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


@dataclass(frozen=True, slots=True)
class TypeDifference:
    """One difference between a type of a model and the installed one."""

    element: EObject
    message: str


def installed_differences(
    element: InterfaceType, installation: Installation
) -> Iterator[TypeDifference]:
    """Yields how a type of the model differs from the installed one.

    Nothing is yielded when its package is not installed, or its definition cannot be understood;
    ROS would not have built it.
    """
    package, kind = package_of(element), kind_of(element)
    folder = installation.folder(package)
    if folder is None or not is_type_name(str(element.name)):
        return
    own, idl = (folder / kind / f"{element.name}{suffix}" for suffix in (f".{kind}", IDL))
    # Unlike Path.is_file this is False where nothing may be looked at.
    path = own if os.path.isfile(own) or not os.path.isfile(idl) else idl  # noqa: PTH113
    try:
        text = read_text(path)
    except FileNotFoundError:
        yield TypeDifference(element, f"the installed {package} has no {element.name}")
        return
    except (OSError, ValueError):
        return
    definition = parse_interface(str(path), kind, text)
    parts = parts_of(element)
    if definition.faults or None in parts:
        return
    for part, section in zip(parts, definition.sections, strict=True):
        yield from _fields(part, section, package)
        yield from _constants(part, section)


def kind_of(element: InterfaceType) -> str:
    """Returns the ending of the definition file of a type: `msg`, `srv` or `action`."""
    owner = element.eContainer()
    if isinstance(element, ros.ServiceType) or isinstance(owner, ros.ServiceType):
        return "srv"
    is_of_action = isinstance(element, ros.ActionType) or isinstance(owner, ros.ActionType)
    return "action" if is_of_action else "msg"


def parts_of(element: InterfaceType) -> list[ros.MessageType]:
    """Returns the messages that a type consists of, in the order of its definition file."""
    if isinstance(element, ros.ServiceType):
        return [element.request, element.response]
    if isinstance(element, ros.ActionType):
        return [element.goal, element.result, element.feedback]
    return [element]


def package_of(element: EObject) -> str:
    """Returns the name of the package that owns a type or a part of one; empty without."""
    package = around(element, ros.InterfacePackage)
    return str(package.name) if package is not None else ""


def _fields(message: ros.MessageType, section: Section, package: str) -> Iterator[TypeDifference]:
    here = {str(field.name): field for field in message.fields}
    there = {field.name: _installed_type(field, package) for field in section.fields}
    renamed = _renamed(here, there)
    for name, element in here.items():
        if name in renamed:
            yield TypeDifference(element, f"field '{name}' is named '{renamed[name]}' there")
        elif name not in there:
            yield TypeDifference(element, f"there is no field '{name}' there")
        elif str(type_of(element)) != there[name]:
            message_text = f"field '{name}' is {type_of(element)} here, {there[name]} there"
            yield TypeDifference(element, message_text)
    for name, kind in there.items():
        if name not in here and name not in renamed.values():
            yield TypeDifference(message, f"field '{name}' ({kind}) is missing here")
    common = [name for name in here if name in there]
    if common != [name for name in there if name in here]:
        yield TypeDifference(message, "its fields stand in another order there")


def _renamed(here: dict[str, ros.Field], there: dict[str, str]) -> dict[str, str]:
    """Returns new names by old ones: of fields with the same place and type."""
    if len(here) != len(there):
        return {}
    pairs = zip(here.items(), there.items(), strict=True)
    return {
        old: new
        for (old, element), (new, kind) in pairs
        if old != new and old not in there and new not in here and str(type_of(element)) == kind
    }


def _constants(message: ros.MessageType, section: Section) -> Iterator[TypeDifference]:
    there = {constant.name: constant for constant in section.constants}
    for element in message.constants:
        installed = there.get(element.name)
        if installed is None:
            yield TypeDifference(element, f"there is no constant '{element.name}' there")
            continue
        ours = (element.type.name, element.value or "")
        if not _is_same(ours, (installed.type, installed.value)):
            values = f"{' '.join(ours)} here, {installed.type} {installed.value} there"
            yield TypeDifference(element, f"constant '{element.name}' is {values}")


def _is_same(ours: tuple[str, str], theirs: tuple[str, str]) -> bool:
    if ours[0] == theirs[0] and ours[0].startswith("float"):
        try:
            return float(ours[1]) == float(theirs[1])
        except ValueError:
            return False
    return ours == theirs


def type_of(field: ros.Field) -> FieldType:
    """Returns the type of a field as definitions have it."""
    common = (field.arrayKind.name, field.arraySize)
    if isinstance(field, ros.PrimitiveField):
        return FieldType(field.type.name, "", field.stringBound, *common)
    target = _inner(field)
    if target is None:
        return FieldType("nothing", "", 0, *common)
    return FieldType(str(target.name), package_of(target), 0, *common)


def _installed_type(field: FieldDefinition, package: str) -> str:
    kind = field.type
    if kind.is_primitive:
        return str(kind)
    owner = kind.package or ("std_msgs" if kind.name == "Header" else package)
    return str(FieldType(kind.name, owner, 0, kind.array, kind.array_size))
