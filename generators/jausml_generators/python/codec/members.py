"""Members of messages and their containers: parts, variants, lists, arrays (SAE AS5684)."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from typing import ClassVar, Protocol

from jausml.generation import literals as docs
from jausml_generators.python.codec.scalars import Blob, Fixed, struct_name

MAXIMUM_COMPLEXITY = 10


class Part(Protocol):
    """A dataclass inside a message class, as far as values of it are concerned."""

    @property
    def name(self) -> str:
        """Name of the class."""

    @property
    def jaus_name(self) -> str:
        """Name of its model element."""

    @property
    def min_size(self) -> int:
        """Fewest bytes on the wire."""

    @property
    def octet(self) -> str:
        """The argument that makes it one octet on the wire; empty where it is not."""


@dataclass(frozen=True)
class PartValue:
    """An instance of a nested dataclass.

    Attributes:
        part: The dataclass. The message lists it too: there it is compared, once.
        python_type: Its full name, e.g. `ReportServices.NodeSeq`.
    """

    kind: ClassVar[str] = "part"
    part: Part = field(compare=False, repr=False)
    python_type: str

    @property
    def min_size(self) -> int:
        """Fewest bytes on the wire."""
        return self.part.min_size


@dataclass(frozen=True)
class VariantValue:
    """An instance of one of several dataclasses; a tag on the wire says of which.

    Attributes:
        reader: Name of the static method that reads it.
        python_type: Full name of the union of the classes, or of the only one.
    """

    kind: ClassVar[str] = "variant"
    reader: str
    python_type: str
    tag_format: str
    options: tuple[PartValue, ...]

    @property
    def min_size(self) -> int:
        """Fewest bytes on the wire."""
        return self.tag_size + min(option.min_size for option in self.options)

    @property
    def tag_struct(self) -> str:
        """Name of the constant for the tag."""
        return struct_name(self.tag_format)

    @property
    def tag_size(self) -> int:
        """Bytes of the tag."""
        return struct.calcsize(f"<{self.tag_format}")

    @property
    def is_complex(self) -> bool:
        """Whether the reader has more branches than the style allows."""
        return len(self.options) + 1 > MAXIMUM_COMPLEXITY


@dataclass(frozen=True)
class ListValue:
    """A counted list.

    Attributes:
        stated: Smallest count that the definition states, which is not enforced.
    """

    kind: ClassVar[str] = "list"
    element: Fixed | Blob | PartValue | VariantValue
    count_format: str
    stated: int
    upper: int

    @property
    def python_type(self) -> str:
        """Type in Python."""
        kind = "MutableSequence" if self.is_of_octets else "list"
        return f"{kind}[{self.element.python_type}]"

    @property
    def is_of_octets(self) -> bool:
        """Whether its elements are records of one octet, which are read at once."""
        return isinstance(self.element, PartValue) and bool(self.element.part.octet)

    @property
    def count_struct(self) -> str:
        """Name of the constant for the count."""
        return struct_name(self.count_format)

    def sized(self, value: str, field: str) -> str:
        """Returns the expression for the checked length of a value."""
        return f'sized({value}, 0, {self.upper}, "{field}")'

    def checked(self, field: str) -> str:
        """Returns the expression that checks a count on the wire, which is in `size`."""
        room = "len(buffer) - offset"
        return f'check_count(size, {self.upper}, {room}, {self.element_size}, "{field}")'

    @property
    def count_size(self) -> int:
        """Bytes of the count."""
        return struct.calcsize(f"<{self.count_format}")

    @property
    def min_size(self) -> int:
        """Fewest bytes on the wire."""
        return self.count_size

    @property
    def element_size(self) -> int:
        """Fewest bytes of an element; an element of no bytes would make any count legal."""
        return max(1, self.element.min_size)

    @property
    def range_text(self) -> str:
        """Legal counts in words."""
        shortest = f"{self.stated} .. " if self.stated else "up to "
        return f"{shortest}{self.upper} elements"


@dataclass(frozen=True)
class ArrayValue:
    """A list of a fixed number of elements, in wire order.

    Attributes:
        dimensions: Size of each dimension; the first varies slowest.
        struct: Name of the constant for all elements, when they are numbers or fixed strings.
    """

    kind: ClassVar[str] = "array"
    element: Fixed | Blob | PartValue | VariantValue
    dimensions: tuple[int, ...]
    struct: str = ""

    def checked(self, value: str, field: str) -> str:
        """Returns the expression for the elements of a value that has as many as it must."""
        return f'exactly({value}, {self.count}, "{field}")'

    @property
    def count(self) -> int:
        """Number of elements."""
        product = 1
        for size in self.dimensions:
            product *= size
        return product

    @property
    def python_type(self) -> str:
        """Type in Python."""
        return f"list[{self.element.python_type}]"

    @property
    def min_size(self) -> int:
        """Fewest bytes on the wire."""
        return self.count * self.element.min_size

    @property
    def range_text(self) -> str:
        """Number of elements in words."""
        return " x ".join(map(str, self.dimensions)) + " elements"


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
        """The value, as Python text, from the bytes in a local of its name."""
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
        """The line of the docstring."""
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
    """Consecutive members of fixed size, packed by one struct."""

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
        """The targets of the struct's unpack."""
        names = [member.attribute for member in self.members]
        names = ["presence", *names] if self.has_presence else names
        return f"({names[0]},)" if len(names) == 1 else ", ".join(names)


@dataclass(frozen=True)
class Single:
    """A member that is read and written by itself."""

    kind: ClassVar[str] = "single"
    member: Member
