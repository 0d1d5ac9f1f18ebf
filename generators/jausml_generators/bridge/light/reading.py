"""Statements that read a ROS message out of its serialized form."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml_generators.bridge.light.layout import fields_of
from jausml_generators.python.statements import call

if TYPE_CHECKING:
    from collections.abc import Callable

    from jausml.language.metamodel.classes import ros
    from jausml_generators.bridge.light.layout import FieldLayout, Sizes
    from jausml_generators.bridge.light.runs import Runs


def reading_lines(
    message: ros.MessageType,
    class_of: Callable[[ros.MessageType], str],
    runs: Runs,
    sizes: Sizes,
) -> tuple[str, ...]:
    """Returns the body of a method that reads a message from `data` at `offset`."""
    reader = _Reader(class_of, runs, sizes)
    values = reader.values(message)
    reader.flush()
    made = call("cls", *values)
    return (*reader.lines, f"return {made}, offset")


class _Reader:
    def __init__(
        self, class_of: Callable[[ros.MessageType], str], runs: Runs, sizes: Sizes
    ) -> None:
        self.lines: list[str] = []
        self._class_of = class_of
        self._runs = runs
        self._sizes = sizes
        self._items: list[str] = []
        self._is_used = False
        self._rows = 1
        self._found = 0

    def values(self, message: ros.MessageType) -> list[str]:
        """The values of the fields, as Python text; those of rows after `flush` only."""
        fields = fields_of(message)
        if not fields:
            self._items.append("B")  # a message without fields takes a byte
        return [self._value(field) for field in fields]

    def flush(self) -> None:
        """Adds the statements that read the numbers in a row so far."""
        if not self._items:
            return
        row = f"row{self._rows} = " if self._is_used else ""
        self.lines += [
            f"run = {self._runs.name_of(self._items)}[offset & 7 | order]",
            f"{row}run.unpack_from(data, offset)",
            "offset += run.size",
        ]
        self._items.clear()
        self._is_used = False
        self._rows += 1

    def _item(self, item: str) -> str:
        self._items.append(item)
        self._is_used = True
        return f"row{self._rows}[{len(self._items) - 1}]"

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
            if field.text == "string":
                return self._read(call("cdr_.text", "data", "offset", length))
            return self._read(call("cdr_.wide_text", "data", "offset", length, "order"))
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
            function = "cdr_.texts" if field.text == "string" else "cdr_.wide_texts"
        return self._read(call(function, "data", "offset", count, "order"))

    def _read(self, code: str) -> str:
        self._found += 1
        self.lines.append(f"found{self._found}, offset = {code}")
        return f"found{self._found}"
