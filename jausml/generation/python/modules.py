"""Rendered modules as they stand in files: parsed once, with exactly the imports they use."""

from __future__ import annotations

import ast
import builtins
import re
import sys
import warnings
from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from io import StringIO
from string import ascii_letters, digits, printable
from typing import NamedTuple

from jausml.generation.artifact import CANNOT_PARSE
from jausml.generation.literals import LINE_WIDTH
from jausml.generation.python.layout import layout

MARKER = "from __future__ import annotations\n"
"""The line of a template that import statements follow."""
_NAMED = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.ExceptHandler)
_DEFINING = (*_NAMED, ast.arg, ast.Import, ast.ImportFrom)
_WITHOUT_NAMES = frozenset({"ctx", "op", "ops", "attr", "id", "kind", "lineno", "type_comment"})
_OF_MODULES = frozenset({"__name__", "__file__", "__doc__"})


class UnknownNameError(NameError):
    """A name that rendered Python uses and that nothing defines or offers."""


@dataclass(frozen=True)
class Origin:
    """Where a name comes from (`name`: its name there; empty for the module itself)."""

    module: str
    name: str = ""


def offered(module: str, *names: str) -> dict[str, Origin]:
    """Returns names as a module offers them."""
    return {name: Origin(module, name) for name in names}


STANDARD: Mapping[str, Origin] = {
    "math": Origin("math"),
    "os": Origin("os"),
    "pytest": Origin("pytest"),
    "signal": Origin("signal"),
    "socket": Origin("socket"),
    "struct": Origin("struct"),
    **offered("collections.abc", "Callable", "Iterator", "MutableSequence", "Sequence"),
    **offered("dataclasses", "dataclass", "field"),
    **offered("enum", "IntEnum"),
    **offered("pathlib", "Path"),
    **offered("typing", "Any", "ClassVar"),
}
"""The names of the standard library and pytest that any generated module may use."""


@dataclass(frozen=True)
class Imports:
    """The names that a module may import."""

    names: Mapping[str, Origin]
    own: str = ""

    def and_also(self, names: Mapping[str, Origin]) -> Imports:
        """Returns the same with further names, which come before others of that name."""
        return replace(self, names={**self.names, **names})


class Names(NamedTuple):
    """The names in some statements."""

    used: Collection[str]
    defined: Collection[str]

    @property
    def unknown(self) -> set[str]:
        """The used names that neither the statements nor Python define."""
        used = set(self.used).difference(self.defined)
        return {name for name in used if not hasattr(builtins, name) and name not in _OF_MODULES}


def names_in(module: ast.Module) -> Names:
    """Returns the names in the statements of a module."""
    used: set[str] = set()
    defined: set[str] = set()
    pending: list[ast.AST] = [module]
    while pending:
        node = pending.pop()
        if isinstance(node, ast.Name):
            # A name that is stored is defined; only one that is loaded must come from somewhere.
            (used if isinstance(node.ctx, ast.Load) else defined).add(node.id)
            continue
        if isinstance(node, _DEFINING):
            defined.update(_defined(node))
        for field in node._fields:
            if field in _WITHOUT_NAMES:
                continue
            value = getattr(node, field, None)
            if isinstance(value, list):
                pending += [child for child in value if isinstance(child, ast.AST)]
            elif isinstance(value, ast.AST):
                pending.append(value)
    return Names(used, defined)


def import_lines(names: Names, imports: Imports) -> str:
    """Returns the import statements for what a module uses, in ruff's order."""
    origins = {**STANDARD, **imports.names}
    unknown = sorted(names.unknown - origins.keys())
    if unknown:
        raise UnknownNameError(f"nothing defines the name {unknown[0]!r}")
    imported = (origins.keys() - names.defined).intersection(names.used)
    sections: dict[int, dict[str, Origin]] = defaultdict(dict)
    for name in imported:
        top = origins[name].module.partition(".")[0]
        number = 2 if top in {"", imports.own} else int(top not in sys.stdlib_module_names)
        sections[number][name] = origins[name]
    blocks = ("\n".join(statements(sections[number])) for number in sorted(sections))
    return "\n".join(f"{block}\n" for block in blocks)


def _defined(node: ast.AST) -> list[str]:
    if isinstance(node, ast.arg):
        return [node.arg]
    if isinstance(node, ast.Import | ast.ImportFrom):
        return [name.asname or name.name.partition(".")[0] for name in node.names]
    return [node.name] if isinstance(node, _NAMED) and node.name else []


def statements(origins: Mapping[str, Origin]) -> Iterator[str]:
    """Yields the import statements for names, in ruff's order and layout."""
    modules = [name for name, origin in origins.items() if not origin.name]
    yield from (f"import {origins[name].module}" for name in sorted(modules, key=_natural))
    members: dict[tuple[str, str], set[str]] = defaultdict(set)
    for name, origin in origins.items():
        if origin.name == name:
            members[origin.module, ""].add(name)
        elif origin.name:
            members[origin.module, name].add(f"{origin.name} as {name}")
    lines = [(module, sorted(group, key=_rank)) for (module, _), group in members.items()]
    for module, group in sorted(lines, key=lambda line: (_natural(line[0]), _rank(line[1][0]))):
        line = f"from {module} import {', '.join(group)}"
        if len(line) > LINE_WIDTH:
            inner = "".join(f"    {name},\n" for name in group)
            line = f"from {module} import (\n{inner})"
        yield line


def _rank(name: str) -> tuple[int, str, str]:
    """Constants come before classes, classes before functions; numbers count as numbers."""
    group = 0 if len(name) > 1 and name.isupper() else 1 if name[0].isupper() else 2
    return group, _natural(name), name


def _natural(text: str) -> str:
    return re.sub(r"\d+", lambda number: number.group().zfill(20), text.lower())


_START = re.compile(
    r"\n(?=\n(?: {4})?(?:@|def |class |async ))|\n(?= {8}self\.\w+ = \w+\($)", re.MULTILINE
)
"""Before a function, a class or a method, and before what a method makes of several arguments."""
_AROUND = {"    ": "class _:\n", "        ": "class _:\n    def _():\n"}
"""The lines around a piece of code that let it be parsed, by its indentation."""
_NO_NAME = str.maketrans(dict.fromkeys(set(printable) - {*ascii_letters, *digits, "_"}, " "))
_PREFIX = re.compile("[bfrtu]{1,2}")  # words that may stand before a string, and change what it is
_STAND_INS = "\u01c2\u01c3"
"""Letters that no rendered word has; as many of one as a word has letters stand in for it."""
_LONGER = {
    letter: re.compile(f"{letter}(?:(?<=[A-Za-z0-9]{letter}){letter}*|{letter}*(?=[A-Za-z0-9]))")
    for letter in _STAND_INS
}
"""Those in a longer word, whose parts underscores join: there they do not."""
_HIDDEN, _NO_CODE = "\u01c0", "0x0000"
_OWN = re.compile(r'("\w+"|0x(?<!\w0x)[0-9A-F]{4}\b)', re.ASCII)
"""Strings and codes, of which nothing but their length counts."""
_HIDDEN_OWN = re.compile(rf"({_HIDDEN}+|\b{_NO_CODE}\b)")


class _Piece(NamedTuple):
    """A piece of a module.

    Attributes:
        parts: What is its own, and after each of it a hidden string or code.
        names: Those that are used and those that are defined, in a line each.
    """

    parts: Sequence[str]
    names: str

    def under(self, words: Mapping[str, str], hidden: str) -> _Piece:
        """Returns the piece with words, strings and codes instead of their stand-ins."""
        parts, letters = list(self.parts), StringIO(hidden)
        # The layout may have joined strings.
        parts[1::2] = [letters.read(len(stand_in)) for stand_in in self.parts[1::2]]
        return _Piece([_with_words("".join(parts), words)], _with_words(self.names, words))


class Modules:
    """The modules of one run, which share pieces."""

    def __init__(self) -> None:
        self._pieces: dict[str, _Piece] = {}

    def finished(
        self, text: str, imports: Imports | None = None, words: Collection[str] = ()
    ) -> str:
        """Returns a module as its file has it.

        Args:
            text: The module, each statement on a line; with imports, without import statements,
                which follow its line MARKER.
            imports: What it may import, None where it has its import statements.
            words: Names in which functions and methods of it may differ alone, e.g. those of
                connections. It is the same without them, and takes longer.
        """
        with warnings.catch_warnings():
            # An invalid escape of a template shows as a warning only.
            warnings.simplefilter("error")
            try:
                pieces = [self._piece(word, words) for word in _START.split(text)]
            except CANNOT_PARSE:
                # What looks like a function may stand in a string.
                pieces = [_worked_on(text)]
            laid_out = "\n".join("".join(piece.parts) for piece in pieces)
            if imports is None:
                return laid_out
            lines = import_lines(_joined(pieces), imports)
            return laid_out.replace(MARKER, f"{MARKER}\n{lines}" if lines else MARKER, 1)

    def _piece(self, text: str, words: Collection[str]) -> _Piece:
        if text in self._pieces:
            return self._pieces[text]
        known, alike = _without_words(text, words if _HIDDEN not in text else ())
        hidden = ""
        if known:
            parts = _OWN.split(alike)
            hidden = "".join(own.strip('"') for own in parts[1::2])
            parts[1::2] = map(_hidden, parts[1::2])
            alike = "".join(parts)
        if alike not in self._pieces:
            try:
                piece = _worked_on(alike)
            except CANNOT_PARSE:
                if not known:
                    raise
                return _worked_on(text)
            if hidden:
                piece = _Piece(_HIDDEN_OWN.split("".join(piece.parts)), piece.names)
            self._pieces[alike] = piece
        piece = self._pieces[alike]
        return piece.under(known, hidden) if known else piece


def _worked_on(text: str) -> _Piece:
    code = text.lstrip("\n ")
    around = _AROUND.get(text[: -len(code)].lstrip("\n"), "")
    whole = around + text
    module = ast.parse(whole)
    laid_out = layout(whole, module)
    # The formatter is trusted for layout alone: what it made must still be Python.
    if laid_out != whole:
        ast.parse(laid_out)
    return _Piece([laid_out[len(around) :]], "\n".join(map(" ".join, names_in(module))))


def _joined(pieces: Sequence[_Piece]) -> Names:
    groups = zip(*(piece.names.split("\n") for piece in pieces), strict=True)
    return Names(*({*" ".join(group).split()} for group in groups))


def _hidden(own: str) -> str:
    return f'"{_HIDDEN * (len(own) - 2)}"' if own.startswith('"') else _NO_CODE


def _with_words(text: str, words: Mapping[str, str]) -> str:
    for stand_in, word in words.items():
        text = text.replace(stand_in, word)
    return text


def _without_words(text: str, words: Collection[str]) -> tuple[dict[str, str], str]:
    """Returns the words of a text by their stand-ins, and the text with these."""
    known: dict[str, str] = {}
    if not words or any(letter in text for letter in _STAND_INS):
        return known, text
    for letter, word in zip(_STAND_INS, _words_in(text, words), strict=False):
        # The stand-in has the length of the word, so that the layout is the same.
        known[letter * len(word)] = word
    for stand_in, word in known.items():
        text = _without_word(text, word, stand_in)
    return known, text


def _without_word(text: str, word: str, stand_in: str) -> str:
    alike = text.replace(word, stand_in)
    return _LONGER[stand_in[0]].sub(lambda match: match[0].replace(stand_in, word), alike)


def _words_in(text: str, words: Collection[str]) -> Iterator[str]:
    """Yields the words that are names or in names, as they come."""
    known = set[str]()
    for name in dict.fromkeys(text.translate(_NO_NAME).split()):
        word = name if name in words else _word_in(name, words) if "_" in name else ""
        # A word such as "f" before a string would change what the string is.
        if word and word not in known and not _PREFIX.fullmatch(word):
            known.add(word)
            yield word


def _word_in(name: str, words: Collection[str]) -> str:
    """Returns the first of some words in a name whose parts underscores join."""
    parts = name.split("_")
    for start in range(len(parts)):
        for end in range(len(parts), start, -1):
            word = "_".join(parts[start:end])
            if word in words:
                return word
    return ""
