"""Rendered modules as they are to stand in their files: parsed once, with imports, laid out.

A module is worked on in pieces: its functions, its methods, and what stands before them. The
modules of a large system consist of pieces that differ in one word alone, the name of a connection,
and in strings. Those are worked on once, under letters that stand in for them.
"""

from __future__ import annotations

import ast
import re
import string
import warnings
from dataclasses import dataclass
from io import StringIO
from typing import TYPE_CHECKING

from jausml.generation.checks import CANNOT_PARSE
from jausml.generation.languages.python.imports import MARKER, Names, import_lines, names_in
from jausml.generation.languages.python.layout import lay_out_statement, layout

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from jausml.generation.languages.python.imports import Imports

_START = re.compile(r"\n\n(?=(?: {4})?(?:@|def |class |async ))")
_HEAD = re.compile(r"(?:def |class |\.)(\w+)")
_PREFIX = re.compile("[bfrtu]{1,2}")
"""Words that may stand before a string, and change what it is."""
_STAND_IN = "\u01c2"
"""A letter that no rendered word has; as many of them as the word has letters stand in for it."""
_STOOD_IN = re.compile(f"{_STAND_IN}+")
_LONGER = frozenset(string.ascii_letters + string.digits)
"""Beside these they do not: in a longer word, whose parts underscores join."""
_STRING = re.compile(r'(?<=")[A-Za-z0-9_]+(?=")')
_HIDDEN = "\u01c0"
"""A letter that stands in for each of a string, of which nothing but its length counts."""
_HIDDEN_STRING = re.compile(f"{_HIDDEN}+")


@dataclass(frozen=True)
class _Piece:
    """A piece of a module."""

    text: str
    names: Names

    def under(self, word: str, strings: str) -> _Piece:
        """Returns the piece with a word and the strings for what stands in for them."""
        stand_in = _STAND_IN * len(word)
        letters = StringIO(strings)
        text = _HIDDEN_STRING.sub(lambda found: letters.read(len(found[0])), self.text)
        names = self.names
        groups = (names.running, names.annotating, names.defined)
        found = ({each.replace(stand_in, word) for each in group} for group in groups)
        return _Piece(text.replace(stand_in, word), Names(*found))


class Modules:
    """The modules of one run, which share what was worked on."""

    def __init__(self) -> None:
        self._pieces: dict[str, _Piece] = {}
        self._statements: dict[str, list[str]] = {}

    def finished(
        self, text: str, imports: Imports | None = None, words: Collection[str] = ()
    ) -> str:
        """Returns a module as it is to stand in its file.

        Args:
            text: The module, each statement on a line; with imports, without import statements,
                which follow its line MARKER.
            imports: What it may import, None where it has its import statements.
            words: Names in which functions and methods of it may differ alone, e.g. those of
                connections. It is the same without them, and takes longer.

        Raises:
            SyntaxError: Python cannot read it (or another one of CANNOT_PARSE).
            UnknownNameError: Nothing defines a name that it uses.
        """
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            try:
                pieces = [self._piece(each, words) for each in _START.split(text)]
            except CANNOT_PARSE:
                # What looks like a function may stand in a string.
                pieces = [self._worked_on(text)]
            laid_out = "\n\n".join(each.text for each in pieces)
            if imports is None:
                return laid_out
            lines = import_lines(_joined(pieces), imports)
            return laid_out.replace(MARKER, f"{MARKER}\n{layout(lines)}" if lines else MARKER, 1)

    def _piece(self, text: str, words: Collection[str]) -> _Piece:
        word, alike = _without_word(text, words if _HIDDEN not in text else ())
        if not word:
            return self._worked_on(text, words)
        strings = "".join(_STRING.findall(alike))
        alike = _STRING.sub(lambda found: _HIDDEN * len(found[0]), alike)
        if alike not in self._pieces:
            try:
                self._pieces[alike] = self._worked_on(alike, words)
            except CANNOT_PARSE:
                return self._worked_on(text)
        return self._pieces[alike].under(word, strings)

    def _worked_on(self, text: str, words: Collection[str] = ()) -> _Piece:
        is_member = text.startswith(" ")
        whole = f"class _:\n{text}" if is_member else text
        module = ast.parse(whole)
        laid_out = layout(whole, module, lambda lines: self._statement(lines, words))
        if laid_out != whole:
            ast.parse(laid_out)
        return _Piece(laid_out.partition("\n")[2] if is_member else laid_out, names_in(module))

    def _statement(self, lines: Sequence[str], words: Collection[str]) -> list[str]:
        """Lays out a statement, once however often it stands in the modules."""
        word, alike = _without_word("\n".join(lines), words)
        if alike not in self._statements:
            self._statements[alike] = lay_out_statement(alike.split("\n"))
        laid_out = self._statements[alike]
        return (
            [line.replace(_STAND_IN * len(word), word) for line in laid_out] if word else laid_out
        )


def _joined(pieces: Sequence[_Piece]) -> Names:
    return Names(
        {name for each in pieces for name in each.names.running},
        {name for each in pieces for name in each.names.annotating},
        {name for each in pieces for name in each.names.defined},
    )


def _without_word(text: str, words: Collection[str]) -> tuple[str, str]:
    """Returns a word that a text is about, and the text without it; no word when there is none."""
    word = _word_in(text, words) if words and _STAND_IN not in text else ""
    if not word or _PREFIX.fullmatch(word):
        return "", text
    stand_in = _STAND_IN * len(word)
    alike = text.replace(word, stand_in)

    def kept(found: re.Match[str]) -> str:
        start, end = found.span()
        beside = alike[max(start - 1, 0) : start] + alike[end : end + 1]
        return found[0] if _LONGER.isdisjoint(beside) else found[0].replace(stand_in, word)

    return word, _STOOD_IN.sub(kept, alike)


def _word_in(text: str, words: Collection[str]) -> str:
    """Returns the first of some words in the name of a function, method or attribute."""
    seen = set()
    for found in _HEAD.finditer(text):
        name = found[1]
        if name in seen:
            continue
        seen.add(name)
        parts = name.split("_")
        for start in range(len(parts)):
            for end in range(len(parts), start, -1):
                word = "_".join(parts[start:end])
                if word in words:
                    return word
    return ""
