"""Definition files as text, from the same facts that the importer reads out of them."""

from __future__ import annotations

from dataclasses import dataclass, field

from jausml.generation.errors import GenerationError
from jausml.generation.literals import printable
from jausml.language.interfaces.definitions import FieldType
from jausml.language.interfaces.values import ValueTextError, write_value


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
