"""Definition files as text, from the same facts that the importer reads out of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from jausml.generation.errors import GenerationError
from jausml.generation.literals import printable
from jausml.language.interfaces.definitions import (
    ConstantDefinition,
    FieldDefinition,
    FieldType,
    Section,
    ValueTextError,
    write_value,
)
from jausml.language.metamodel.classes import ros
from jausml.language.semantics.ros_types import InterfaceType, kind_of, parts_of, type_of


class DefinitionSection(Section):
    """A message, or a part of a service or an action, that is written."""

    @property
    def lines(self) -> list[str]:
        """The lines of the section: its comment, its constants and its fields."""
        elements: list[ConstantDefinition | FieldDefinition] = [*self.constants, *self.fields]
        lines = [
            line
            for element in elements
            for line in (*comment_lines(element.comment), code_of(element))
        ]
        head = comment_lines(self.comment)
        # A comment at the very head would be one of the section.
        is_parted = bool(lines) and (bool(head) or lines[0].startswith("#"))
        return [*head, *([""] if is_parted else []), *lines]

    @property
    def packages(self) -> set[str]:
        """The packages of its fields' types."""
        return {field.type.package for field in self.fields if field.type.package}


@dataclass(frozen=True)
class DefinitionFile:
    """A .msg, .srv or .action file.

    Attributes:
        kind: `msg`, `srv` or `action`.
    """

    package: str
    name: str
    kind: str
    sections: tuple[DefinitionSection, ...]
    element_id: str
    source: str

    @property
    def place(self) -> str:
        """Path in the package."""
        return f"{self.kind}/{self.name}.{self.kind}"

    @property
    def path(self) -> str:
        """Path in the output folder."""
        return f"{self.package}/{self.place}"

    @property
    def packages(self) -> set[str]:
        """The other packages whose types it uses."""
        package_names = {name for section in self.sections for name in section.packages}
        return package_names - {self.package}


def comment_lines(text: str) -> list[str]:
    """Returns a text as the lines of a comment."""
    lines = [line.strip() for line in printable(text).splitlines()]
    return [f"# {line}".rstrip() for line in lines]


def code_of(element: FieldDefinition | ConstantDefinition) -> str:
    """Returns the line of a field or constant without comments."""
    if isinstance(element, ConstantDefinition):
        value, kind, mark = element.value, FieldType(element.type), "="
    elif element.default is None:
        return f"{element.type} {element.name}"
    else:
        value, kind, mark = element.default, element.type, " "
    try:
        text = write_value(value, kind, is_default=mark == " ")
    except ValueTextError as error:
        raise GenerationError(f"value {value!r} of '{element.name}' {error}") from error
    return f"{element.type} {element.name}{mark}{text}"


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
        ConstantDefinition(
            str(constant.name),
            constant.type.name,
            str(constant.value or ""),
            str(constant.documentation or ""),
        )
        for constant in message.constants
    ]
    fields = [_field(field, package) for field in message.fields]
    return DefinitionSection(fields, constants, str(message.documentation or ""))


def _field(field: ros.Field, package: str) -> FieldDefinition:
    kind, limits, default = type_of(field), "", None
    if kind.package == package:
        kind = replace(kind, package="")
    if isinstance(field, ros.PrimitiveField):
        default = field.defaultValue
        if field.minimum < field.maximum:
            limits = f"{field.minimum:.15g} to {field.maximum:.15g}"
    comment = described(field.documentation, field.units, limits)
    return FieldDefinition(str(field.name), kind, default, comment)


def described(documentation: str | None, units: str | None, limits: str = "") -> str:
    """Returns the comment of a field: its documentation, its unit and its range.

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
