"""Classes inside a message class, one view for each kind."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar, TypeAlias

from jausml.generation import literals as docs
from jausml.generation.literals import python_string
from jausml_generators.python.codec.members import (
    MAXIMUM_COMPLEXITY,
    Member,
    Run,
    Single,
    VariantValue,
)
from jausml_generators.python.codec.scalars import Blob, Fixed
from jausml_generators.python.statements import call

_ANY_OCTET = {"b": (-128, 127), "B": (0, 255)}  # all numbers of an octet, by its format in `struct`


@dataclass(frozen=True)
class Enumeration:
    """The listed values of a field.

    Attributes:
        of: What it lists the values of, clean text.
    """

    kind: ClassVar[str] = "enumeration"
    name: str
    of: str
    constants: tuple[tuple[str, int], ...]

    def docstring(self, column: int) -> str:
        """Returns the docstring of the class."""
        return docs.docstring(f"Values of {self.of}.", column)


@dataclass(frozen=True)
class SubField:
    """A group of bits of a bit field.

    Attributes:
        enumeration: Name of the class of its listed values, or empty.
    """

    jaus_name: str
    attribute: str
    low: int
    mask: int
    value: Fixed
    documentation: str = ""
    enumeration: str = ""

    @property
    def packed(self) -> str:
        """The checked value, moved to its place in the integer."""
        value = self.value.pack(f"self.{self.attribute}", self.attribute)
        return f"{value} << {self.low}" if self.low else value

    @property
    def extracted(self) -> str:
        """The value out of the integer `bits`."""
        bits = f"bits >> {self.low} & 0x{self.mask:X}" if self.low else f"bits & 0x{self.mask:X}"
        return bits if self.value.is_plain else self.value.unpack(f"({bits})")

    @property
    def description(self) -> str:
        """The line of the docstring."""
        see = f"; see {self.enumeration}" if self.enumeration else ""
        first = docs.described(self.documentation or self.jaus_name)
        return f"{first} {self.value.range_text}{see}."


@dataclass(frozen=True)
class BitFieldClass:
    """The class of a bit field.

    Attributes:
        is_inherited: Whether the base of the message, StampedMessage, brings it.
    """

    kind: ClassVar[str] = "bit_field"
    name: str
    path: str
    summary: str
    sub_fields: tuple[SubField, ...]
    is_inherited: bool = False

    def docstring(self, column: int) -> str:
        """Returns the docstring of the class."""
        return docs.docstring(self.summary, column, (), self.attributes)

    @property
    def extracted(self) -> tuple[str, ...]:
        """Arguments of the constructor out of the integer `bits`."""
        return tuple(sub.extracted for sub in self.sub_fields)

    @property
    def attributes(self) -> tuple[tuple[str, str], ...]:
        """Names and descriptions for the docstring."""
        return tuple((sub.attribute, sub.description) for sub in self.sub_fields)


@dataclass(frozen=True)
class Alternative:
    """A type that a variable field may take."""

    index: int
    value: Fixed
    jaus_name: str
    units: str

    @property
    def description(self) -> str:
        """Unit and range in words."""
        facts = " ".join(filter(None, [self.value.range_text, self.units]))
        return facts or docs.clean(self.jaus_name)


@dataclass(frozen=True)
class Format:
    """A format that the bytes of a variable format field may have."""

    index: int
    value: Blob
    jaus_name: str


@dataclass(frozen=True)
class VariableFieldClass:
    """The class of a variable field: an index and a number."""

    kind: ClassVar[str] = "variable_field"
    name: str
    path: str
    summary: str
    python_type: str
    alternatives: tuple[Alternative, ...]
    jaus_name: str = ""

    @property
    def octet(self) -> str:
        """Empty: it is an index and a number."""
        return ""

    @property
    def min_size(self) -> int:
        """Fewest bytes on the wire."""
        return 1 + min(alternative.value.size for alternative in self.alternatives)

    @property
    def default(self) -> str:
        """Default number."""
        return self.alternatives[0].value.default

    def docstring(self, column: int) -> str:
        """Returns the docstring of the class."""
        return docs.docstring(self.summary, column, (), self.attributes)

    @property
    def attributes(self) -> tuple[tuple[str, str], ...]:
        """Names and descriptions for the docstring."""
        choices = "; ".join(
            f"{alternative.index}: {alternative.description}" for alternative in self.alternatives
        )
        return (("index", f"Which type and unit: {choices}."), ("value", "The number."))

    @property
    def is_complex(self) -> bool:
        """Whether its methods have more branches than the style allows."""
        return len(self.alternatives) + 1 > MAXIMUM_COMPLEXITY


@dataclass(frozen=True)
class ContainerClass:
    """A class of members: the message itself or a record or sequence inside it.

    Attributes:
        segments: How they stand on the wire, which follows from the members.
        presence_struct: Name of the constant for the presence vector, or empty.
        jaus_name: Name in the model of what it is the class of.
        is_wrapper: Whether it only gives a class to a list, array, variant or single field.
        formats: Of the index of a format and bytes (AS5684 variable_format_field), the formats.
    """

    kind: ClassVar[str] = "container"
    name: str
    path: str
    summary: str
    paragraphs: tuple[str, ...]
    members: tuple[Member, ...]
    segments: tuple[Run | Single, ...] = field(compare=False, repr=False)
    presence_struct: str = ""
    presence_size: int = 0
    presence_mask: int = 0
    tag: int | None = None
    jaus_name: str = ""
    is_wrapper: bool = False
    formats: tuple[Format, ...] = ()

    @cached_property
    def by_jaus_name(self) -> Mapping[str, Member]:
        """The members by their names in the model."""
        return {member.jaus_name: member for member in reversed(self.members)}

    @property
    def min_size(self) -> int:
        """Fewest bytes on the wire."""
        always = (member.value.min_size for member in self.members if not member.is_optional)
        return self.presence_size + sum(always)

    @property
    def has_unknown_bits(self) -> bool:
        """Whether the presence vector has bits that no member uses."""
        return self.presence_mask < (1 << 8 * self.presence_size) - 1

    @property
    def has_optional(self) -> bool:
        """Whether any member is optional."""
        return self.presence_mask != 0

    def docstring(self, column: int) -> str:
        """Returns the docstring of the class."""
        return docs.docstring(self.summary, column, self.paragraphs, self.attributes)

    @property
    def attributes(self) -> tuple[tuple[str, str], ...]:
        """Names and descriptions for the docstring."""
        return tuple((member.attribute, member.description) for member in self.members)

    @property
    def arguments(self) -> tuple[str, ...]:
        """Arguments of the constructor after reading."""
        return tuple(member.result for member in self.members)

    @property
    def variants(self) -> tuple[VariantValue, ...]:
        """The variants among its members, in lists and arrays too."""
        values = (getattr(member.value, "element", member.value) for member in self.members)
        return tuple(value for value in values if isinstance(value, VariantValue))

    @property
    def octet(self) -> str:
        """The argument that makes it one octet on the wire; empty where it is not."""
        if self.presence_size or len(self.members) != 1:
            return ""
        (only,) = self.members
        value = only.value
        if not isinstance(value, Fixed) or value.check != "integer" or value.format not in "bB":
            return ""
        # Octets go out as they came, so each must be a number that the field can have.
        if value.ranges != (_ANY_OCTET[value.format],):
            return ""
        signed = ["is_signed=True"] if value.format == "b" else []
        return call("Octet", python_string(only.attribute), *signed)

    @property
    def is_complex(self) -> bool:
        """Whether its methods have more branches than the style allows."""
        branches = [member for member in self.members if member.is_optional]
        branches += [member for member in self.members if member.item]
        return len(branches) + 1 > MAXIMUM_COMPLEXITY


@dataclass(frozen=True)
class VariantAlias:
    """The union of the classes of a variant."""

    kind: ClassVar[str] = "alias"
    name: str
    options: tuple[str, ...]


NestedClass: TypeAlias = (
    Enumeration | BitFieldClass | VariableFieldClass | ContainerClass | VariantAlias
)
"""A class inside the class of a message."""
