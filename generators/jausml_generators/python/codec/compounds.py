"""Values made of other values: parts, variants, lists and arrays (SAE AS5684 containers)."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar, Protocol

from jausml_generators.python.codec.scalars import struct_name

if TYPE_CHECKING:
    from jausml_generators.python.codec.scalars import Blob, Fixed

MAXIMUM_COMPLEXITY = 10


class Part(Protocol):
    """A dataclass inside a message class, as far as values of it are concerned."""

    @property
    def name(self) -> str:
        """Name of the class."""

    @property
    def jaus_name(self) -> str:
        """Name in the model of what it is the class of."""

    @property
    def min_size(self) -> int:
        """Fewest bytes on the wire."""

    @property
    def row(self) -> tuple[str, ...]:
        """Arguments of the layout of a record of numbers; none where it is no such record."""


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
        return self.tag_size + min(o.min_size for o in self.options)

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
        kind = "MutableSequence" if self.is_of_rows else "list"
        return f"{kind}[{self.element.python_type}]"

    @property
    def is_of_rows(self) -> bool:
        """Whether its elements are records of numbers, which are gone over at once."""
        return isinstance(self.element, PartValue) and bool(self.element.part.row)

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
