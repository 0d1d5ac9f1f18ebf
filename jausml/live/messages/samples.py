"""Values to begin with: the least that a message takes, and an example of all its fields."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.live.messages.blobs import FormattedOctets, Octets, Text, VariableNumber
from jausml.live.messages.containers import Array, List, Record, Variant
from jausml.live.messages.scalars import BitField, FixedText, Integer, Real, Scaled

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.live.messages.codec import Codec
    from jausml.live.messages.entries import MessageEntry


def sample(codec: Codec) -> Any:
    """Returns a legal value in the shape that `MessageEntry.encode` takes.

    Numbers are the smallest legal ones (0 if legal), optional members are left out, lists are as
    short as they may be.

    Args:
        codec: The codec of the field.
    """
    return _Sampler(is_full=False).value(codec)


def example(entry: MessageEntry) -> dict[str, Any]:
    """Returns legal fields of a message that show what it may hold.

    As `sample`, but with optional members, an element in each list, and values by their names.

    Args:
        entry: The message.
    """
    fields: dict[str, Any] = _Sampler(is_full=True).value(entry.codec)
    return fields


@dataclass(frozen=True)
class _Sampler:
    """Makes values of one manner."""

    is_full: bool

    def value(self, codec: Codec) -> Any:
        if isinstance(codec, Record):
            return self._record(codec)
        if isinstance(codec, List):
            least = max(codec.counted.lower, min(1, codec.counted.upper) if self.is_full else 0)
            return [self.value(codec.element) for _ in range(least)]
        if isinstance(codec, Array):
            return [self.value(codec.element) for _ in range(codec.count)]
        if isinstance(codec, Variant):
            if not codec.options:
                return {"_tag": 0}
            name, option = codec.options[0]
            return {"_tag": 0, name: self.value(option)}
        return self._leaf(codec)

    def _record(self, codec: Record) -> dict[str, Any]:
        # A definition may have more optional members than its vector has bits.
        bits = 8 * codec.presence.minimum_size if codec.presence is not None else 0
        shown = (each for each in codec.members if not each.bit or self._shows(each.bit, bits))
        return {each.name: self.value(each.codec) for each in shown}

    def _shows(self, bit: int, bits: int) -> bool:
        return self.is_full and not bit >> bits

    def _leaf(self, codec: Codec) -> Any:
        if isinstance(codec, Integer):
            return self._integer(codec.ranges, codec.names)
        if isinstance(codec, Scaled | Real):
            return min(max(0.0, codec.lower), codec.upper)
        if isinstance(codec, BitField):
            return {each.name: self._integer(each.ranges, each.names) for each in codec.groups}
        if isinstance(codec, Octets):
            return {"hex": bytes(codec.counted.lower).hex()}
        if isinstance(codec, FormattedOctets):
            return {"format": min(codec.formats), "hex": bytes(codec.counted.lower).hex()}
        if isinstance(codec, VariableNumber):
            index = min(codec.alternatives)
            return {"index": index, "value": self.value(codec.alternatives[index])}
        if isinstance(codec, Text):
            return " " * codec.counted.lower
        if isinstance(codec, FixedText):
            return ""
        raise TypeError(f"no sample of a {type(codec).__name__}")

    def _integer(self, ranges: tuple[tuple[int, int], ...], names: Mapping[int, str]) -> int | str:
        known = list(names.values())
        telling = (
            names[value]
            for value in sorted(names)
            if known.count(names[value]) == 1 and not names[value].lower().startswith("reserved")
        )
        legal_zero = any(low <= 0 <= high for low, high in ranges)
        number = 0 if legal_zero else ranges[0][0]
        return next(telling, number) if self.is_full else number
