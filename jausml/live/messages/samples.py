"""Values to begin with: the least that a message takes, and an example of all its fields."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.language import wire
from jausml.live.messages.codec import TAG

if TYPE_CHECKING:
    from jausml.live.messages.entries import MessageEntry


def sample(kind: wire.Kind) -> Any:
    """Returns a legal value in the shape that `MessageEntry.encode` takes.

    Numbers are the smallest legal ones (0 if legal), optional members are left out, lists are as
    short as they may be.
    """
    return _Sampler(is_full=False).value(kind)


def example(entry: MessageEntry) -> dict[str, Any]:
    """Returns legal fields of a message that show what it may hold.

    As `sample`, but with optional members, an element in each list, and values by their names.
    """
    fields: dict[str, Any] = _Sampler(is_full=True).value(entry.record)
    return fields


@dataclass(frozen=True)
class _Sampler:
    """Makes values of one manner."""

    is_full: bool

    def value(self, kind: wire.Kind) -> Any:
        match kind:
            case wire.Record():
                return self._record(kind)
            case wire.List():
                least = max(kind.count.lower, min(1, kind.count.upper) if self.is_full else 0)
                return [self.value(kind.element.kind) for _ in range(least)]
            case wire.Array():
                return [self.value(kind.element.kind) for _ in range(kind.length)]
            case wire.Variant():
                first = kind.options[:1]
                return {TAG: 0, **{option.name: self.value(option.kind) for option in first}}
            case _:
                return self._leaf(kind)

    def _record(self, kind: wire.Record) -> dict[str, Any]:
        # A definition may have more optional members than its vector has bits.
        most = kind.presence.upper if kind.presence is not None and self.is_full else 0
        return {each.name: self.value(each.kind) for each in kind.members if each.bit <= most}

    def _leaf(self, kind: wire.Leaf) -> Any:
        match kind:
            case wire.Integer():
                return self._integer(kind.legal)
            case wire.Scaled():
                return min(max(0.0, kind.lower), kind.upper)
            case wire.Real():
                return min(max(0.0, kind.legal.lower), kind.legal.upper)
            case wire.BitField():
                return {each.name: self._integer(each.legal) for each in kind.groups}
            case wire.Octets():
                return {"hex": bytes(kind.count.lower).hex()}
            case wire.FormattedOctets():
                return {"format": min(kind.names), "hex": bytes(kind.count.lower).hex()}
            case wire.VariableNumber():
                index, number = min(kind.by_index.items(), key=lambda each: each[0])
                return {"index": index, "value": self.value(number)}
            case wire.Text():
                return " " * kind.count.lower
            case wire.FixedText():
                return ""

    def _integer(self, legal: wire.LegalIntegers) -> int | str:
        names = legal.names
        known = list(names.values())
        telling = (
            names[value]
            for value in sorted(names)
            if known.count(names[value]) == 1 and not names[value].lower().startswith("reserved")
        )
        legal_zero = any(low <= 0 <= high for low, high in legal.ranges)
        number = 0 if legal_zero else legal.ranges[0][0]
        return next(telling, number) if self.is_full else number
