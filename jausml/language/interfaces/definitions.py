"""Interface definitions as data, free of how they are written."""

from __future__ import annotations

from dataclasses import dataclass, field

SINGLE = "single"
FIXED = "fixedArray"
BOUNDED = "boundedSequence"
UNBOUNDED = "unboundedSequence"

INTEGERS = tuple(f"{sign}int{bits}" for bits in (8, 16, 32, 64) for sign in ("", "u"))
PRIMITIVES = ("bool", "byte", "char", "float32", "float64", *INTEGERS, "string", "wstring")
TEXTS = ("string", "wstring")


@dataclass(frozen=True, slots=True)
class Fault:
    """A fault of a definition; lines and columns are counted from 1."""

    rule: str
    line: int
    column: int
    message: str
    hint: str = ""


@dataclass(frozen=True, slots=True)
class FieldType:
    """The type of a field.

    Attributes:
        name: A primitive type, or the name of a message type.
        package: Package of the message type; empty for a primitive type, and for a message type
            that the definition names without one.
        string_bound: Largest length of a string in characters; 0 when there is none.
        array: `single`, `fixedArray`, `boundedSequence` or `unboundedSequence`.
        array_size: Number of elements of a fixed array, largest number of a bounded sequence.
    """

    name: str
    package: str = ""
    string_bound: int = 0
    array: str = SINGLE
    array_size: int = 0

    @property
    def is_primitive(self) -> bool:
        """True for a type that holds no further fields."""
        return not self.package and self.name in PRIMITIVES

    def __str__(self) -> str:
        base = f"{self.package}/{self.name}" if self.package else self.name
        bound = f"<={self.string_bound}" if self.string_bound else ""
        size = {SINGLE: "", FIXED: f"[{self.array_size}]", UNBOUNDED: "[]"}
        return base + bound + size.get(self.array, f"[<={self.array_size}]")


@dataclass(frozen=True, slots=True)
class FieldDefinition:
    """One field.

    Attributes:
        units: What stands in square brackets in its comments, where that is one thing; rosidl
            takes it for the unit.
    """

    name: str
    type: FieldType
    default: str | None = None
    comment: str = ""
    units: str = ""
    line: int = 1
    column: int = 1


@dataclass(frozen=True, slots=True)
class ConstantDefinition:
    """One constant."""

    name: str
    type: str
    value: str
    comment: str = ""
    line: int = 1
    column: int = 1


@dataclass(slots=True)
class Section:
    """A message, or one part of a service or an action."""

    fields: list[FieldDefinition] = field(default_factory=list)
    constants: list[ConstantDefinition] = field(default_factory=list)
    comment: str = ""
    line: int = 1


@dataclass(slots=True)
class Definition:
    """An interface definition.

    Attributes:
        sections: One for a message, two for a service, three for an action; as many as there are
            when the number is wrong.
    """

    sections: list[Section]
    faults: list[Fault]
