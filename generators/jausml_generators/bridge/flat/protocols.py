"""The two ends of a flat translation: what reads the source, and what writes the target.

What an end cannot do, it refuses with NotFlatError when it is asked for it: the translation has no
flat form then. A bit field as a whole (a TimeStamp) is the integer of its bits.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence


@dataclass(frozen=True)
class Octets:
    """A list of numbers of one octet each, as it stands in the bytes.

    Attributes:
        code: The octets, as Python text.
        path: Path of the number in an element; empty when the element is the number.
        is_signed: Whether the numbers are -128 .. 127.
    """

    code: str
    path: str
    is_signed: bool


@dataclass(frozen=True)
class Numbers:
    """A list of real numbers that stand one after the other, of the same type.

    Attributes:
        path: Path of the number in an element; empty when the element is the number.
        letter: Its letter in struct formats.
        value: Python text with `{}`: the number made of what stands in the bytes, or what is packed
            made of the number.
        lower: Least value that can be packed, as Python text; empty where all can.
        upper: Greatest value that can be packed.
        is_rounded: Whether what is packed is rounded to an integer.
    """

    path: str
    letter: str
    value: str = "{}"
    lower: str = ""
    upper: str = ""
    is_rounded: bool = False


@dataclass(frozen=True)
class Place:
    """Where a column is written.

    Attributes:
        variable: What has the numbers.
        name: Field of the records; empty for a list of plain numbers.
        numbers: What is packed.
    """

    variable: str
    name: str
    numbers: Numbers


@dataclass(frozen=True)
class Target:
    """How elements are written whose values are columns.

    Attributes:
        variable: What has the records afterwards.
        made: Python text of new records, with `{}` for their number; empty for plain numbers.
        places: Where each column is written.
    """

    variable: str
    made: str
    places: tuple[Place, ...]


@dataclass(frozen=True)
class Records:
    """The elements of a list as columns of numbers.

    Attributes:
        test: Condition that there are such columns, as Python text.
        lines: Statements before they are asked for.
        columns: The columns: local variables of a loop and the text of the column, which is an
            array of numpy, in groups of which the same is made.
        otherwise: Statements before a loop that runs instead.
    """

    test: str
    lines: tuple[str, ...]
    columns: tuple[Group, ...]
    otherwise: tuple[str, ...] = ()


@dataclass(frozen=True)
class Group:
    """Columns of which the same is made.

    Attributes:
        columns: Local variable and array of each, as Python text.
        value: Python text with `{}`: the numbers, made of arrays in double precision.
    """

    columns: tuple[tuple[str, str], ...]
    value: str = "{}"


@dataclass(frozen=True)
class Given:
    """What has the value of a field.

    Attributes:
        code: A local variable or a literal.
        conditional: Whether it is None where the field is given no value.
    """

    code: str
    conditional: bool

    def otherwise(self, default: str) -> str:
        """Returns the value, or the default where it is None, as Python text."""
        return (
            f"{default} if {self.code} is None else {self.code}" if self.conditional else self.code
        )


class Reading(Protocol):
    """Reads the wanted values of a message, or of an element of a list, out of its bytes.

    Paths are those of the readable translation, without its `source.`.
    """

    def value(self, path: str) -> str:
        """Asks for a value; returns the name of the local variable that has it after `lines`.

        It is None where an optional JAUS field is absent. An element of a list that is a value
        itself has the path `.`.

        Raises:
            NotFlatError: The path leads to no single value.
        """

    def sequence(self, path: str) -> SequenceReading:
        """Asks for a list."""

    def lines(self) -> Sequence[str]:
        """Returns the statements that load all that was asked for out of `data`.

        They read the whole message, elements of lists too, before anything is done with a value:
        bytes that are no such message raise DecodeError, and nothing else.
        """


class SequenceReading(Protocol):
    """Reads a list."""

    @property
    def count(self) -> str:
        """Python expression of the number of elements, after the lines of the message."""

    @property
    def element(self) -> Reading:
        """Reads one element; its values are there in the body of the loop."""

    def loop(self, body: Sequence[str], index: str = "", most: str = "") -> Sequence[str]:
        """Returns the loop over the elements.

        Args:
            body: What is done with each.
            index: A variable that gets the position of the element; empty for none.
            most: Variable of the number of elements that are gone through; empty for all.
        """

    def values(self) -> str:
        """Returns the expression of a list of all elements, which are numbers or texts."""

    def octets(self) -> Octets:
        """Returns the list as bytes, when its elements are numbers of one octet each.

        Raises:
            NotFlatError: They are not.
        """

    @property
    def plain_octets(self) -> Octets | None:
        """What `octets` would return, which is not asked for yet; None where it refuses."""

    def numbers(self) -> Numbers:
        """Returns what the elements are, when they are real numbers.

        Raises:
            NotFlatError: They are not.
        """

    def array(self) -> str:
        """Returns the expression of an array of numpy with what stands in the bytes."""

    @property
    def asked(self) -> Iterable[str]:
        """Local variables of the values that were asked for."""

    def records(self) -> Records:
        """Returns the elements as columns of those values that a loop asked for.

        Raises:
            NotFlatError: They are no numbers.
        """

    def vector(self) -> str:
        """Returns the Python expression of all elements, numbers of one type, at once."""


class Values(Protocol):
    """Takes the values of a message, or of an element of a list.

    Paths are those of the readable translation, without its `target.`. What is given no value has
    the one of a message as it is made.
    """

    def put(self, path: str, expression: str, *, conditional: bool = False) -> None:
        """Tells what has the value of a field.

        Args:
            path: The field.
            expression: A local variable or a literal, as Python text.
            conditional: Whether it is None where the field is given no value.

        A bit field as a whole is an integer; a negative one is a value that does not fit.
        """

    def make(self, path: str, class_name: str) -> None:
        """Tells that an optional part, or an option of a variant, is made, whatever holds.

        Args:
            path: The part.
            class_name: Its class in the readable translation, e.g. `ReportPath.PlannedLocalPath`.
        """

    def sequence(self, path: str) -> SequenceWriting:
        """Tells that a list is given elements."""


class Writing(Values, Protocol):
    """Writes a message with the given values as bytes."""

    def lines(self) -> Sequence[str]:
        """Returns the statements that make the bytes, with the return at their end.

        Values that have no place in them raise EncodeError.
        """


class SequenceWriting(Protocol):
    """Writes a list."""

    @property
    def element(self) -> Values:
        """Takes the values of one element."""

    @property
    def octet(self) -> str | None:
        """Path of the number in an element that is one octet; None for other elements."""

    def numbers(self) -> Numbers:
        """Returns what the elements are, when they are real numbers.

        Raises:
            NotFlatError: They are not.
        """

    def take_array(self, *, is_sure: bool = False) -> str:
        """Returns the variable of the elements, which may be an array of numpy from now on.

        It has what is packed, little endian; asked for before `begin`.

        Args:
            is_sure: Whether it is one whatever holds; nothing begins or appends then.
        """

    def columns(self, values: Mapping[str, str]) -> Target:
        """Returns how elements are written whose values are columns.

        Args:
            values: What has each value: a variable of an array, of a text or number that all
                share, or a literal.

        Raises:
            NotFlatError: They are not written so.
        """

    def begin(self) -> Sequence[str]:
        """Returns the statements before the first element."""

    def append(self) -> Sequence[str]:
        """Returns the statements that add the element whose values are known."""

    def vector(self, expression: str) -> None:
        """Tells what has all elements, numbers of one type, at once."""
