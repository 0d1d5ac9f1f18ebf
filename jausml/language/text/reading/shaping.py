"""Shaper of the syntax tree: a method for each rule of the grammar."""

# ruff: noqa: D102 - the methods are named for the rules, which are described in the grammar

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Any, TypeVar

from lark import Token

from jausml.language.text import tree

T = TypeVar("T")

_ESCAPE = re.compile(r"\\(u[0-9a-fA-F]{4}|.)", re.DOTALL)
_QUOTED = re.compile(r"`((?:[^`\\\n]|\\.)*)`")
_INDEX = re.compile(r"\[(\d+)\]$")
_PLAIN = {"n": "\n", "t": "\t", "r": "\r"}


class Items(list[T]):
    """A list of items that knows where it is written.

    Attributes:
        start: Line and column of the bracket before the items; None when no bracket was seen.
    """

    start: tuple[int, int] | None = None
    end: tuple[int, int] = (1, 1)


def unescape(text: str) -> str:
    r"""Returns a text with its escapes resolved: `\"`, `\\`, `\n`, `\t`, `\r`, `\uXXXX`."""
    plain = _ESCAPE.sub(_resolved, text)
    if any("\ud800" <= character <= "\udfff" for character in plain):
        # Two escapes make one character beyond the first 65,536, as in JSON.
        # utf-16 joins the halves, and what is half of nothing becomes a replacement character.
        plain = plain.encode("utf-16", "surrogatepass").decode("utf-16", "replace")
    return plain


def _resolved(match: re.Match[str]) -> str:
    escape = match.group(1)
    if len(escape) > 1:
        return chr(int(escape[1:], 16))
    return _PLAIN.get(escape, escape)


def word_text(word: str) -> str:
    """Returns a word without its back quotes."""
    return _QUOTED.sub(lambda match: unescape(match.group(1)), word) if "`" in word else str(word)


def span_of(token: Token) -> tree.Span:
    """Returns where a token stands."""
    return tree.Span(token.line or 1, token.column or 1, token.end_line or 1, token.end_column or 1)


def _around(children: Sequence[Any]) -> tree.Span:
    """Returns the stretch from the first to the last of what a rule consists of."""
    first, last = _placed(children), _placed(reversed(children))
    return tree.Span(first.line or 1, first.column or 1, last.end_line or 1, last.end_column or 1)


def _placed(children: Iterable[Any]) -> Token | tree.Span:
    """Returns the first of some parts that has a place: empty lists, for one, have none."""
    for child in children:
        if isinstance(child, Token):
            return child
        if not isinstance(child, list) or (child and not isinstance(child, Items)):
            span: tree.Span = _around(child) if isinstance(child, list) else child.span
            return span
    raise ValueError("nothing has a place")


def _name(token: Token) -> tree.Name:
    return tree.Name(word_text(token), span_of(token))


def _bracketed(opening: Token, items: Items[T], closing: Token) -> Items[T]:
    items.start = (opening.line or 1, opening.column or 1)
    items.end = (closing.line or 1, closing.column or 1)
    return items


class _Block:
    """`{ ... }`: the items and the stretch."""

    def __init__(self, children: list[Any]) -> None:
        self.items = _bracketed(*children)
        self.span = _around(children)


def _items_of(block: _Block | None) -> Items[Any]:
    return block.items if block is not None else Items()


class Shaper:
    """The actions of the grammar: each takes the parts of its rule, with tokens."""

    def start(self, children: list[Any]) -> tree.SyntaxTree:
        return tree.SyntaxTree(children[0])

    def no_items(self, children: list[Any]) -> Items[Any]:  # noqa: ARG002 - one shape for all
        return Items()

    def next_item(self, children: list[Any]) -> Items[Any]:
        items: Items[Any]
        items, item = children
        item.spaced = bool(items) and item.span.line > items[-1].span.end_line + 1
        # The list grows in place: a new one for each item would be quadratic.
        items.append(item)
        return items

    def same_items(self, children: list[Any]) -> Items[Any]:
        items: Items[Any] = children[0]
        return items

    def file_import(self, children: list[Any]) -> tree.Import:
        target = children[1]
        is_text = target.type == "TEXT"
        return tree.Import(
            self.text([target]) if is_text else _name(target), span=_around(children)
        )

    # Elements and their features

    def keyword_element(self, children: list[Any]) -> tree.Element:
        keyword, name, *block = children
        items = _items_of(block[0] if block else None)
        return tree.Element(_name(keyword), _name(name), items, span=_around(children))

    def word_element(self, children: list[Any]) -> tree.Element:
        name, block = children
        return tree.Element(None, _name(name), block.items, span=_around(children))

    def block(self, children: list[Any]) -> _Block:
        return _Block(children)

    feature_block = assignment_block = block

    def feature(self, children: list[Any]) -> tree.Feature:
        name, _, values = children
        return tree.Feature(name, values, span=_around(children))

    def feature_name(self, children: list[Any]) -> tree.Name:
        return _name(children[0])

    def listed(self, children: list[Any]) -> list[Any]:
        if len(children) == 1:
            return children
        children[0].append(children[2])
        items: list[Any] = children[0]
        return items

    values = paths = arguments = listed

    def name(self, children: list[Any]) -> tree.Name:
        return _name(children[0])

    path = name

    def number(self, children: list[Any]) -> tree.Number:
        return tree.Number(str(children[0]), span_of(children[0]))

    def text(self, children: list[Any]) -> tree.Text:
        return tree.Text(unescape(children[0][1:-1]), span_of(children[0]))

    def href(self, children: list[Any]) -> tree.Href:
        return tree.Href(unescape(children[0][2:-1]), span_of(children[0]))

    def block_value(self, children: list[Any]) -> tree.Element:
        return tree.Element(None, None, children[0].items, span=_around(children))

    def new_value(self, children: list[Any]) -> tree.Element:
        return tree.Element(_name(children[1]), None, children[2].items, span=_around(children))

    def new_named_value(self, children: list[Any]) -> tree.Element:
        _, keyword, name, block = children
        return tree.Element(_name(keyword), _name(name), block.items, span=_around(children))

    # Members of messages

    def member(self, children: list[Any]) -> tree.Member:
        type_, name, *block = children
        if isinstance(type_, tree.Name):
            return self._member(children, type_, "", name, block)
        index = _INDEX.search(type_)
        word = type_ if index is None else type_.update(value=type_[: index.start()])
        return self._member(children, _name(word), index.group(1) if index else "", name, block)

    def sized_member(self, children: list[Any]) -> tree.Member:
        type_, size, name, *block = children
        shown = type_ if isinstance(type_, tree.Name) else _name(type_)
        return self._member(children, shown, size.text, name, block)

    def unnamed_struct(self, children: list[Any]) -> tree.Member:
        return self._member(children, _bracketed(*children[1:4]), "", None, children[4:])

    def named_struct(self, children: list[Any]) -> tree.Member:
        rest = children[4:]
        size = rest.pop(0).text if isinstance(rest[0], tree.Name) else ""
        return self._member(children, _bracketed(*children[1:4]), size, rest[0], rest[1:])

    def _member(
        self,
        children: list[Any],
        type_: tree.Name | Items[tree.Member],
        size: str,
        name: Token | None,
        block: list[_Block],
    ) -> tree.Member:
        named = _name(name) if name is not None else None
        features = _items_of(block[0] if block else None)
        return tree.Member(type_, size, named, features, span=_around(children))

    def bounded(self, children: list[Any]) -> tree.Name:
        word, _, bound = children
        return tree.Name(f"{word_text(word)}<={bound}", _around(children))

    def size(self, children: list[Any]) -> tree.Name:
        inner = "".join(word_text(child) for child in children[1:-1])
        return tree.Name(inner or tree.UNBOUNDED, _around(children))

    # Maps

    def plain_end(self, children: list[Any]) -> tree.End:
        side, type_, *block = children
        features = _items_of(block[0] if block else None)
        return tree.End(side.type == "JAUS", _name(type_), None, features, span=_around(children))

    def listed_end(self, children: list[Any]) -> tree.End:
        side, type_, opening, members, closing, *block = children
        features = _items_of(block[0] if block else None)
        listed = _bracketed(opening, members, closing)
        return tree.End(side.type == "JAUS", _name(type_), listed, features, span=_around(children))

    def way(self, children: list[Any]) -> list[Any]:
        return children

    def direction(self, children: list[Any]) -> tree.Direction:
        way, *rest = children
        return tree.Direction(way[0].type == "JAUS", _bracketed(*rest), span=_around(children))

    def assignment(self, children: list[Any]) -> tree.Assignment:
        sources, _, targets, *rest = children
        block = rest.pop() if rest and isinstance(rest[-1], _Block) else None
        conversions = rest[0] if rest else []
        span = _around(children)
        return tree.Assignment(sources, targets, conversions, _items_of(block), span=span)

    def sources(self, children: list[Any]) -> list[Any]:
        paths: list[Any] = children[0]
        return paths

    def constant_source(self, children: list[Any]) -> list[tree.Number | tree.Text]:
        return [self.text(children) if children[0].type == "TEXT" else self.number(children)]

    def clock_source(self, children: list[Any]) -> list[tree.Clock]:
        return [tree.Clock(span_of(children[0]))]

    def conversions(self, children: list[Any]) -> list[tree.Call]:
        return children[1:] if len(children) == 2 else self.listed(children)

    def call(self, children: list[Any]) -> tree.Call:
        arguments = next((child for child in children if isinstance(child, list)), [])
        return tree.Call(_name(children[0]), tuple(arguments), _around(children))

    def ignored(self, children: list[Any]) -> tree.Ignored:
        return tree.Ignored(children[1], span=_around(children))

    def table(self, children: list[Any]) -> tree.Table:
        return tree.Table(_name(children[1]), _bracketed(*children[2:]), span=_around(children))

    def entry(self, children: list[Any]) -> tree.Entry:
        return tree.Entry(children[0], children[2], span=_around(children))

    def vector(self, children: list[Any]) -> tree.Vector:
        _, name, way, opening, inputs, gives, expected, closing = children
        return tree.Vector(
            _name(name),
            way[0].type == "JAUS",
            _bracketed(opening, inputs, gives),
            _bracketed(gives, expected, closing),
            span=_around(children),
        )

    def vector_entry(self, children: list[Any]) -> tree.VectorEntry:
        path, _, value, *rest = children
        tolerance = self.number([rest[1]]) if rest else None
        return tree.VectorEntry(path, value, tolerance, span=_around(children))
