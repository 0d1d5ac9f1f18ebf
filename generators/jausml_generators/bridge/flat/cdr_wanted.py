"""What is wanted of a ROS message by those who read it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from jausml.generation.literals import python_string
from jausml_generators.bridge.flat.cdr_layout import (
    SIZES,
    Leaf,
    Many,
    Number,
    Text,
    element_leaves,
)
from jausml_generators.bridge.flat.errors import NotFlatError
from jausml_generators.bridge.flat.loops import loop_over
from jausml_generators.bridge.flat.protocols import Group, Numbers, Octets, Records
from jausml_generators.bridge.flat.vectors import NUMBERS
from jausml_generators.python.names import snake_case

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from jausml_generators.python.names import Scope


_STEP = " " * 4


class CdrSequenceReading:
    """Reads a sequence.

    Attributes:
        count: Python expression of the number of elements.
        element: Reads one element.
        items: Name of the local variable that has the wanted values of all elements.
    """

    def __init__(self, leaf: Many, scope: Scope) -> None:
        self._scope = scope
        self.leaf = leaf
        self.is_bytes = False
        self.is_array = False
        self.are_records = False
        self.items = scope.claim(snake_case(leaf.path.rpartition(".")[2]))
        self.count = f"len({self.items})"
        leaves = element_leaves(leaf.field, "")
        values: dict[str, Leaf] = {each.path: each for each in leaves if not isinstance(each, Many)}
        self.element = CdrWanted(scope, values)

    def loop(self, body: Sequence[str], index: str = "", most: str = "") -> Sequence[str]:
        """Returns the loop over the elements."""
        items = f"{self.items}[:{most}]" if most else self.items
        targets = self.element.targets
        if self.is_array:
            items, targets = f"{items}.tolist()", targets.strip("(,)")
        lines = loop_over(items, targets, index, self._scope)
        return [*lines, *(f"{_STEP}{line}" for line in body)]

    def values(self) -> str:
        """Returns the expression of a list of all elements."""
        self.element.value("")
        if self.is_array:
            return f"{self.items}.tolist()"
        return f"[each[0] for each in {self.items}]"

    @property
    def letter(self) -> str:
        """Letter of the elements in struct formats; empty when they are no numbers."""
        inner = tuple(element_leaves(self.leaf.field, ""))
        (first, *others) = inner
        return first.letter if isinstance(first, Number) and not (first.path or others) else ""

    def octets(self) -> Octets:
        """Returns the sequence as bytes, when its elements are numbers of one octet each."""
        found = self.plain_octets
        if found is None:
            raise NotFlatError(f"{self.leaf.path} has no octets")
        self.is_bytes = True
        return found

    @property
    def plain_octets(self) -> Octets | None:
        """What `octets` would return, which is not asked for yet; None where it refuses."""
        letter = self.letter
        if letter not in {"b", "B"} or self.element.names:
            return None
        return Octets(self.items, "", is_signed=letter == "b")

    def numbers(self) -> Numbers:
        """Returns what the elements are, when they are real numbers."""
        letter = self.letter
        if letter not in {"f", "d"} or self.element.names:
            raise NotFlatError(f"{self.leaf.path} has no real numbers")
        return Numbers("", letter)

    def array(self) -> str:
        """Returns the variable of the elements, which is an array of numpy."""
        self.is_array = True
        return self.items

    @property
    def asked(self) -> Iterable[str]:
        """Local variables of the values that were asked for."""
        return self.element.names.values()

    def records(self) -> Records:
        """Returns the elements as columns of those values that a loop asked for."""
        numbers = {
            self.element.names[leaf.path]: leaf.letter
            for leaf in self.element.leaves.values()
            if leaf.path in self.element.names and isinstance(leaf, Number)
        }
        if len(numbers) < len(self.element.names) or not set(numbers.values()) <= NUMBERS:
            raise NotFlatError(f"{self.leaf.path} has more than numbers")
        if self.letter:
            (name,) = numbers
            self.is_array = True
            return Records(f"{self.count} >= LEAST", (), (Group(((name, self.items),)),))
        inner = tuple(element_leaves(self.leaf.field, ""))
        even = even_layout(inner)
        if even.tail if even is not None else not has_one_text(inner):
            raise NotFlatError(f"{self.leaf.path} has elements that do not lie alike")
        self.are_records = True
        found = (Group(tuple((each, f"{self.items}[{python_string(each)}]") for each in numbers)),)
        listed = (
            f"if not isinstance({self.items}, list):",
            f"{_STEP}{self.items} = {self.items}.tolist()",
        )
        return Records(f"not isinstance({self.items}, list)", (), found, listed)

    def vector(self) -> str:
        """Refuses what no end reads at once."""
        raise NotFlatError(f"{self.leaf.path} is not read at once")


@dataclass
class CdrWanted:
    """The values of a message or element that were asked for.

    Attributes:
        scope: Names of local variables.
        leaves: What it consists of, by path.
        names: Names of local variables by path.
        sequences: The lists that were asked for, by path.
    """

    scope: Scope
    leaves: dict[str, Leaf]
    names: dict[str, str] = field(default_factory=dict)
    sequences: dict[str, CdrSequenceReading] = field(default_factory=dict)

    def value(self, path: str) -> str:
        """Asks for a value; returns the name of the local variable that has it."""
        path = "" if path == "." else path
        leaf = self.leaves.get(path)
        if not isinstance(leaf, Number | Text):
            raise NotFlatError(f"{path} is no single value")
        if path not in self.names:
            words = path.replace("[", "_").replace("]", "").split(".")
            self.names[path] = self.scope.claim(snake_case("_".join(words[-2:]) or "value"))
        return self.names[path]

    def sequence(self, path: str) -> CdrSequenceReading:
        """Asks for a list."""
        leaf = self.leaves.get(path)
        if not isinstance(leaf, Many):
            raise NotFlatError(f"{path} is no sequence")
        if path not in self.sequences:
            self.sequences[path] = CdrSequenceReading(leaf, self.scope)
        return self.sequences[path]

    def lines(self) -> Sequence[str]:
        """Returns nothing: elements are read with the message that has them."""
        return ()

    @property
    def targets(self) -> str:
        """What the wanted values of one element are assigned to, in the order of the bytes."""
        names = [self.names[path] for path in self.leaves if path in self.names]
        if not names:
            return "_"
        return f"({names[0]},)" if len(names) == 1 else ", ".join(names)


@dataclass(frozen=True)
class Even:
    """Elements that all lie alike.

    Attributes:
        stride: Bytes from one to the next.
        alignment: Alignment of each.
        tail: Bytes that the last one is shorter.
    """

    stride: int
    alignment: int
    tail: int


def even_layout(inner: Sequence[Leaf]) -> Even | None:
    """Returns how elements lie if they all do so alike; None for others."""
    numbers = [leaf for leaf in inner if isinstance(leaf, Number)]
    if len(numbers) < len(inner):
        return None
    sizes = [SIZES[number.letter] for number in numbers]
    if max(sizes) > sizes[0]:
        return None
    place = 0
    for size in sizes:
        place += -place % size + size
    tail = -place % sizes[0]
    return Even(place + tail, sizes[0], tail)


def has_one_text(inner: Sequence[Leaf]) -> bool:
    """Whether elements may lie alike: a text of one length, and numbers."""
    kinds = [type(leaf) for leaf in inner]
    return kinds.count(Text) == 1 and Many not in kinds
