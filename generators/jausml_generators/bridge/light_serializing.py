"""Statements that read and write a ROS message in its serialized form.

Numbers that follow each other are read and written by one `struct`, a run. A message with
`float64 x` and `string name` is read by

    run = _RUN_1[offset & 7 | order]
    row1 = run.unpack_from(data, offset)
    offset += run.size
    found1, offset = cdr_.text(data, offset, row1[1])
    return cls(row1[0], found1), offset

where `row1` has x and the length of the name. A run has a layout for each of the eight alignments;
`order` is 0 for little-endian data and 8 for big-endian ones.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from jausml.language.cdr import FieldLayout, Sizes, fields_of
from jausml.language.metamodel.classes import ros
from jausml_generators.python.names import Scope, snake_case
from jausml_generators.python.statements import call, long_string


@dataclass(frozen=True)
class _TextForm:
    """How a type of texts is serialized: the functions for one and for several, and its unit.

    Attributes:
        size: Bytes of a character, by which its length is counted.
    """

    read: str
    read_many: str
    encode: str
    write_many: str
    size: int


_TEXT_FORMS = {
    "string": _TextForm("cdr_.text", "cdr_.texts", "cdr_.encoded", "cdr_.put_texts", 1),
    "wstring": _TextForm(
        "cdr_.wide_text", "cdr_.wide_texts", "cdr_.wide", "cdr_.put_wide_texts", 4
    ),
}


def reading_lines(
    message: ros.MessageType, class_of: Callable[[ros.MessageType], str], runs: Runs, sizes: Sizes
) -> tuple[str, ...]:
    """Returns the body of a method that reads a message from `data` at `offset`."""
    reader = _Reader(class_of, runs, sizes)
    values = reader.values(message)
    reader.flush()
    instance = call("cls", *values)
    return (*reader.lines, f"return {instance}, offset")


class _Reader:
    def __init__(
        self, class_of: Callable[[ros.MessageType], str], runs: Runs, sizes: Sizes
    ) -> None:
        self.lines: list[str] = []
        self._class_of = class_of
        self._runs = runs
        self._sizes = sizes
        self._items: list[str] = []
        self._is_row_needed = False
        self._row_number = 1
        self._found_count = 0

    def values(self, message: ros.MessageType) -> list[str]:
        """Returns the values of the fields, as Python text.

        Those that stand in a row can be used behind the statements that `flush` adds.
        """
        fields = fields_of(message)
        if not fields:
            self._items.append("B")  # a message without fields takes a byte
        return [self._value(field) for field in fields]

    def flush(self) -> None:
        """Adds the statements that read the numbers in a row so far."""
        if not self._items:
            return
        row = f"row{self._row_number} = " if self._is_row_needed else ""
        self.lines += [
            f"run = {self._runs.name_of(self._items)}[offset & 7 | order]",
            f"{row}run.unpack_from(data, offset)",
            "offset += run.size",
        ]
        self._items.clear()
        self._is_row_needed = False
        self._row_number += 1

    def _item(self, item: str) -> str:
        self._items.append(item)
        self._is_row_needed = True
        return f"row{self._row_number}[{len(self._items) - 1}]"

    def _value(self, field: FieldLayout) -> str:
        if field.is_single:
            return self._single(field)
        if field.primitive is not None and field.is_fixed:
            code = field.primitive.code
            raw = self._item(f"{field.count}{code}")
            return call("cdr_.elements", f'"{code}"', raw, "order")
        count = str(field.count) if field.is_fixed else self._item("I")
        self.flush()
        if field.is_bounded:
            self.lines.append(call("cdr_.check_bound", count, str(field.count)))
        return self._sequence(field, count)

    def _single(self, field: FieldLayout) -> str:
        if field.primitive is not None:
            return self._item(field.primitive.code)
        if field.message is None:
            length = self._item("I")
            self.flush()
            form = _TEXT_FORMS[field.text]
            # The order of the bytes matters where a character has several.
            order = ["order"] if form.size > 1 else []
            return self._read(call(form.read, "data", "offset", length, *order))
        name = self._class_of(field.message)
        if self._sizes.is_inlined(field.message):
            return call(name, *self.values(field.message))
        self.flush()
        return self._read(call(f"{name}._read", "data", "offset", "order"))

    def _sequence(self, field: FieldLayout, count: str) -> str:
        if field.primitive is not None:
            code = f'"{field.primitive.code}"'
            return self._read(call("cdr_.vector", "data", "offset", count, code, "order"))
        if field.message is not None:
            function = f"{self._class_of(field.message)}._read_many"
        else:
            function = _TEXT_FORMS[field.text].read_many
        return self._read(call(function, "data", "offset", count, "order"))

    def _read(self, code: str) -> str:
        self._found_count += 1
        self.lines.append(f"found{self._found_count}, offset = {code}")
        return f"found{self._found_count}"


_OWN_NAMES = frozenset({"append", "cdr_", "len", "offset", "run", "self"})


def writing_lines(
    message: ros.MessageType, class_of: Callable[[ros.MessageType], str], runs: Runs, sizes: Sizes
) -> tuple[str, ...]:
    """Returns the body of a method that appends the message `self`, which begins at `offset`."""
    writer = _Writer(class_of, runs, sizes)
    writer.add(message, "self")
    return writer.finish()


class _Writer:
    def __init__(
        self, class_of: Callable[[ros.MessageType], str], runs: Runs, sizes: Sizes
    ) -> None:
        self._lines: list[str] = []
        # The offset behind the lines, as Python text; assigned when another line follows.
        self._offset = "offset"
        self._class_of = class_of
        self._runs = runs
        self._sizes = sizes
        self._names = Scope(_OWN_NAMES)
        self._items: list[str] = []
        self._values: list[str] = []

    def add(self, message: ros.MessageType, place: str) -> None:
        """Adds the fields of a message that stands at a place."""
        fields = fields_of(message)
        if not fields:
            self._item("B", "0")  # a message without fields takes a byte
        for field in fields:
            if field.is_single:
                self._single(field, f"{place}.{field.name}")
            elif field.is_fixed:
                self._array(field, f"{place}.{field.name}")
            else:
                self._sequence(field, f"{place}.{field.name}")

    def finish(self) -> tuple[str, ...]:
        """Returns all statements, of which the last returns the offset behind the message."""
        self._flush()
        return (*self._lines, f"return {self._offset}")

    def _flush(self) -> None:
        """Adds the statements that write the numbers in a row so far."""
        if not self._items:
            return
        self._add(
            f"run = {self._runs.name_of(self._items)}[offset & 7]",
            call("append", call("run.pack", *self._values)),
            "offset += run.size",
        )
        self._items.clear()
        self._values.clear()

    def _add(self, *lines: str) -> None:
        if self._offset != "offset":
            self._lines.append(f"offset = {self._offset}")
            self._offset = "offset"
        self._lines += lines

    def _put(self, function: str, *arguments: str) -> None:
        """Adds a call that appends bytes and returns the offset behind them."""
        self._add()
        self._offset = call(function, *arguments)

    def _item(self, item: str, value: str) -> None:
        self._items.append(item)
        self._values.append(value)

    def _local(self, place: str, code: str) -> str:
        name = self._names.claim(snake_case(place.rpartition(".")[2]))
        self._add(f"{name} = {code}")
        return name

    def _single(self, field: FieldLayout, place: str) -> None:
        if field.primitive is not None:
            is_byte = field.primitive.idl == "octet"
            self._item(field.primitive.code, call("cdr_.octet", place) if is_byte else place)
        elif field.message is None:
            self._text(field, place)
        elif self._sizes.is_inlined(field.message):
            has_fields = len(field.message.fields) > 0
            self.add(field.message, self._local(place, place) if has_fields else place)
        else:
            self._flush()
            self._put(f"{self._class_of(field.message)}._write", place, "append", "offset")

    def _text(self, field: FieldLayout, place: str) -> None:
        bound = (str(field.bound),) if field.bound else ()
        form = _TEXT_FORMS[field.text]
        name = self._local(place, call(form.encode, place, *bound))
        self._item("I", _count(name, form.size))
        self._flush()
        if form.size == 1:
            self._add(f"append({name})", f"offset += len({name})")
        else:
            self._put("cdr_.put", "append", "offset", name, str(form.size))

    def _array(self, field: FieldLayout, place: str) -> None:
        count = str(field.count)
        if field.primitive is not None:
            code = field.primitive.code
            raw = self._local(place, call("cdr_.raw", f'"{code}"', place, count))
            self._item(f"{field.count}{code}", raw)
            return
        name = self._local(place, call("cdr_.exactly", place, count))
        self._flush()
        self._elements(field, name)

    def _sequence(self, field: FieldLayout, place: str) -> None:
        code = place
        if field.is_bounded:
            code = call("cdr_.at_most", place, str(field.count))
        if field.primitive is None:
            name = self._local(place, code)
            self._item("I", f"len({name})")
            self._flush()
            self._elements(field, name)
            return
        size = field.primitive.size
        name = self._local(place, call("cdr_.raw", f'"{field.primitive.code}"', code))
        self._item("I", _count(name, size))
        self._flush()
        self._put("cdr_.put", "append", "offset", name, str(size))

    def _elements(self, field: FieldLayout, name: str) -> None:
        arguments = [name, "append", "offset"]
        if field.message is not None:
            function = f"{self._class_of(field.message)}._write_many"
        else:
            function = _TEXT_FORMS[field.text].write_many
            arguments += [str(field.bound)] if field.bound else []
        self._put(function, *arguments)


def _count(octets: str, size: int) -> str:
    """Returns the number of elements in octets, as Python text."""
    return f"len({octets}) // {size}" if size > 1 else f"len({octets})"


class Runs:
    """Names the layouts of rows of numbers; equal ones share a name.

    Attributes:
        names: Names by items, in the order in which they were asked for.
    """

    def __init__(self) -> None:
        self.names: dict[str, str] = {}

    def name_of(self, items: list[str]) -> str:
        """Returns the name of the layouts of a row.

        Args:
            items: Format characters of `struct`; with a number before it, one stands for the bytes
                of an array of that many.
        """
        return self.names.setdefault(" ".join(items), f"_RUN_{len(self.names) + 1}")

    @property
    def lines(self) -> tuple[str, ...]:
        """The statements that make the layouts."""
        return tuple(f"{name} = cdr_.run{_bracketed(items)}" for items, name in self.names.items())


def _bracketed(text: str) -> str:
    literal = long_string(text)
    return literal if literal.startswith("(") else f"({literal})"
