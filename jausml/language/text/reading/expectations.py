"""Expectations of the parser in the words of the language, and what was probably meant."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.model.values import nearest
from jausml.language.text.keywords import KEYWORDS

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from lark import Token

_KEYWORD_TYPES = {word.upper() for word in KEYWORDS}
_STARTERS = {"WORD", "INDEXED", "NUMBER", "TEXT", *_KEYWORD_TYPES}
_VALUES = {"WORD", "NUMBER", "TEXT", "HREF", "LBRACE", "NEW"}
_MARKS = {
    "ARROW": "'->'",
    "PAIR": "'<->'",
    "GIVES": "'=>'",
    "EQUAL": "'='",
    "AT_MOST": "'<='",
    "TILDE": "'~'",
    "COMMA": "','",
    "COLON": "':'",
    "LBRACE": "'{'",
    "LPAR": "'('",
    "LSQB": "'['",
    "JAUS": "'JAUS'",
    "ROS": "'ROS'",
    "NUMBER": "a number",
    "TEXT": "a text",
}
_CLOSING = {"RBRACE": "'}'", "RPAR": "')'", "END_BRACKET": "']'"}
_LONGEST_SHOWN = 40


def describe(accepted: Collection[str], tokens: Sequence[Token], position: int) -> str:
    """Returns what was expected behind what, and what was found.

    Args:
        position: Of the token that was found; behind the last at the end of the text.
    """
    behind = f" behind {shown(tokens[position - 1])}" if position else ""
    is_end = position >= len(tokens)
    found = "the end of the text" if is_end else shown(tokens[position])
    return f"expected {_alternatives(_phrases(set(accepted)))}{behind}, found {found}"


def suggestion(accepted: Collection[str], tokens: Sequence[Token], position: int) -> str:
    """Returns what was probably meant, or an empty text."""
    if position >= len(tokens):
        return ""
    found = tokens[position]
    if found.type in _KEYWORD_TYPES and "WORD" in accepted and "SEMICOLON" not in accepted:
        return f"as a name it stands in back quotes: `{found}`"
    if found.type in ("EQUAL", "GIVES"):
        if "ARROW" in accepted:
            return "an assignment is written 'source -> target'"
        if "COLON" in accepted:
            return f"a feature is written '{tokens[position - 1]}: ...'"
    if found.type == "ARROW" and "COMMA" in accepted:
        return "no comma stands between assignments"
    for token in reversed(tokens[max(position - 2, 0) : position + 1]):
        meant = nearest(token, KEYWORDS) if token.type == "WORD" else None
        if meant:
            return f"did you mean '{meant}'?"
    return ""


def _phrases(accepted: set[str]) -> list[str]:
    """Returns what could come, in a reader's words: marks first, what ends the list last."""
    nouns = []
    if "SEMICOLON" in accepted:
        nouns.append(_noun(accepted & _STARTERS))
        accepted = accepted - _STARTERS
    elif accepted >= _VALUES:
        nouns.append("a value")
        accepted = accepted - _VALUES
    elif "WORD" in accepted:
        nouns.append("a path" if "INDEXED" in accepted else "a name")
    marks = [phrase for type_, phrase in _MARKS.items() if type_ in accepted]
    ends = [phrase for type_, phrase in _CLOSING.items() if type_ in accepted]
    return marks + nouns + ends


def _noun(starters: set[str]) -> str:
    """Returns what a list consists of whose items begin with certain tokens."""
    if "NUMBER" in starters:
        if "NEW" in starters:
            return "an assignment or a feature"
        return "an assignment" if "IGNORE" in starters else "a pair such as 'OFF <-> 0'"
    if "NEW" in starters:
        return "an item" if "INDEXED" in starters else "a feature such as 'units: \"m\"'"
    return "a member such as 'float32 x'" if "STRUCT" in starters else "a value such as 'X = 1'"


def _alternatives(phrases: list[str]) -> str:
    *others, last = phrases or ["the end of the text"]
    return f"{', '.join(others)} or {last}" if others else last


def shown(token: Token) -> str:
    """Returns how messages name a token."""
    text = str(token) if len(token) <= _LONGEST_SHOWN else f"{token[: _LONGEST_SHOWN - 3]}..."
    return text if token.type == "TEXT" else f"'{text}'"
