"""Hypothesis strategies for the messages that views describe: only legal values."""

import re
import struct
from typing import Any

from hypothesis import strategies as st

from jausml_generators.python.codec.classes import BitFieldClass, ContainerClass, VariableFieldClass
from jausml_generators.python.codec.messages import MessageView
from jausml_generators.python.codec.scalars import Bits, Fixed

LATIN1 = st.characters(max_codepoint=255, exclude_characters="\0")


def messages(view: MessageView, cls: Any) -> st.SearchStrategy[Any]:
    """Returns messages with any legal fields."""
    return _Strategies(view, cls).container(view.body, cls)


class _Strategies:
    def __init__(self, view: MessageView, cls: Any) -> None:
        self.cls = cls
        self.bits = {item.path: item for item in view.nested if isinstance(item, BitFieldClass)}

    def container(self, part: ContainerClass, cls: Any) -> st.SearchStrategy[Any]:
        sendable = (1 << 8 * part.presence_size) - 1
        fields = {
            member.attribute: self.optional(member)
            for member in part.members
            if member.bit <= sendable
        }
        return st.builds(cls, **fields)

    def optional(self, member: Any) -> st.SearchStrategy[Any]:
        value = self.value(member.value)
        return st.none() | value if member.is_optional else value

    def value(self, value: Any) -> st.SearchStrategy[Any]:
        if isinstance(value, Bits):
            subs = self.bits[value.python_type].sub_fields
            numbers = {sub.attribute: fixed(sub.value) for sub in subs}
            return st.builds(self.nested(value.python_type), **numbers)
        if isinstance(value, Fixed):
            return fixed(value)
        if value.kind == "blob":
            upper = min(value.upper, value.lower + 9)
            if value.is_text:
                return st.text(LATIN1, min_size=value.lower, max_size=upper)
            return st.binary(min_size=value.lower, max_size=upper)
        if value.kind == "list":
            upper = min(value.upper, value.stated + 2)
            return st.lists(self.value(value.element), min_size=value.stated, max_size=upper)
        if value.kind == "array":
            return st.lists(self.value(value.element), min_size=value.count, max_size=value.count)
        if value.kind == "variant":
            return st.one_of(
                self.container(option.part, self.nested(option.part.path))
                for option in value.options
            )
        return self.part(value.part)

    def part(self, part: ContainerClass | VariableFieldClass) -> st.SearchStrategy[Any]:
        cls = self.nested(part.path)
        if isinstance(part, VariableFieldClass):
            return st.one_of(
                st.builds(cls, st.just(alternative.index), fixed(alternative.value))
                for alternative in part.alternatives
            )
        return self.container(part, cls)

    def nested(self, path: str) -> Any:
        return getattr(self.cls, path.rpartition(".")[2])


def fixed(value: Fixed) -> st.SearchStrategy[Any]:
    """Returns legal values of one wire item."""
    if value.python_type == "str":
        return st.text(LATIN1, max_size=int(value.limits[0]))
    if value.check in ("one_of", "whole_of"):
        pairs = re.findall(r"\((-?\d+), (-?\d+)\)", value.limits[0])
        return st.one_of(st.integers(int(low), int(high)) for low, high in pairs)
    if value.scale is not None:
        return st.sampled_from(value.scale) | st.floats(*value.scale)
    lower, upper = value.limits
    if value.check == "real":
        return real(float(lower), float(upper), single=value.format == "f")
    numbers = st.integers(int(lower), int(upper))
    if value.check != "whole":
        return numbers
    # The largest integer of 64 bits is no double; the next one is out of range.
    return numbers.map(float).filter(lambda number: int(lower) <= number <= int(upper))


def real(lower: float, upper: float, *, single: bool) -> st.SearchStrategy[float]:
    """Returns numbers of a range that have no more digits than the wire carries."""
    numbers = st.floats(lower, upper) | st.floats(max(lower, -1.0), min(upper, 1.0))
    if not single:
        return numbers
    return numbers.map(to_single).filter(lambda number: lower <= number <= upper)


def to_single(number: float) -> float:
    """Returns the nearest number of single precision."""
    nearest: float = struct.unpack("<f", struct.pack("<f", number))[0]
    return nearest
