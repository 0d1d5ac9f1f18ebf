"""Members of messages and of the containers in them, and how they stand on the wire."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from jausml.generation import literals as docs

if TYPE_CHECKING:
    from jausml_generators.python.codec.compounds import (
        ArrayValue,
        ListValue,
        PartValue,
        VariantValue,
    )
    from jausml_generators.python.codec.scalars import Blob, Fixed


@dataclass(frozen=True)
class Member:
    """An attribute of a message or part.

    Attributes:
        default: Default value, as Python text.
        item: Name of a local for an element, when the value is a list or an array.
        bit: Its bit in the presence vector; 0 when it is always there.
        enumeration: Name of the class of its listed values, or empty.
    """

    jaus_name: str
    attribute: str
    value: Fixed | Blob | PartValue | VariantValue | ListValue | ArrayValue
    default: str
    item: str = ""
    bit: int = 0
    units: str = ""
    documentation: str = ""
    enumeration: str = ""

    @property
    def is_optional(self) -> bool:
        """Whether the presence vector says if it is there."""
        return self.bit != 0

    @property
    def annotation(self) -> str:
        """Type in Python, None included."""
        return f"{self.value.python_type} | None" if self.is_optional else self.value.python_type

    @property
    def result(self) -> str:
        """The value, as Python text, when its bytes were read into a local of its name."""
        if self.value.kind == "fixed" and not self.is_optional:
            return self.value.unpack(self.attribute)  # type: ignore[union-attr]
        return self.attribute

    @property
    def start(self) -> str:
        """The assignment of an empty list to a local of its name."""
        annotation = "" if self.is_optional else f": {self.value.python_type}"
        return f"{self.attribute}{annotation} = []"

    @property
    def line(self) -> str:
        """Its line in the class, or as a local."""
        return f"{self.attribute}: {self.annotation} = {self.default}"

    @property
    def description(self) -> str:
        """What the docstring says of it."""
        numbers = getattr(self.value, "range_text", "")
        facts = [
            " ".join(filter(None, [numbers, self.units])),
            f"see {self.enumeration}" if self.enumeration else "",
            "optional" if self.is_optional else "",
        ]
        text = "; ".join(filter(None, facts))
        first = docs.described(self.documentation or self.jaus_name)
        return f"{first} {docs.sentence(text)}" if text else first


@dataclass(frozen=True)
class Run:
    """Members of fixed size one after the other, packed by one struct."""

    kind: ClassVar[str] = "run"
    struct: str
    members: tuple[Member, ...]
    has_presence: bool
    size: int

    @property
    def packed(self) -> tuple[str, ...]:
        """Arguments of the struct's pack."""
        calls = tuple(
            member.value.pack(f"self.{member.attribute}", member.attribute)  # type: ignore[union-attr]
            for member in self.members
        )
        # The presence vector is written over this 0 when all members are known.
        return ("0", *calls) if self.has_presence else calls

    @property
    def targets(self) -> str:
        """What the struct's unpack is assigned to."""
        names = [member.attribute for member in self.members]
        names = ["presence", *names] if self.has_presence else names
        return f"({names[0]},)" if len(names) == 1 else ", ".join(names)


@dataclass(frozen=True)
class Single:
    """A member that is read and written by itself."""

    kind: ClassVar[str] = "single"
    member: Member
