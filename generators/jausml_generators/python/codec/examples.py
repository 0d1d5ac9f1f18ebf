"""Examples of messages: their bytes, and what their numbers then hold, for generated tests."""

from __future__ import annotations

import struct
import textwrap
from collections.abc import Iterable, Mapping

from jausml.generation.literals import LINE_WIDTH, python_literal, python_string
from jausml_generators.python.codec.classes import BitFieldClass, ContainerClass, VariableFieldClass
from jausml_generators.python.codec.members import (
    ArrayValue,
    ListValue,
    Member,
    PartValue,
    VariantValue,
)
from jausml_generators.python.codec.messages import MessageView
from jausml_generators.python.codec.scalars import Bits, Blob, Fixed

_MARGIN = " " * 4
_LONGEST_EXAMPLE = 16_384  # bytes


def examples(messages: Iterable[MessageView]) -> tuple[str, ...]:
    """Returns tuples of class name and bytes, without those that are too long for a test."""
    pairs = ((view.class_name, example_bytes(view)) for view in messages)
    return tuple(_example(*example) for example in pairs if len(example[1]) <= _LONGEST_EXAMPLE)


def numbers(messages: Iterable[MessageView]) -> tuple[str, ...]:
    """Returns tuples of class name and what the scaled fields of the example hold."""
    pairs = ((message.class_name, example_numbers(message)) for message in messages)
    return tuple(_numbers(name, held) for name, held in pairs if held)


def _numbers(name: str, numbers: Mapping[str, float]) -> str:
    """Returns a tuple of a name and a dictionary."""
    items = (f"{python_string(key)}: {python_literal(value)}" for key, value in numbers.items())
    return f"({python_string(name)}, {{{', '.join(items)}}})"


def _example(name: str, data: bytes) -> str:
    """Returns a tuple of a name and the digits of some bytes, in lines when they are many."""
    line = f'("{name}", "{data.hex()}"),'
    if len(_MARGIN + line) <= LINE_WIDTH:
        return _MARGIN + line
    digits = textwrap.wrap(data.hex(" ", -4), LINE_WIDTH - 2 * len(_MARGIN))
    lines = ["(", *(_MARGIN + row for row in (f'"{name}",', '"""', *digits, '""",')), "),"]
    return "\n".join(_MARGIN + row for row in lines)


def example_bytes(view: MessageView) -> bytes:
    """Returns the code and the body of a message with every field present."""
    bits = {item.path: item for item in view.nested if isinstance(item, BitFieldClass)}
    return struct.pack("<H", view.code) + _Examples(bits).container(view.body)


def example_numbers(view: MessageView) -> dict[str, float]:
    """Returns the values of the scaled fields of the example, by attribute.

    Those in lists, variants and inner records are left out.
    """
    examples = _Examples({})
    values = {}
    for member in _present(view.body):
        value = member.value
        if isinstance(value, Fixed) and value.scale is not None:
            lower, upper = value.scale
            values[member.attribute] = lower + (upper - lower) * examples.share()
        elif not isinstance(value, Fixed | Blob):
            break
    return values


def _present(part: ContainerClass) -> list[Member]:
    # A definition with more optional members than bits (CBRNDetection) sends those with bits.
    known = (1 << 8 * part.presence_size) - 1
    return [member for member in part.members if member.bit <= known]


# Put together from the layout of the fields alone: a test holds the
# codec to something else than itself.
class _Examples:
    def __init__(self, bits: dict[str, BitFieldClass]) -> None:
        self._bits = bits
        self._scaled = 0

    def share(self) -> float:
        """Returns where in its range the next scaled field is.

        Neighbours differ, so that no two can be exchanged unseen. A fifteenth of the range is a
        whole number of steps for every width.
        """
        self._scaled += 1
        return (4 + self._scaled % 7) / 15

    def container(self, part: ContainerClass) -> bytes:
        present = _present(part)
        presence = sum(member.bit for member in present)
        body = b"".join(self.value(member.value) for member in present)
        return presence.to_bytes(part.presence_size, "little") + body

    def value(
        self, value: Fixed | Blob | PartValue | VariantValue | ListValue | ArrayValue
    ) -> bytes:
        if isinstance(value, Fixed):
            return self._fixed(value)
        if isinstance(value, Blob):
            content = b"x" * max(1, value.lower)
            return len(content).to_bytes(value.count_size, "little") + content
        if isinstance(value, ListValue):
            count = max(1, value.stated)
            return count.to_bytes(value.count_size, "little") + self.value(value.element) * count
        if isinstance(value, ArrayValue):
            return self.value(value.element) * value.count
        if isinstance(value, VariantValue):
            last = len(value.options) - 1
            return last.to_bytes(value.tag_size, "little") + self.value(value.options[last])
        if isinstance(value.part, ContainerClass):
            return self.container(value.part)
        if isinstance(value.part, VariableFieldClass):
            first = value.part.alternatives[0]
            return first.index.to_bytes(1, "little") + self._fixed(first.value)
        raise TypeError(f"{value.part.name} has no example")

    def _fixed(self, value: Fixed) -> bytes:
        if value.python_type == "str":
            return b"x".ljust(value.size, b"\0")
        if isinstance(value, Bits):
            subs = self._bits[value.python_type].sub_fields
            bits = sum(int(sub.value.default) - sub.value.offset << sub.low for sub in subs)
            return bits.to_bytes(value.size, "little")
        if value.scale is not None:
            steps = (1 << 8 * value.size) - 1
            return (steps // 15 * round(15 * self.share())).to_bytes(value.size, "little")
        number = float(value.default)
        if value.format in "fd":
            return struct.pack(f"<{value.format}", number)
        return struct.pack(f"<{value.format}", int(number) - value.offset)
