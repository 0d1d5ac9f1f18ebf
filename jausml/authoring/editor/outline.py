"""Outline of a text: what it declares."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from jausml.authoring.editor.workbench import names_in
from jausml.language.text.keywords import snake_case

if TYPE_CHECKING:
    from jausml.language.text.tree import Item, Span


@dataclass(slots=True)
class Symbol:
    """Something that a text declares."""

    name: str
    kind: str
    span: Span
    name_span: Span
    children: list[Symbol] = field(default_factory=list)


def outline(text: str) -> list[Symbol]:
    """Returns what a text declares, as a forest."""
    roots: list[Symbol] = []
    by_item: dict[int, Symbol] = {}
    for each in names_in(text).declarations:
        kind = snake_case(each.table.name)
        symbol = Symbol(each.name.text, kind, each.item.span, each.name.span)
        by_item[id(each.item)] = symbol
        owner = _nearest(each.owners, by_item)
        (owner.children if owner is not None else roots).append(symbol)
    return roots


def _nearest(owners: tuple[Item, ...], by_item: dict[int, Symbol]) -> Symbol | None:
    found = (by_item[id(each)] for each in reversed(owners) if id(each) in by_item)
    return next(found, None)
