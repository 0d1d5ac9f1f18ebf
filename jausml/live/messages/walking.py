"""Walks through decoded fields beside the kinds that say how they are laid out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from jausml.language import wire
from jausml.live.messages.codec import TAG


def holds(kind: wire.Octets | wire.FormattedOctets, value: Mapping[str, Any]) -> bool:
    """Tells whether a decoded byte field holds a message."""
    if isinstance(kind, wire.Octets):
        return kind.holds_message
    return kind.holds_message(int(value["format"]))


def holders(kind: wire.Kind, value: Any) -> Iterator[dict[str, Any]]:
    """Yields the objects of a decoded field that hold a message."""
    if isinstance(kind, wire.Octets | wire.FormattedOctets):
        if holds(kind, value):
            yield value
        return
    for _, inner, part in parts(kind, value):
        yield from holders(inner, part)


def parts(kind: wire.Kind, value: Any) -> Iterator[tuple[str, wire.Kind, Any]]:
    """Yields the fields inside a decoded field: their names or `[index]`, kinds and values."""
    match kind:
        case wire.Record():
            for member in kind.members:
                if member.name in value:
                    yield member.name, member.kind, value[member.name]
        case wire.List() | wire.Array():
            for index, item in enumerate(value):
                yield f"[{index}]", kind.element.kind, item
        case wire.Variant() if kind.options:
            option = kind.options[value[TAG]]
            yield option.name, option.kind, value[option.name]
        case _:
            pass  # a leaf
