"""The values of a ROS message, and of the elements of its sequences, that are written as CDR."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from jausml.generation.literals import python_string
from jausml.language.metamodel.classes import ros
from jausml_generators.bridge.flat.cdr_chunks import SIZES
from jausml_generators.bridge.flat.cdr_leaves import (
    ManyLeaf,
    NumberLeaf,
    TextLeaf,
    WrittenLeaf,
    single_leaves,
)
from jausml_generators.bridge.flat.errors import NotFlatError
from jausml_generators.bridge.flat.limits import FINITE, SINGLE
from jausml_generators.bridge.flat.protocols import Given, Numbers, Place, Target
from jausml_generators.bridge.flat.vectors import NUMBERS
from jausml_generators.python.names import snake_case
from jausml_generators.python.statements import call, tuple_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml_generators.bridge.flat.constants import Constants
    from jausml_generators.python.names import Scope


@dataclass
class CdrValues:
    """What is given to a message or to an element of a sequence.

    Attributes:
        name: Full name of the message type.
        leaves: What it consists of.
        constants: The constants of the module.
        scope: The names of the function.
        values: Values by path.
        lists: Sequences that are given elements, by path.
    """

    name: str
    leaves: tuple[WrittenLeaf, ...]
    constants: Constants
    scope: Scope
    values: dict[str, Given] = field(default_factory=dict)
    lists: dict[str, CdrSequenceWriting] = field(default_factory=dict)

    @cached_property
    def _by_path(self) -> Mapping[str, WrittenLeaf]:
        return {each.path: each for each in self.leaves}

    def put(self, path: str, expression: str, *, conditional: bool = False) -> None:
        """Tells what has the value of a field.

        Args:
            path: The field; `.` for an element itself.
            expression: A local variable or a literal, as Python text. Numbers of an array are any
                sequence.
            conditional: Whether it is None where the field is given no value.

        Raises:
            NotFlatError: There is no such field.
        """
        own = "" if path == "." else path
        whole, _, index = own.rpartition("[")
        paths = self._by_path
        leaf = paths.get(own) or (paths.get(whole) if index else None)
        if leaf is None or (own not in paths and not isinstance(leaf, NumberLeaf)):
            raise NotFlatError(f"{self.name} has no {path} that a flat form writes")
        self.values[own] = Given(expression, conditional)

    def make(self, path: str, class_name: str) -> None:
        """Refuses: ROS messages are complete as they are made."""
        raise NotFlatError(f"{path} is made as {class_name}")

    def sequence(self, path: str) -> CdrSequenceWriting:
        """Tells that a sequence is given elements.

        Raises:
            NotFlatError: There is no such sequence.
        """
        leaf = self._by_path.get(path)
        if not isinstance(leaf, ManyLeaf) or path in self.lists:
            raise NotFlatError(f"{path} is no sequence that a flat form writes")
        found = CdrSequenceWriting(self.name, leaf, self.constants, self.scope)
        self.lists[path] = found
        return found

    def given(self, leaf: NumberLeaf) -> list[str]:
        """Returns the values of numbers."""
        whole = self.values.get(leaf.path)
        if len(leaf.defaults) == 1:
            return [whole.otherwise(leaf.defaults[0]) if whole else leaf.defaults[0]]
        if whole is not None:
            return [f"*{whole.code}"]
        found = [self.values.get(f"{leaf.path}[{index}]") for index in range(len(leaf.defaults))]
        pairs = zip(found, leaf.defaults, strict=True)
        return [each.otherwise(default) if each else default for each, default in pairs]


class CdrSequenceWriting:
    """Writes a sequence.

    Attributes:
        element: Writes one element.
        leaf: The sequence.
        rows: The variable of the values of its elements, or of all of them at once.
        is_vector: Whether it has all of them at once, as bytes.
    """

    def __init__(self, name: str, leaf: ManyLeaf, constants: Constants, scope: Scope) -> None:
        self.leaf = leaf
        self.rows = scope.claim(snake_case(leaf.path.rpartition(".")[2]))
        self.is_vector = False
        self.is_array = False
        self.is_sure = False
        self.constants = constants
        self.records = self.text = ""
        inner = tuple(single_leaves(leaf.field, "", None))
        self.element = CdrValues(name, inner, constants, scope)

    def begin(self) -> list[str]:
        """Returns the statements before the first element."""
        return [f"{self.rows}: Any = []" if self.is_array else f"{self.rows} = []"]

    def append(self) -> list[str]:
        """Returns the statements that add the element whose values are known."""
        values = [value for _, value in self.row]
        row = values[0] if len(values) == 1 else f"({', '.join(values)})"
        return [f"{self.rows}.append({row})"]

    def numbers(self) -> Numbers:
        """Returns what the elements are, when they are real numbers."""
        limits = {"f": SINGLE, "d": FINITE}.get(self.letter or "")
        if limits is None:
            raise NotFlatError(f"{self.leaf.path} has no real numbers")
        return Numbers("", self.letter or "", "{}", *limits)

    def columns(self, values: Mapping[str, str]) -> Target:
        """Returns how elements are written whose values are columns."""
        if self.letter is not None:
            (variable,) = values.values()
            return Target(self.rows, "", (Place(variable, "", _numbers(self.letter)),))
        fields, places, texts = [], [], []
        for leaf in self.element.leaves:
            if isinstance(leaf, TextLeaf):
                code = values.get(leaf.path, python_string(leaf.default))
                texts.append(code)
                fields.append(tuple_of('""', '"s"', "0"))
                continue
            if not isinstance(leaf, NumberLeaf) or len(leaf.defaults) > 1:
                raise NotFlatError(f"{self.leaf.path} has more than numbers")
            code = values.get(leaf.path, leaf.defaults[0])
            is_known = literal_of(code) is not None
            name = "" if is_known else snake_case(leaf.path.replace(".", "_"))
            if name:
                places.append(Place(code, name, _numbers(leaf.letter)))
            usual = code if is_known else "0"
            fields.append(tuple_of(python_string(name), python_string(leaf.letter), usual))
        last = self.element.leaves[-1]
        if len(texts) > 1 or not isinstance(last, NumberLeaf) or SIZES[last.letter] != 8:
            raise NotFlatError(f"{self.leaf.path} has elements that do not lie alike")
        self.records = self.constants.named("_RECORDS", call("CdrRecords", *fields))
        self.text = "".join(f", {each}" for each in texts)
        return Target(self.rows, f"{self.records}.make({{}}{self.text})", tuple(places))

    def take_array(self, *, is_sure: bool = False) -> str:
        """Returns the variable of the elements, which may be an array from now on."""
        self.is_array, self.is_sure = True, is_sure
        return self.rows

    def vector(self, expression: str) -> None:
        """Tells what has all elements, numbers of one type, at once.

        Args:
            expression: A local variable of a contiguous buffer, little endian, whose length is
                the number of elements: an array of numpy, or bytes.
        """
        if self.letter is None:
            raise NotFlatError(f"{self.leaf.path} is no sequence of numbers")
        self.rows, self.is_vector = expression, True

    @property
    def octet(self) -> str | None:
        """The path of the number, which is the element, when that is one octet; None for others."""
        return "" if self.letter in {"b", "B"} else None

    @property
    def letter(self) -> str | None:
        """Letter of the elements in struct formats; None when they are no numbers."""
        (first, *others) = self.element.leaves
        is_number = isinstance(self.leaf.field, ros.PrimitiveField) and not others
        return first.letter if isinstance(first, NumberLeaf) and is_number else None

    @property
    def row(self) -> list[tuple[str, str]]:
        """Paths of the elements that differ from one to the next, and their values."""
        defaults = {
            f"{leaf.path}[{i}]" if len(leaf.defaults) > 1 else leaf.path: default
            for leaf in self.element.leaves
            if isinstance(leaf, NumberLeaf)
            for i, default in enumerate(leaf.defaults)
        } | {
            each.path: python_string(each.default)
            for each in self.element.leaves
            if isinstance(each, TextLeaf)
        }
        return [
            (path, given.otherwise(defaults.get(path, "()")))
            for path, given in self.element.values.items()
            if given.conditional or literal_of(given.code) is None
        ]


def _numbers(letter: str) -> Numbers:
    """Returns numbers as structs take them; of double precision they take all."""
    if letter == "d":
        return Numbers("", letter)
    if letter == "f":
        return Numbers("", letter, "{}", *SINGLE)
    if letter not in NUMBERS:
        raise NotFlatError(f"{letter} has no columns")
    bits = 8 * SIZES[letter]
    least, most = (-(2 ** (bits - 1)), 2 ** (bits - 1)) if letter.islower() else (0, 2**bits)
    return Numbers("", letter, "{}", str(least), str(most - 1), is_rounded=True)


def literal_of(code: str) -> object:
    """Returns the value of a literal; None for other expressions."""
    try:
        return ast.literal_eval(code)
    except (ValueError, SyntaxError):
        return None
