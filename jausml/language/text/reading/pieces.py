"""Texts by pieces: of a text that was parsed before in another state, only what changed is parsed.

A piece ends with the line on which a bracket ends an element, of the text or of a block. The block
of a long piece consists of pieces itself: it is parsed without them, and they are put into it. What
has only moved to other lines is copied.
"""

from __future__ import annotations

import re
from collections import OrderedDict
from dataclasses import dataclass, field, fields, is_dataclass
from functools import cache, lru_cache
from threading import Lock
from typing import TYPE_CHECKING, Any

from lark import Token

from jausml.language.text.reading.parsing import Parsed, parse, parse_part
from jausml.language.text.reading.scanning import with_line_feeds
from jausml.language.text.reading.shaping import Items
from jausml.language.text.tree import DEEPEST, LONGEST, Element, Span, SyntaxTree

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

_LONG = 1_000
"""Characters from which on a piece is parsed by the pieces of its block."""

_FEW = 8
"""Texts whose trees are kept."""

_MOST_KEPT = 4 * LONGEST
"""Characters of the pieces that are kept."""

_CUT = re.compile(
    r"""
    (?: [^"`/{}()\[\]]+ | /(?![/*]) )*  # by leaps, or every character is asked for all of these
    (?: "(?:\\[^\n]|[^"\\\n])*"? | `(?:\\[^\n]|[^`\\\n])*`? | //[^\n]* | /\*.*?(?:\*/|\Z)
    | (?P<opening> [{(\[] ) (?P<begin> [ \t\r]* \n )?
    | (?P<closing> [})\]] ) (?P<end> [ \t\r]* (?://[^\n]*)? \n )?
    | \Z )
    """,
    re.VERBOSE | re.DOTALL,
)
_NOTHING = re.compile(r"(?: \s | //[^\n]* | /\*.*?(?:\*/|\Z) )*", re.VERBOSE | re.DOTALL)


@dataclass(slots=True)
class _Block:
    """What stands between brackets, or the whole text, as far as it is known.

    Attributes:
        start: Where its first piece begins; none where it has none.
        end: Where the line of its closing bracket begins.
        at: Where the piece begins that is not complete.
    """

    start: int | None
    at: int
    end: int = 0
    pieces: list[_Piece] = field(default_factory=list)


@dataclass(slots=True)
class _Piece:
    """A stretch of a text, and the block that it ends with."""

    start: int
    end: int
    block: _Block | None = None


class Pieces:
    """The pieces of the texts that were parsed last."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._known: OrderedDict[tuple[bool, bool, str], tuple[int, Parsed]] = OrderedDict()
        self._characters = 0

    def parsed(self, text: str) -> Parsed:
        """Returns what `parse` gives, but where something is wrong, other pieces do not suffer.

        May be called from any thread. Nobody may change what is returned.
        """
        text = with_line_feeds(text.removeprefix("\ufeff"))
        whole = _cut(text) if len(text) <= LONGEST else None
        if whole is None:
            return parse(text)
        with self._lock:
            found = self._all(text, whole.pieces, 1, in_block=False)
            while self._characters > _MOST_KEPT:
                (_, _, part), _ = self._known.popitem(last=False)
                self._characters -= len(part)
        return found

    def _all(self, text: str, pieces: Sequence[_Piece], line: int, *, in_block: bool) -> Parsed:
        """Reads pieces one behind the other."""
        tokens = _Tokens()
        joined = Parsed(SyntaxTree(), tokens=tokens)
        for position, piece in enumerate(pieces):
            found = self._read(text, piece, line, is_first=position == 0, in_block=in_block)
            joined.document.items += found.document.items
            joined.document.closing += found.document.closing
            joined.faults += found.faults
            tokens.parts.append((found.tokens, 0))
            line += text.count("\n", piece.start, piece.end)
        return joined

    def _read(
        self, text: str, piece: _Piece, line: int, *, is_first: bool, in_block: bool
    ) -> Parsed:
        part = text[piece.start : piece.end]
        key = (is_first, in_block, part)
        if key in self._known:
            before, found = self._known[key]
            found = _shifted(found, line - before)
        else:
            composed = self._composed(text, piece, line, is_first=is_first, in_block=in_block)
            found = composed or parse_part(part, line, is_first=is_first, in_block=in_block)
            self._characters += len(part)
        self._known[key] = (line, found)
        self._known.move_to_end(key)
        return found

    def _composed(
        self, text: str, piece: _Piece, line: int, *, is_first: bool, in_block: bool
    ) -> Parsed | None:
        """Reads a piece by the pieces of its block; None where that is not how it is made."""
        block = piece.block
        if block is None or block.start is None or len(block.pieces) < 2:
            return None
        if piece.end - piece.start < _LONG:
            return None
        lines = text.count("\n", block.start, block.end)
        around = text[piece.start : block.start] + "\n" * lines + text[block.end : piece.end]
        found = parse_part(around, line, is_first=is_first, in_block=in_block)
        last = found.document.items[-1] if found.document.items else None
        if found.faults or not isinstance(last, Element) or not isinstance(last.items, Items):
            return None
        tokens = list(found.tokens)
        if last.items or last.items.start is None or tokens[-1].type != "RBRACE":
            return None
        first = line + text.count("\n", piece.start, block.start)
        inner = self._all(text, block.pieces, first, in_block=True)
        last.items += inner.document.items
        last.closing += inner.document.closing
        at = next(n for n, each in enumerate(tokens) if (each.line or 1) >= first)
        found.tokens = _Tokens([(tokens[:at], 0), (inner.tokens, 0), (tokens[at:], 0)])
        found.faults += inner.faults
        return found


@lru_cache(maxsize=1)
def _pieces() -> Pieces:
    return Pieces()


@lru_cache(maxsize=_FEW)
def roughly_parsed(text: str) -> Parsed:
    """Returns the tree of a text as soon as a key was pressed: parsed is the piece that changed.

    It is that of `parsed_text` unless there are syntax errors, which are not those to be shown.
    """
    return _pieces().parsed(text)


@lru_cache(maxsize=_FEW)
def parsed_text(text: str) -> Parsed:
    """Returns the tree of a text with its syntax errors; that of a text just seen is kept."""
    found = roughly_parsed(text)
    return parse(text) if found.faults else found


def _cut(text: str) -> _Block | None:
    """Cuts a text; None where brackets are nested too deep."""
    blocks = [_Block(0, 0)]
    for match in _CUT.finditer(text):
        if match["opening"]:
            begins = match["opening"] == "{" and match["begin"]
            blocks.append(_Block(match.end() if begins else None, match.end()))
            if len(blocks) > DEEPEST:
                return None
        elif match["closing"] and len(blocks) > 1:
            closed, around = blocks.pop(), blocks[-1]
            if match["end"] and match["closing"] == "}" and around.start is not None:
                _end(closed, text, match.start("closing"))
                around.pieces.append(_Piece(around.at, match.end(), closed))
                around.at = match.end()
    whole = blocks[0]
    _complete(whole, text, len(text))
    return whole


def _end(block: _Block, text: str, bracket: int) -> None:
    """Ends a block with the line of its bracket, which has to begin with it."""
    if block.start is None:
        return
    block.end = text.rfind("\n", 0, bracket) + 1
    if block.end < block.at or text[block.end : bracket].strip(" \t"):
        block.start = None
    else:
        _complete(block, text, block.end)


def _complete(block: _Block, text: str, end: int) -> None:
    """Makes a piece of what is left of a block; comments belong to what is before them."""
    rest = _NOTHING.match(text, block.at, end)
    if block.pieces and rest is not None and rest.end() == end:
        block.pieces[-1].end = end
        return
    block.pieces.append(_Piece(block.at, end))


class _Tokens:
    """The tokens of parts of a text, each of which has moved by some lines."""

    def __init__(self, parts: Sequence[tuple[Iterable[Token], int]] = ()) -> None:
        self.parts = list(parts)

    def __iter__(self) -> Iterator[Token]:
        for tokens, by in self.parts:
            yield from (_moved(each, by) for each in tokens) if by else tokens

    def moved(self, by: int) -> _Tokens:
        return _Tokens([(tokens, before + by) for tokens, before in self.parts])


class _Moved(Items[Any]):
    """Items on other lines; they are copied when somebody looks at them.

    Attributes:
        waiting: Which are to be copied, and by how many lines; None when they were.
    """

    def __init__(self, items: Items[Any], by: int) -> None:
        super().__init__()
        before = items.waiting if isinstance(items, _Moved) else None
        source, moved = before or (items, 0)
        self.waiting: tuple[Items[Any], int] | None = (source, moved + by)
        if items.start is not None:
            self.start = (items.start[0] + by, items.start[1])
            self.end = (items.end[0] + by, items.end[1])

    def _here(self) -> list[Any]:
        waiting = self.waiting
        if waiting is not None:
            items, by = waiting
            # At once: another thread may look meanwhile.
            self[:] = [_moved(each, by) for each in items]
            self.waiting = None
        return self

    def __iter__(self) -> Iterator[Any]:
        self._here()
        return super().__iter__()

    def __len__(self) -> int:
        return super().__len__() if self.waiting is None else len(self.waiting[0])

    def __getitem__(self, at: Any) -> Any:
        self._here()
        return super().__getitem__(at)

    def __reversed__(self) -> Iterator[Any]:
        self._here()
        return super().__reversed__()

    def __contains__(self, item: object) -> bool:
        self._here()
        return super().__contains__(item)

    def __eq__(self, other: object) -> bool:
        self._here()
        return super().__eq__(other)

    def __repr__(self) -> str:
        self._here()
        return super().__repr__()

    def index(self, *about: Any) -> int:
        self._here()
        return super().index(*about)

    __hash__ = None  # type: ignore[assignment]


def _shifted(found: Parsed, by: int) -> Parsed:
    """Returns what stands on other lines now."""
    if not by:
        return found
    faults = [each._replace(span=_moved(each.span, by)) for each in found.faults]
    document = found.document
    tree = SyntaxTree([_moved(each, by) for each in document.items], document.closing)
    return Parsed(tree, faults, _Tokens([(found.tokens, 0)]).moved(by))


def _moved(value: Any, by: int) -> Any:
    if isinstance(value, Span):
        return Span(value.line + by, value.column, value.end_line + by, value.end_column)
    if isinstance(value, Token):
        places = (value.column, (value.end_line or 1) + by, value.end_column, value.end_pos)
        return Token(value.type, str(value), value.start_pos, (value.line or 1) + by, *places)
    if isinstance(value, Items):
        return _Moved(value, by)
    if isinstance(value, list | tuple):
        return type(value)(_moved(each, by) for each in value)
    if is_dataclass(value) and not isinstance(value, type):
        new = object.__new__(type(value))
        for name in _names(type(value)):
            object.__setattr__(new, name, _moved(getattr(value, name), by))
        return new
    return value


@cache
def _names(kind: type[Any]) -> tuple[str, ...]:
    return tuple(each.name for each in fields(kind))
