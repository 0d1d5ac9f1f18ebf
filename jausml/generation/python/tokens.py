"""Statements of Python as trees of tokens and brackets."""

from __future__ import annotations

import functools
import io
import itertools
import keyword
import tokenize
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

_CLOSING = {"(": ")", "[": "]", "{": "}"}
_SKIPPED = {
    tokenize.ENCODING,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.NEWLINE,
    tokenize.NL,
    tokenize.ENDMARKER,
}
_FSTRING_START = getattr(tokenize, "FSTRING_START", -1)
_FSTRING_END = getattr(tokenize, "FSTRING_END", -1)


@dataclass(frozen=True)
class Token:
    """A word, operator or literal."""

    text: str
    spaced: bool = False
    is_string: bool = False


@dataclass(frozen=True)
class Bracket:
    """A pair of brackets with their contents.

    Attributes:
        trails: Whether it belongs to what stands before it, as those of calls and indices do.
    """

    opening: str
    inside: tuple[Part, ...]
    comma: bool = False
    spaced: bool = False
    trails: bool = False

    @property
    def closing(self) -> str:
        """The closing bracket."""
        return _CLOSING[self.opening]

    @functools.cached_property
    def text(self) -> str:
        """The bracket with its contents, on one line."""
        comma = "," if self.is_lone_tuple else ""
        return f"{self.opening}{flat(self.inside)}{comma}{self.closing}"

    @property
    def is_lone_tuple(self) -> bool:
        """Whether it is a tuple of one item, which needs its comma."""
        return self.opening == "(" and self.comma and not self.trails and not _commas(self.inside)

    @property
    def stays_open(self) -> bool:
        """Whether the comma at its end asks for one item on each line."""
        return self.comma and not self.is_lone_tuple


Part = Token | Bracket


@dataclass(frozen=True)
class Statement:
    """A statement without its line breaks."""

    parts: tuple[Part, ...]
    comment: str = ""


def flat(parts: Sequence[Part]) -> str:
    """Returns parts on one line, without a space at the start; strings side by side are one."""
    text, ends_string = "", False
    for part in parts:
        # Only strings in double quotes are joined: their ends are of one kind.
        is_string = isinstance(part, Token) and part.is_string and part.text[0] == '"'
        if isinstance(part, Token) and is_string and ends_string:
            text = text[:-1] + part.text[1:]
        else:
            text += " " * part.spaced + part.text
        ends_string = is_string
    return text.lstrip(" ")


def can_be_flat(parts: Sequence[Part]) -> bool:
    """Tells whether no comma at the end of a bracket asks for several lines."""
    brackets = (part for part in parts if isinstance(part, Bracket))
    return all(not bracket.stays_open and can_be_flat(bracket.inside) for bracket in brackets)


def read(text: str) -> Statement | None:
    """Returns a statement, or the head of a compound one, as a tree."""
    tokens = list(_joined(text))
    comments = [token for token in tokens if token.type == tokenize.COMMENT]
    comment = ""
    if comments:
        if len(comments) > 1 or tokens[-1] is not comments[0]:
            return None
        comment = tokens.pop().string
    # A text over several lines cannot be laid out without changing it.
    if any("\n" in token.string for token in tokens):
        return None
    parts, _ = _parts(tokens, 0)
    return Statement(tuple(parts), comment)


def _commas(parts: Sequence[Part]) -> bool:
    return any(isinstance(part, Token) and part.text == "," for part in parts)


def _joined(text: str) -> Iterator[tokenize.TokenInfo]:
    """Yields the tokens of a text; an f-string is one token in any version of Python."""
    lines = text.split("\n")
    start, depth = (0, 0), 0
    try:
        for token in tokenize.generate_tokens(io.StringIO(text).readline):
            if token.type == _FSTRING_START:
                # From Python 3.12 on f-strings are several tokens, and may stand within each other.
                start = start if depth else token.start
                depth += 1
            elif token.type == _FSTRING_END:
                depth -= 1
                if not depth:
                    yield _string_between(lines, start, token.end)
            elif not depth and token.type not in _SKIPPED:
                yield token
    except tokenize.TokenError:
        # The head of a compound statement has no body here.
        return


def _string_between(
    lines: Sequence[str], start: tuple[int, int], end: tuple[int, int]
) -> tokenize.TokenInfo:
    rows = list(lines[start[0] - 1 : end[0]])
    rows[-1] = rows[-1][: end[1]]
    rows[0] = rows[0][start[1] :]
    return tokenize.TokenInfo(tokenize.STRING, "\n".join(rows), start, end, "")


def _parts(tokens: Sequence[tokenize.TokenInfo], index: int) -> tuple[list[Part], int]:
    """Returns the parts up to a closing bracket, and where it stands."""
    parts: list[Part] = []
    while index < len(tokens) and tokens[index].string not in _CLOSING.values():
        token = tokens[index]
        spaced = _is_spaced(tokens, index)
        if token.string in _CLOSING:
            trails = bool(parts) and not spaced and ends_operand(parts[-1])
            inside, index = _parts(tokens, index + 1)
            # The comma says how to break, and is put back by the layout.
            comma = bool(inside) and inside[-1] == Token(",")
            kept = tuple(inside[:-1] if comma else inside)
            parts.append(Bracket(token.string, kept, comma, spaced, trails))
        else:
            parts.append(Token(token.string, spaced, token.type == tokenize.STRING))
        index += 1
    return parts, index


def _is_spaced(tokens: Sequence[tokenize.TokenInfo], index: int) -> bool:
    """Tells whether a space comes before a token when the statement is on one line."""
    if not index:
        return False
    before, token = tokens[index - 1], tokens[index]
    if before.end[0] == token.start[0]:
        return before.end[1] < token.start[1]
    # Joined to one line, brackets and commas need no space beside them.
    return before.string not in _CLOSING and token.string not in {",", ".", *_CLOSING.values()}


def is_word(part: Part, *texts: str) -> bool:
    """Tells whether a part is one of some words or signs."""
    return isinstance(part, Token) and part.text in texts


def ends_operand(part: Part) -> bool:
    """Tells whether an operator follows a part, rather than an operand or a sign."""
    if isinstance(part, Bracket) or part.is_string:
        return True
    is_name = part.text.isidentifier() and not keyword.iskeyword(part.text)
    return is_name or part.text[0].isdigit() or part.text in {"True", "False", "None", "..."}


def split_at(parts: Sequence[Part], positions: Sequence[int]) -> list[tuple[Part, ...]]:
    """Returns parts cut before some positions."""
    bounds = [0, *positions, len(parts)]
    return [tuple(parts[start:end]) for start, end in itertools.pairwise(bounds)]


def items(bracket: Bracket) -> list[tuple[Part, ...]]:
    """Returns the parts between the commas of a bracket."""
    # Of a comprehension or a generator, commas part nothing.
    if any(is_word(part, "for") for part in bracket.inside):
        return [bracket.inside]
    elements: list[tuple[Part, ...]] = []
    current: list[Part] = []
    arguments_of_lambda = 0
    for part in bracket.inside:
        # Commas between the parameters of a lambda part no items.
        if isinstance(part, Token) and part.text == "lambda":
            arguments_of_lambda += 1
        elif isinstance(part, Token) and part.text == ":" and arguments_of_lambda:
            arguments_of_lambda -= 1
        if is_word(part, ",") and not arguments_of_lambda:
            elements.append(tuple(current))
            current = []
        else:
            current.append(part)
    return [*elements, tuple(current)] if current else elements
