"""Definition files as text, from the same facts that the importer reads out of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from jausml.generation.errors import GenerationError
from jausml.generation.literals import printable
from jausml.language.interfaces.definitions import FieldType, ValueTextError, write_value
from jausml.language.metamodel.classes import ros
from jausml.language.semantics.ros_types import kind_of, package_of, parts_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.semantics.ros_types import InterfaceType


@dataclass(frozen=True, slots=True)
class FieldLine:
    """A field of a definition.

    Attributes:
        default: Its default as models write it, None without one.
    """

    name: str
    type: FieldType
    comment: str = ""
    default: str | None = None

    @property
    def code(self) -> str:
        """The line without comments."""
        if self.default is None:
            return f"{self.type} {self.name}"
        text = _value_text(self.default, self.type, self.name, is_default=True)
        return f"{self.type} {self.name} {text}"


@dataclass(frozen=True, slots=True)
class ConstantLine:
    """A constant of a definition."""

    name: str
    type: str
    value: str
    comment: str = ""

    @property
    def code(self) -> str:
        """The line without comments."""
        value = _value_text(self.value, FieldType(self.type), self.name)
        return f"{self.type} {self.name}={value}"


@dataclass(slots=True)
class DefinitionSection:
    """A message, or a part of a service or an action."""

    comment: str = ""
    constants: list[ConstantLine] = field(default_factory=list)
    fields: list[FieldLine] = field(default_factory=list)

    @property
    def lines(self) -> list[str]:
        """The lines of the section: its comment, its constants and its fields."""
        elements: list[ConstantLine | FieldLine] = [*self.constants, *self.fields]
        lines = [line for each in elements for line in (*comment_lines(each.comment), each.code)]
        head = comment_lines(self.comment)
        # A comment at the very head would be one of the section.
        is_parted = bool(lines) and (bool(head) or lines[0].startswith("#"))
        return [*head, *([""] if is_parted else []), *lines]

    @property
    def packages(self) -> set[str]:
        """The packages of its fields' types."""
        return {each.type.package for each in self.fields if each.type.package}


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
        found = {name for section in self.sections for name in section.packages}
        return found - {self.package}


def comment_lines(text: str) -> list[str]:
    """Returns a text as the lines of a comment."""
    lines = [line.strip() for line in printable(text).splitlines()]
    return [f"# {line}".rstrip() for line in lines]


def _value_text(value: str, kind: FieldType, name: str, *, is_default: bool = False) -> str:
    try:
        return write_value(value, kind, is_default=is_default)
    except ValueTextError as error:
        raise GenerationError(f"value {value!a} of '{name}' {error}") from error


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
