"""Comparison of ROS types of a model with those of the installed interface packages."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.language.interfaces import Installation, parse_definition
from jausml.language.interfaces.definitions import FieldType, is_type_name
from jausml.language.metamodel.classes import ros
from jausml.language.model.inputs import read_text

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from jausml.language.interfaces import FieldDefinition, Section
    from jausml.language.metamodel.classes.ecore import EObject

    InterfaceType = ros.MessageType | ros.ServiceType | ros.ActionType


@dataclass(frozen=True, slots=True)
class TypeDifference:
    """One difference between a type of a model and the installed one."""

    element: EObject
    message: str


class InstalledTypes:
    """The installed definitions, each read once."""

    def __init__(self, installation: Installation) -> None:
        self._installation = installation
        self._folders: dict[str, Path | None] = {}

    def differences(self, element: InterfaceType) -> Iterator[TypeDifference]:
        """Yields how a type of the model differs from the installed one.

        Nothing is yielded when its package is not installed, or its definition cannot be
        understood; ROS would not have built it.
        """
        package, kind = package_of(element), kind_of(element)
        folder = self._folder(package)
        if folder is None or not is_type_name(str(element.name)):
            return
        try:
            text = read_text(folder / kind / f"{element.name}.{kind}")
        except FileNotFoundError:
            yield TypeDifference(element, f"the installed {package} has no {element.name}")
            return
        except (OSError, ValueError):
            return
        definition = parse_definition(text, kind)
        parts = parts_of(element)
        if definition.faults or None in parts:
            return
        for part, section in zip(parts, definition.sections, strict=True):
            yield from _fields(part, section, package)
            yield from _constants(part, section)

    def _folder(self, package: str) -> Path | None:
        if package not in self._folders:
            self._folders[package] = self._installation.folder(package)
        return self._folders[package]


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
    around: EObject | None = element
    while around is not None and not isinstance(around, ros.InterfacePackage):
        around = around.eContainer()
    return str(around.name) if around is not None else ""


def _fields(message: ros.MessageType, section: Section, package: str) -> Iterator[TypeDifference]:
    here = {str(each.name): each for each in message.fields}
    there = {each.name: _installed_type(each, package) for each in section.fields}
    renamed = _renamed(here, there)
    for name, element in here.items():
        if name in renamed:
            yield TypeDifference(element, f"field '{name}' is named '{renamed[name]}' there")
        elif name not in there:
            yield TypeDifference(element, f"there is no field '{name}' there")
        elif _type(element) != there[name]:
            message_text = f"field '{name}' is {_type(element)} here, {there[name]} there"
            yield TypeDifference(element, message_text)
    for name, kind in there.items():
        if name not in here and name not in renamed.values():
            yield TypeDifference(message, f"field '{name}' ({kind}) is missing here")
    common = [name for name in here if name in there]
    if common != [name for name in there if name in here]:
        yield TypeDifference(message, "its fields stand in another order there")


def _renamed(here: dict[str, ros.Field], there: dict[str, str]) -> dict[str, str]:
    """Returns new names by old ones: of fields that stand at one place and have one type."""
    if len(here) != len(there):
        return {}
    pairs = zip(here.items(), there.items(), strict=True)
    return {
        old: new
        for (old, element), (new, kind) in pairs
        if old != new and old not in there and new not in here and _type(element) == kind
    }


def _constants(message: ros.MessageType, section: Section) -> Iterator[TypeDifference]:
    there = {each.name: each for each in section.constants}
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


def _type(field: ros.Field) -> str:
    common = (field.arrayKind.name, field.arraySize)
    if isinstance(field, ros.PrimitiveField):
        return str(FieldType(field.type.name, "", field.stringBound, *common))
    target = field.messageType if isinstance(field, ros.MessageField) else None
    if target is None:
        return str(FieldType("nothing", "", 0, *common))
    return str(FieldType(str(target.name), package_of(target), 0, *common))


def _installed_type(field: FieldDefinition, package: str) -> str:
    kind = field.type
    if kind.is_primitive:
        return str(kind)
    owner = kind.package or ("std_msgs" if kind.name == "Header" else package)
    return str(FieldType(kind.name, owner, 0, kind.array, kind.array_size))
