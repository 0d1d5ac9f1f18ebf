"""Reads the wanted values of a ROS message out of its bytes (CDR)."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.generation.literals import python_string
from jausml_generators.bridge.flat.cdr_layout import (
    SIZES,
    Leaf,
    Many,
    Number,
    Text,
    element_leaves,
    leaves,
)
from jausml_generators.bridge.flat.cdr_wanted import (
    CdrSequenceReading,
    CdrWanted,
    Even,
    even_layout,
    has_one_text,
)
from jausml_generators.bridge.flat.vectors import dtype
from jausml_generators.bridge.translation.ros_fields import full_name
from jausml_generators.python.statements import call, tuple_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.language.metamodel.classes import ros
    from jausml_generators.bridge.flat.constants import Constants
    from jausml_generators.python.names import Scope


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
        self._wanted = CdrWanted(scope, {leaf.path: leaf for leaf in self._leaves})

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

    def read(self, found: Sequence[Leaf], wanted: CdrWanted) -> None:
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

    def _many(self, leaf: Many, wanted: CdrWanted) -> None:
        self._number("I", "count")
        self._flush()
        self._is_checked = False
        reading = wanted.sequences.get(leaf.path)
        inner = tuple(element_leaves(leaf.field, ""))
        even = even_layout(inner)
        if reading is not None:
            self._read_elements(reading, inner, even)
        elif even is not None:
            self._skip(even)
        else:
            with self._loop():
                self.read(inner, CdrWanted(self._scope, {}))

    def _skip(self, even: Even) -> None:
        """Goes behind elements that all lie alike."""
        code = self._first(even)
        tail = f" - ({even.tail} if count else 0)" if even.tail else ""
        self._go_to(f"{code} + count * {even.stride}{tail}")

    def _first(self, even: Even) -> str:
        """Returns the place of the first element; without any, nothing is aligned."""
        place = self._place
        if place.modulus % even.alignment == 0 and place.remainder % even.alignment == 0:
            return place.code
        before = place.ahead + _WIDEST - 1 - _ENCAPSULATION
        base = f"{place.base} + {before}" if place.base else f"{before}"
        return f"(({base} & -{_WIDEST}) + {_ENCAPSULATION} if count else {place.code})"

    def _read_elements(
        self, reading: CdrSequenceReading, inner: Sequence[Leaf], even: Even | None
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
        self, reading: CdrSequenceReading, inner: Sequence[Leaf], element: CdrWanted
    ) -> None:
        """Reads the elements behind the first at once, where they lie as it does."""
        if not has_one_text(inner) or not element.names:
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

    def records(self, element: CdrWanted) -> str:
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
