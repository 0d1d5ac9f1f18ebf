"""The grammar as lark compiles it: a pattern for all tokens, and a machine that takes them.

The tables are lark's. What runs over them for each token of a text is here: lark's own lexer and
parser do far more for each than what they are needed for.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, TypeAlias

from lark import Lark, Token
from lark.lexer import PatternStr

from jausml.language.text.reading.shaping import Shaper

NOT_PARSED = ("COMMENT", "OPEN_COMMENT", "OPEN_TEXT", "OPEN_NAME", "WRONG_NUMBER", "WRONG")
"""Tokens of the grammar that no rule has."""
END = "$END"

_WORD, _BLANK = "WORD", "BLANK"

Rule: TypeAlias = "tuple[int, str, Callable[[list[Any]], Any]]"
"""Of how many parts something consists, what it is, and what makes it of them."""


@dataclass(frozen=True, slots=True)
class Grammar:
    """The tables by which texts are scanned and parsed.

    Attributes:
        pattern: The next token and the blanks before it; the last group is named for the kind,
            and there is none at the end of the text.
        keywords: Kinds of the words that are no names.
        states: What comes by each symbol in each state: the next state, or a rule that is complete.
    """

    pattern: re.Pattern[str]
    keywords: Mapping[str, str]
    states: Mapping[int, Mapping[str, int | Rule]]
    first: int
    last: int


class _KeepAll:
    """Has lark keep the tokens that no rule of the grammar has."""

    always_accept = NOT_PARSED

    def process(self, stream: Iterator[Token]) -> Iterator[Token]:
        return stream


@cache
def grammar() -> Grammar:
    """Returns the grammar; made on first use, for that takes 0.1 s."""
    options: dict[str, Any] = {
        "parser": "lalr",
        "lexer": "basic",
        "postlex": _KeepAll(),
        "transformer": Shaper(),
        "keep_all_tokens": True,
        "maybe_placeholders": False,
    }
    path = Path(__file__).with_name("grammar.lark")
    parser = Lark(path.read_text(encoding="utf-8"), **options)
    word = re.compile(parser.get_terminal(_WORD).pattern.to_regexp())
    literals = {terminal.name: terminal.pattern for terminal in parser.terminals}
    keywords = {
        pattern.value: name
        for name, pattern in literals.items()
        if isinstance(pattern, PatternStr) and word.fullmatch(pattern.value)
    }
    # As lark does: the longest that may be meant.
    no_tokens = {_BLANK, *keywords.values()}
    tokens = sorted(
        (terminal for terminal in parser.terminals if terminal.name not in no_tokens),
        key=lambda terminal: (
            -terminal.priority,
            -terminal.pattern.max_width,
            -len(terminal.pattern.value),
            terminal.name,
        ),
    )
    kinds = "|".join(f"(?P<{token.name}>{token.pattern.to_regexp()})" for token in tokens)
    pattern = rf"\s*(?:{kinds}|\Z)"
    tables: Any = parser.parse_interactive().parser_state.parse_conf  # Any: it has no types
    states = {
        state: {
            str(symbol): argument if isinstance(argument, int) else _rule(argument, tables)
            for symbol, (_, argument) in actions.items()
        }
        for state, actions in tables.states.items()
    }
    return Grammar(re.compile(pattern), keywords, states, tables.start_state, tables.end_state)


# Only what running the tables takes: a rule of lark has far more.
def _rule(rule: Any, tables: Any) -> Rule:
    return len(rule.expansion), str(rule.origin.name), tables.callbacks[rule]


class Machine:
    """A run over tokens: the complete values so far, and the states, which are one more."""

    def __init__(self) -> None:
        self._grammar = grammar()
        self.values: list[Any] = []
        self.states = [self._grammar.first]

    def take(self, token: Token) -> bool:
        """Takes a token; returns False where it cannot come, with complete values completed."""
        table, states, values, type_ = self._grammar.states, self.states, self.values, token.type
        while (action := table[states[-1]].get(type_)) is not None:
            if isinstance(action, int):
                states.append(action)
                values.append(token)
                return True
            size, name, make = action
            if size:
                parts = values[-size:]
                del values[-size:], states[-size:]
            else:
                # An empty rule has nothing to take away, and a slice from -0 would take all.
                parts = []
            values.append(make(parts))
            states.append(table[states[-1]][name])  # type: ignore[arg-type] # a rule's is a state
            if states[-1] == self._grammar.last:
                return True
        return False

    def accepts(self, type_: str) -> bool:
        """Tells whether a token of a kind could come next."""
        # On a copy of the states, without making anything: the token is only asked about.
        table, states = self._grammar.states, list(self.states)
        while (action := table[states[-1]].get(type_)) is not None:
            if isinstance(action, int):
                return True
            size, name, _ = action
            if size:
                del states[-size:]
            states.append(table[states[-1]][name])  # type: ignore[arg-type] # a rule's is a state
            if states[-1] == self._grammar.last:
                return True
        return False

    def accepted(self) -> set[str]:
        """Returns the kinds of tokens that could come next."""
        kinds = self._grammar.states[self.states[-1]]
        return {kind for kind in kinds if kind.isupper() and self.accepts(kind)}
