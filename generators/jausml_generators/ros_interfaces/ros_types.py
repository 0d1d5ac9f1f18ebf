"""Interface packages that a model declares, as definition files."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.interfaces.definitions import FieldType
from jausml.language.metamodel.classes import ros
from jausml.language.semantics.installed import kind_of, package_of, parts_of
from jausml_generators.ros_interfaces.definitions import (
    ConstantLine,
    DefinitionFile,
    DefinitionSection,
    FieldLine,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.semantics.installed import InterfaceType


def package_files(package: ros.InterfacePackage, source: str) -> Iterator[DefinitionFile]:
    """Yields the definition files of a package."""
    name = str(package.name)
    elements: list[InterfaceType] = [*package.messages, *package.services, *package.actions]
    for element in elements:
        kind = kind_of(element)
        sections = [section_of(part, name) for part in parts_of(element)]
        if kind != "msg" and element.documentation:
            # What stands at the head of the file is said of the whole.
            texts = (str(element.documentation), sections[0].comment)
            sections[0].comment = "\n\n".join(filter(None, texts))
        identity = f"interface:{name}/{element.name}"
        yield DefinitionFile(name, str(element.name), kind, tuple(sections), identity, source)


def section_of(message: ros.MessageType, package: str = "") -> DefinitionSection:
    """Returns a message, or a part of a service or an action, as definition files have it.

    Args:
        package: Package of the file, whose types need no package in it; empty names all packages.
    """
    constants = [
        ConstantLine(
            str(each.name), each.type.name, str(each.value or ""), str(each.documentation or "")
        )
        for each in message.constants
    ]
    fields = [_field(each, package) for each in message.fields]
    return DefinitionSection(str(message.documentation or ""), constants, fields)


def _field(field: ros.Field, package: str) -> FieldLine:
    common = (field.arrayKind.name, field.arraySize)
    if isinstance(field, ros.PrimitiveField):
        kind = FieldType(field.type.name, "", field.stringBound, *common)
        comment = described(field.documentation, field.units, limits_of(field))
        return FieldLine(str(field.name), kind, comment, field.defaultValue)
    if not isinstance(field, ros.MessageField):
        raise TypeError(f"{field.name} is a field of no known kind")
    target = field.messageType
    owner = package_of(target)
    kind = FieldType(str(target.name), owner if owner != package else "", 0, *common)
    return FieldLine(str(field.name), kind, described(field.documentation, field.units))


def limits_of(field: ros.PrimitiveField) -> str:
    """Returns the range of a field in words, empty without one."""
    if field.minimum < field.maximum:
        return f"{field.minimum:.15g} to {field.maximum:.15g}"
    return ""


def described(documentation: str | None, units: str | None, limits: str = "") -> str:
    """Returns what is said about a field: its documentation, its unit and its range.

    The unit stands in square brackets, from where rosidl and the importer take it; brackets of the
    documentation would hide it.

    Args:
        documentation: Text of the model, or None.
        units: Its unit, or None.
    """
    text = str(documentation or "")
    unit = f"[{units}]" if units and f"[{units}]" not in text else ""
    facts = " ".join(part for part in (unit, limits) if part)
    return "\n".join(part for part in (text, facts) if part)
