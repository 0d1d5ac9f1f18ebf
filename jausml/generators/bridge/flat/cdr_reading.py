"""Reads the wanted values of a ROS message out of its bytes (CDR)."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from jausml.generation.literals import python_string
from jausml.generators.bridge.flat.cdr_layout import (
    SIZES,
    Leaf,
    Many,
    Number,
    Text,
    element_leaves,
    leaves,
)
from jausml.generators.bridge.flat.errors import NotFlatError
from jausml.generators.bridge.flat.loops import loop_over
from jausml.generators.bridge.flat.protocols import Group, Numbers, Octets, Records
from jausml.generators.bridge.flat.vectors import NUMBERS, dtype
from jausml.generators.bridge.translation.ros_fields import full_name
from jausml.generators.python.names import snake_case
from jausml.generators.python.statements import call, tuple_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from jausml.generators.bridge.flat.constants import Constants
    from jausml.generators.python.names import Scope
    from jausml.metamodel.classes import ros

_STEP = " " * 4
_ENCAPSULATION = 4
_WIDEST = 8


class CdrReading:
    """Reads a whole message.

    Args:
        message_type: Its type.
        constants: Constants of the module.
        scope: Names of local variables.
    """

    def __init__(self, message_type: ros.MessageType, constants: Constants, scope: Scope) -> None:
        self._name = full_name(message_type)
        self._constants = constants
        self._scope = scope
        self._leaves = tuple(leaves(message_type))
        self._wanted = _Wanted(scope, {leaf.path: leaf for leaf in self._leaves})

    def value(self, path: str) -> str:
        """Asks for a value; returns the name of the local variable that has it."""
        return self._wanted.value(path)

    def sequence(self, path: str) -> CdrSequenceReading:
        """Asks for a list."""
        return self._wanted.sequence(path)

    def lines(self) -> Sequence[str]:
        """Returns the statements that load all that was asked for out of `data`."""
        walk = _Walk(self._constants, self._scope)
        walk.read(self._leaves, self._wanted)
        walk.end()
        refused = f"raise DecodeError({python_string(self._name)}, str(error)) from None"
        return [
            "try:",
            # 0 is big, 1 is little endian; all others are of other encodings.
            f"{_STEP}order = data[0] << 8 | data[1]",
            *(f"{_STEP}{line}" for line in walk.lines),
            "except (struct.error, IndexError) as error:",
            f"{_STEP}{refused}",
        ]


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
        self.element = _Wanted(scope, values)

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
        even = _even(inner)
        if even.tail if even is not None else not _has_one_text(inner):
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
class _Wanted:
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


@dataclass
class _Place:
    """What is known of the present place in the bytes.

    Attributes:
        base: Local variable that it is counted from; empty for the begin of the bytes.
        ahead: Bytes behind that.
        modulus: Greatest alignment of which the remainder is known.
        remainder: That remainder, counted from behind the encapsulation.
    """

    base: str
    ahead: int
    modulus: int
    remainder: int

    @property
    def code(self) -> str:
        """The place as Python text."""
        if not self.base:
            return str(self.ahead)
        return f"{self.base} + {self.ahead}" if self.ahead else self.base

    def advance(self, size: int) -> None:
        """Goes on by some bytes."""
        self.ahead += size
        self.remainder = (self.remainder + size) % self.modulus


class _Walk:
    """The statements that read leaves one after the other.

    Values of fixed size that follow each other are read by one struct.

    Attributes:
        lines: The statements.
    """

    def __init__(self, constants: Constants, scope: Scope) -> None:
        self._constants = constants
        self._scope = scope
        self.lines: list[str] = []
        self._place = _Place("", _ENCAPSULATION, _WIDEST, 0)
        self._start = self._place.code
        self._format: list[str] = []
        self._targets: list[str] = []
        self._is_checked = False
        self._margin = ""

    # -- statements ------------------------------------------------------------------------------

    def _add(self, line: str) -> None:
        self.lines.append(f"{self._margin}{line}")

    def end(self) -> None:
        """Reads what is left, and checks that the bytes do not end before."""
        self._flush()
        if not self._is_checked:
            self._add(f"if {self._place.code} > len(data):")
            self._add(f'{_STEP}raise IndexError("the bytes end too early")')

    def read(self, found: Sequence[Leaf], wanted: _Wanted) -> None:
        """Reads leaves.

        Args:
            found: The leaves.
            wanted: What is wanted of them.
        """
        for leaf in found:
            match leaf:
                case Number():
                    self._number(leaf.letter, wanted.names.get(leaf.path, ""))
                case Text():
                    self._text(wanted.names.get(leaf.path, ""))
                case Many():
                    self._many(leaf, wanted)

    # -- runs of fixed size ----------------------------------------------------------------------

    def _number(self, letter: str, target: str) -> None:
        size = SIZES[letter]
        self._align(size)
        self._format.append(letter if target else f"{size}x")
        if target:
            self._targets.append(target)
        self._place.advance(size)
        self._is_checked = False

    def _align(self, size: int) -> None:
        place = self._place
        if place.modulus % size == 0:
            pad = -place.remainder % size
            if pad:
                self._format.append(f"{pad}x")
                place.advance(pad)
            return
        self._flush()
        # What is counted from behind the encapsulation is aligned, not the index.
        before = place.ahead + size - 1 - _ENCAPSULATION % size
        rest = _ENCAPSULATION % size
        code = f"{place.base} + {before} & -{size}" if before else f"{place.base} & -{size}"
        self._go_to(f"({code}) + {rest}" if rest else code, size)

    def _go_to(self, code: str, modulus: int = 1) -> None:
        """Counts from a place that is computed."""
        if code != "offset":
            self._add(f"offset = {code}")
        self._place = _Place("offset", 0, modulus, 0)
        self._start = self._place.code

    def _flush(self) -> None:
        """Reads the values of fixed size since the last place that was computed."""
        if self._targets:
            # One struct for each order of bytes, so that the order chooses.
            reader = self.reader("unpack_from")
            names = self._targets
            targets = f"({names[0]},)" if len(names) == 1 else ", ".join(names)
            self._add(f"{targets} = {reader}[order](data, {self._start})")
            self._is_checked = True
        self._format, self._targets = [], []
        self._start = self._place.code

    # -- texts -----------------------------------------------------------------------------------

    def _text(self, target: str) -> None:
        self._number("I", "size")
        self._flush()
        begin = self._place.code
        self._go_to(f"{begin} + size")
        self._is_checked = False
        if target:
            if begin.startswith("offset"):
                begin = "offset - size"
            self._add(f'{target} = data[{begin} : offset - 1].decode("utf-8", "replace")')

    # -- sequences -------------------------------------------------------------------------------

    def _many(self, leaf: Many, wanted: _Wanted) -> None:
        self._number("I", "count")
        self._flush()
        self._is_checked = False
        reading = wanted.sequences.get(leaf.path)
        inner = tuple(element_leaves(leaf.field, ""))
        even = _even(inner)
        if reading is not None:
            self._read_elements(reading, inner, even)
        elif even is not None:
            self._skip(even)
        else:
            with self._loop():
                self.read(inner, _Wanted(self._scope, {}))

    def _skip(self, even: _Even) -> None:
        """Goes behind elements that all lie alike."""
        code = self._first(even)
        tail = f" - ({even.tail} if count else 0)" if even.tail else ""
        self._go_to(f"{code} + count * {even.stride}{tail}")

    def _first(self, even: _Even) -> str:
        """Returns the place of the first element; without any, nothing is aligned."""
        place = self._place
        if place.modulus % even.alignment == 0 and place.remainder % even.alignment == 0:
            return place.code
        before = place.ahead + _WIDEST - 1 - _ENCAPSULATION
        base = f"{place.base} + {before}" if place.base else f"{before}"
        return f"(({base} & -{_WIDEST}) + {_ENCAPSULATION} if count else {place.code})"

    def _read_elements(
        self, reading: CdrSequenceReading, inner: Sequence[Leaf], even: _Even | None
    ) -> None:
        element, items = reading.element, reading.items
        if even is None:
            self._add(f"{items}: Any = []" if reading.are_records else f"{items} = []")
            with self._loop():
                self.read(inner, element)
                self._flush()
                targets = element.targets
                self._add(f"{items}.append({targets if targets[:1] == '(' else f'({targets})'})")
                self._read_alike(reading, inner, element)
            return
        start = self._scope.claim("start")
        first = self._first(even)
        self._add(f"{start} = {first[1:-1] if first.startswith('((') else first}")
        tail = f" - ({even.tail} if count else 0)" if even.tail else ""
        self._place = _Place(start, 0, 1, 0)
        self._go_to(f"{start} + count * {even.stride}{tail}")
        self._add("if offset > len(data):")
        self._add(f'{_STEP}raise IndexError("the bytes end too early")')
        walk = _Walk(self._constants, self._scope)
        walk.read(inner, element)
        if reading.is_bytes:
            self._add(f"{items} = data[{start}:offset]")
        elif reading.is_array:
            orders = ", ".join(dtype(reading.letter, mark) for mark in "><")
            types = self._constants.named("_TYPES", f"({orders})")
            self._add(f"{items} = numpy.frombuffer(data, {types}[order], count, {start})")
        elif not element.names:
            self._add(f"{items} = range(count)")
        elif even.tail:
            reader = walk.reader("unpack_from")
            steps = f"range({start}, offset, {even.stride})"
            self._add(f"{items} = [{reader}[order](data, each) for each in {steps}]")
        else:
            reader = walk.reader("iter_unpack")
            rows = f"list({reader}[order](data[{start}:offset]))"
            if reading.are_records:
                kinds = walk.records(element)
                records = f"numpy.frombuffer(data, {kinds}[order], count, {start})"
                rows = f"{records} if count >= LEAST else {rows}"
            self._add(f"{items}{': Any' if reading.are_records else ''} = {rows}")

    def _read_alike(
        self, reading: CdrSequenceReading, inner: Sequence[Leaf], element: _Wanted
    ) -> None:
        """Reads the elements behind the first at once, where they lie as it does."""
        if not _has_one_text(inner) or not element.names:
            return
        fields, names = [], []
        for leaf in inner:
            if isinstance(leaf, Text) and leaf.path in element.names:
                return
            if isinstance(leaf, Number):
                fields.append(leaf.letter if leaf.path in element.names else f"x{leaf.letter}")
                names += [element.names[leaf.path]] if leaf.path in element.names else []
            else:
                fields.append("s")
        texts, items = [python_string(each) for each in fields], reading.items
        if self._place.code != "offset":
            self._add(f"offset = {self._place.code}")
        self._add(f"if len({items}) == 1 < count:")
        if reading.are_records:
            known = tuple_of(*map(python_string, names))
            rows = self._constants.named("_ROWS", call("CdrRecordRows", known, *texts))
            arguments = f"data, offset, size, {items}, count, order"
            self._add(f"{_STEP}{items}, offset = {rows}.read_all({arguments})")
            self._add(f"{_STEP}if len({items}) > 1:")
        else:
            rows = self._constants.named("_ROWS", call("CdrRows", *texts))
            self._add(f"{_STEP}alike, offset = {rows}.read(data, offset, size, count - 1, order)")
            self._add(f"{_STEP}if alike:")
            self._add(f"{_STEP * 2}{items} += alike")
        self._add(f"{_STEP * 2}break")
        self._go_to("offset")

    def records(self, element: _Wanted) -> str:
        """Returns the name of the constant that has the types of what was laid out as records."""
        names = [element.names[path] for path in element.leaves if path in element.names]
        known = tuple_of(*map(python_string, names))
        text = _packed_format(self._format)
        kinds = [
            call("record", self._constants.struct(f"{mark}{text}"), known, python_string(mark))
            for mark in "><"
        ]
        return self._constants.named("_RECORDS", tuple_of(*kinds))

    def reader(self, method: str) -> str:
        """Returns the name of the constant that has a method of the structs of what was laid out.

        Args:
            method: A method of `struct.Struct`.
        """
        text = _packed_format(self._format)
        pair = [self._constants.struct(f"{mark}{text}") for mark in "><"]
        return self._constants.named("_READ", f"({pair[0]}.{method}, {pair[1]}.{method})")

    @contextmanager
    def _loop(self) -> Iterator[None]:
        # Elements have bytes: a count that no message holds ends here.
        self._add("if count > len(data):")
        self._add(f'{_STEP}raise IndexError("the bytes end too early")')
        if self._place.code != "offset":
            self._add(f"offset = {self._place.code}")
        self._add("for _ in range(count):")
        self._margin += _STEP
        self._place = _Place("offset", 0, 1, 0)
        self._start = "offset"
        yield
        self._flush()
        self._go_to(self._place.code)
        self._margin = self._margin[: -len(_STEP)]
        self._is_checked = False


@dataclass(frozen=True)
class _Even:
    """Elements that all lie alike.

    Attributes:
        stride: Bytes from one to the next.
        alignment: Alignment of each.
        tail: Bytes that the last one is shorter.
    """

    stride: int
    alignment: int
    tail: int


def _even(inner: Sequence[Leaf]) -> _Even | None:
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
    return _Even(place + tail, sizes[0], tail)


def _has_one_text(inner: Sequence[Leaf]) -> bool:
    """Whether elements may lie alike: a text of one length, and numbers."""
    kinds = [type(leaf) for leaf in inner]
    return kinds.count(Text) == 1 and Many not in kinds


def _packed_format(parts: Sequence[str]) -> str:
    """Returns a struct format whose neighbouring pads and letters are joined."""
    text, pads = "", 0
    for part in [*parts, ""]:
        if part.endswith("x"):
            pads += int(part[:-1])
            continue
        text += (f"{pads}x" if pads else "") + part
        pads = 0
    return text
