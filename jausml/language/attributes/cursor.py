"""Token cursor, with which the parsers of all small languages read, and its located errors."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

T = TypeVar("T")


class LanguageError(ValueError):
    """A text does not belong to its language."""

    def __init__(self, message: str, column: int) -> None:
        super().__init__(f"{message} at column {column}")
        self.column = column


@dataclass(frozen=True)
class Language:
    """The words of a language and its bounds.

    Attributes:
        tokens: Matches one token with the blanks before it; the group that matches is its kind.
            Signs are of kind `sign`, words and names of kind `name`.
        longest: Characters of a text; more is none that a person wrote.
    """

    noun: str
    tokens: re.Pattern[str]
    error: Callable[[str, int], Exception]
    longest: int
    deepest: int
    ignores_case: bool = False


class Token(NamedTuple):
    """A token of a text; the last one is empty and of kind `end`.

    Attributes:
        column: Where it stands, from 1.
    """

    kind: str
    text: str
    column: int

    def __str__(self) -> str:
        return f"'{self.text}'" if self.kind != "end" else "the end"


class TokenCursor:
    """A place between the tokens of a text, at which a parser reads on."""

    def __init__(self, text: str, language: Language) -> None:
        self._language = language
        self._depth = 0
        self._next = 0
        if len(text) > language.longest:
            message = f"no {language.noun} has more than {language.longest} characters"
            raise language.error(message, language.longest)
        self._tokens = self._split(text)

    @property
    def token(self) -> Token:
        """The token that is read next."""
        return self._tokens[self._next]

    def error(self, message: str, token: Token | None = None) -> Exception:
        """Returns the error of the language for a token, by default the next one."""
        return self._language.error(message, (token or self.token).column)

    def advance(self) -> Token:
        """Takes the next token, of any kind but `end`."""
        token = self.token
        self._next += 1
        return token

    def take(self, *texts: str) -> str:
        """Takes the next token when it is one of some signs and words; else returns empty text."""
        token = self.token
        text = token.text.lower() if self._language.ignores_case else token.text
        if token.kind not in {"sign", "name"} or text not in texts:
            return ""
        self._next += 1
        return text

    def expect(self, text: str, why: str) -> None:
        """Takes a sign that has to follow; `why` is the error where it does not."""
        if not self.take(text):
            raise self.error(f"{why}: '{text}' is missing")

    def expect_end(self) -> None:
        """Refuses tokens that are left."""
        if self.token.kind != "end":
            raise self.error(f"{self.token} where the {self._language.noun} should end")

    def nested(self, read: Callable[[], T]) -> T:
        """Returns the result of a function that reads one level deeper."""
        self._depth += 1
        if self._depth > self._language.deepest:
            raise self.error(f"the {self._language.noun} is nested too deeply")
        inner = read()
        self._depth -= 1
        return inner

    def parenthesized(self, read: Callable[[], T]) -> T:
        """Returns the result of a function that reads to the end of the parenthesis just taken."""
        opening = self._tokens[self._next - 1]
        inner = self.nested(read)
        if not self.take(")"):
            raise self.error("a parenthesis is not closed", opening)
        return inner

    def _split(self, text: str) -> list[Token]:
        tokens: list[Token] = []
        position, end = 0, len(text.rstrip())
        while position < end:
            match = self._language.tokens.match(text, position)
            if match is None or match.lastgroup is None:
                start = end - len(text[position:end].lstrip())
                message = f"{text[start]!r} belongs in no {self._language.noun}"
                raise self._language.error(message, start + 1)
            kind = match.lastgroup
            tokens.append(Token(kind, match[kind], match.start(kind) + 1))
            position = match.end()
        return [*tokens, Token("end", "", end + 1)]
