"""Parser of ros2jaus text: its syntax tree, with all syntax errors of a text in one run.

The parser is lark's LALR parser, fed token by token. At an error it drops the item that is wrong
and goes on with what comes behind it in the same list: the next item that begins a line, or the
bracket that ends the list. Brackets that are missing are added, those too many are left out; a
clause of a map that begins a line tells that the list before it lacks its bracket.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

from lark import Token

from jausml.language.text.reading.machine import END, Machine
from jausml.language.text.reading.scanning import (
    SyntaxFault,
    attach,
    describe,
    scan,
    shown,
    suggestion,
)
from jausml.language.text.reading.shaping import Items, span_of
from jausml.language.text.tree import DEEPEST, LONGEST, Span, SyntaxTree

__all__ = ["MOST_FAULTS", "Parsed", "SyntaxFault", "parse", "parsed_text"]

MOST_FAULTS = 100
"""Syntax errors after which a text is not read further."""

_VALUES = {"WORD", "NUMBER", "TEXT", "HREF"}
_CLOSERS = {"LBRACE": "RBRACE", "LPAR": "RPAR", "LSQB": "END_BRACKET"}
_ITEM_GOES_ON = {"COLON", "LBRACE", "LSQB", "ARROW", "EQUAL", "PAIR"}
_CLAUSES = ("JAUS", "ROS", "TABLE", "VECTOR")
_OPENERS = {"RBRACE": "LBRACE", "RPAR": "LPAR", "END_BRACKET": "LSQB", "NAMED_BRACKET": "LSQB"}


@dataclass(slots=True)
class Parsed:
    """The outcome of parsing a text.

    Attributes:
        document: The tree of all that could be read.
        faults: The syntax errors, in the order of the text.
        tokens: All tokens, those too that were dropped.
    """

    document: SyntaxTree
    faults: list[SyntaxFault] = field(default_factory=list)
    tokens: list[Token] = field(default_factory=list)


def parse(text: str) -> Parsed:
    """Reads a text, perhaps with a byte order mark; never raises."""
    text = text.removeprefix("\ufeff")
    if len(text) > LONGEST:
        fault = SyntaxFault(Span(), f"the text is longer than {LONGEST:,} characters")
        return Parsed(SyntaxTree(), [fault])
    scanned = scan(text)
    run = _Run(scanned.tokens)
    document = run.document()
    attach(document, scanned.comments)
    faults = scanned.faults + run.faults
    faults.sort(key=lambda fault: (fault.span.line, fault.span.column))
    return Parsed(document, faults, scanned.tokens)


@lru_cache(maxsize=8)
def parsed_text(text: str) -> Parsed:
    """Returns the result of `parse`, the same for all callers; it must not be changed."""
    return parse(text)


class _Run:
    """One run of the parser over the tokens of a text."""

    def __init__(self, tokens: list[Token]) -> None:
        self.faults: list[SyntaxFault] = []
        self._tokens = tokens
        self._machine = Machine()
        self._accepts = self._machine.accepts
        self._values = self._machine.values

    def document(self) -> SyntaxTree:
        """Reads all tokens."""
        position = depth = 0
        take = self._machine.take
        while position < len(self._tokens):
            token = self._tokens[position]
            depth += token.type in _CLOSERS
            if depth > DEEPEST or len(self.faults) >= MOST_FAULTS:
                break
            # Before the machine sees it: two words in a row are an element to the grammar.
            if token.type in _VALUES and (fault := self._lone_word(position)) is not None:
                self.faults.append(fault)
                position += 1
            elif take(token):
                position += 1
                depth -= token.type in _OPENERS
            else:
                self._report(position)
                position = self._recover(position)
                # Recovery may have closed brackets or dropped some with their item.
                depth = len(self._open_brackets())
        return self._end(position)

    def _end(self, position: int) -> SyntaxTree:
        """Ends the document, with the brackets that are missing."""
        if position < len(self._tokens):
            is_deep = len(self.faults) < MOST_FAULTS
            deep = f"brackets are nested more than {DEEPEST} deep"
            message = deep if is_deep else "so much is wrong above that the rest is not read"
            self.faults.append(SyntaxFault(span_of(self._tokens[position]), message))
        elif not self._accepts(END):
            self._report(position)
        # What is whole at the end of the text stays; only the unfinished item goes.
        self._complete_item()
        self._drop_item()
        while self._open_brackets():
            self._close()
        self._machine.take(self._token(END))
        document: SyntaxTree = self._values[-1]
        return document

    def _report(self, position: int) -> None:
        """Reports that the token at a position cannot stand there."""
        accepted = self._machine.accepted()
        message = describe(accepted, self._tokens, position)
        hint = suggestion(accepted, self._tokens, position)
        brackets = self._open_brackets()
        if position < len(self._tokens):
            span = span_of(self._tokens[position])
        else:
            last = span_of(self._tokens[-1])
            span = Span(last.end_line, last.end_column, last.end_line, last.end_column)
            if brackets:
                hint = f"the '{brackets[0]}' of line {brackets[0].line} is not closed"
        self.faults.append(SyntaxFault(span, message, hint))

    def _lone_word(self, position: int) -> SyntaxFault | None:
        """Returns the fault of a word that is legal and hardly meant so; None for other tokens."""
        token = self._tokens[position]
        if self._lacks_comma(position):
            before, token_text = shown(self._tokens[position - 1]), shown(token)
            message = f"expected ',' behind {before}, found {token_text}"
            hint = f"write a comma between {before} and {token_text}"
            return SyntaxFault(span_of(token), message, hint)
        if self._stands_alone(position):
            hint = "an element is written 'keyword name { ... }', a feature 'name: value'"
            return SyntaxFault(span_of(token), f"{shown(token)} stands alone on its line", hint)
        return None

    def _stands_alone(self, position: int) -> bool:
        """Tells whether a word in a block has its own line, before an element with its own."""
        if self._type(position + 1) != "WORD" or self._type(position + 2) != "WORD":
            return False
        if self._tokens[position].type != "WORD":
            return False
        breaks = [self._begins_line(number) for number in range(position, position + 3)]
        if breaks != [True, True, False]:
            return False
        return self._accepts("RBRACE") or self._accepts(END)

    def _lacks_comma(self, position: int) -> bool:
        """Tells whether a token that follows a value is a further value: no item begins there."""
        if len(self._values) < 2 or _kind(self._values[-1]) not in _VALUES:
            return False
        following = self._type(position + 1)
        if _kind(self._values[-2]) not in ("COLON", "COMMA") or following in _ITEM_GOES_ON:
            return False
        if following == "COMMA":
            # Several sources of an assignment, or the rest of the values.
            while self._type(position + 1) == "COMMA":
                position += 2
            return self._type(position + 1) != "ARROW"
        if following != "WORD" or self._type(position + 2) in _ITEM_GOES_ON - {"LBRACE"}:
            return True
        # Two words on one line are an element; in front of a block they may stand on two.
        shares_line = not self._begins_line(position + 1)
        has_block = self._type(position + 2) == "LBRACE" and self._begins_line(position)
        return not shares_line and not has_block

    def _type(self, position: int) -> str:
        return self._tokens[position].type if position < len(self._tokens) else ""

    def _recover(self, position: int) -> int:
        """Drops what is wrong.

        Returns:
            The position of the token to go on with, which the parser takes; or the end.
        """
        self._complete_item()
        # Closers of brackets that went with the item are skipped, not taken for the list's.
        dropped = self._drop_item()
        skipped = 0
        while position < len(self._tokens):
            token = self._tokens[position]
            if token.type in _CLOSERS and not self._begins_arguments(position):
                skipped += 1
            elif token.type in _CLOSERS:
                dropped += 1
            elif token.type in _OPENERS and skipped:
                skipped -= 1
            elif token.type in _OPENERS and dropped:
                dropped -= 1
            elif token.type in _OPENERS:
                if self._close_up_to(token):
                    break
            elif not skipped and self._begins_line(position) and self._close_before(token):
                break
            position += 1
        return position

    def _begins_arguments(self, position: int) -> bool:
        """Tells whether a bracket belongs to a conversion, which ends with its line."""
        types = [token.type for token in self._tokens[max(position - 2, 0) : position + 1]]
        return types in (["COLON", "WORD", "LPAR"], ["COMMA", "WORD", "LPAR"])

    def _close_before(self, token: Token) -> bool:
        """Closes lists that a clause shows to lack their bracket; returns whether it can come."""
        # A clause begins no member or value, so what is open before it lacks its bracket.
        if token.type in _CLAUSES:
            while not self._accepts(token.type) and self._open_brackets()[0].type != "LBRACE":
                self._close()
        return self._accepts(token.type)

    def _begins_line(self, position: int) -> bool:
        return position == 0 or self._tokens[position - 1].line != self._tokens[position].line

    def _close_up_to(self, token: Token) -> bool:
        """Closes what is open within the bracket that a token closes; returns whether it can come.

        One of the wrong kind that is meant for the innermost list closes that, and does not come.
        """
        opener = _OPENERS[token.type]
        if self._is_misspelt(token):
            self._close()
            return False
        if opener not in (bracket.type for bracket in self._open_brackets()):
            return False
        # Brackets of other kinds within it were forgotten.
        while self._open_brackets()[0].type != opener:
            self._close()
        if self._accepts(token.type):
            return True
        self._drop_bracket()
        return False

    def _is_misspelt(self, token: Token) -> bool:
        """Tells whether a bracket of the wrong kind is exactly below the line that it closes."""
        brackets = self._open_brackets()
        if not brackets or brackets[0].type == _OPENERS[token.type]:
            return False
        # A bracket below the head of its block was meant to close it, whatever its kind.
        head = self._first_of_line(brackets[0].line)
        return self._first_of_line(token.line) is token and token.column == head.column

    def _first_of_line(self, line: int) -> Token:
        return next(token for token in self._tokens if token.line == line)

    # The stacks of the parser

    def _open_brackets(self) -> list[Token]:
        """Returns the brackets that are open, the innermost first."""
        brackets = []
        closed = 0
        for value in reversed(self._values):
            type_ = _kind(value)
            if type_ in _OPENERS:
                closed += 1
            elif type_ in _CLOSERS:
                if not closed:
                    brackets.append(value)
                closed = max(closed - 1, 0)
        return brackets

    def _token(self, type_: str) -> Token:
        """Returns a token that the text does not have, for its end."""
        last = self._tokens[-1] if self._tokens else None
        return Token.new_borrow_pos(type_, "", last) if last is not None else Token(type_, "")

    def _complete_item(self) -> None:
        """Completes the last item, as a semicolon does."""
        if self._accepts("SEMICOLON"):
            self._machine.take(self._token("SEMICOLON"))

    def _drop_item(self) -> int:
        """Drops the unfinished item of the innermost list.

        Returns:
            How many brackets were open in it.
        """
        closed = dropped = 0
        while self._values and (closed or not isinstance(self._values[-1], Items)):
            type_ = _kind(self._drop())
            if type_ in _OPENERS:
                closed += 1
            elif type_ in _CLOSERS:
                dropped += not closed
                closed = max(closed - 1, 0)
        return dropped

    def _drop(self) -> Any:
        self._machine.states.pop()
        return self._values.pop()

    def _close(self) -> None:
        """Closes the innermost bracket, or drops its contents if that is not possible yet."""
        closer = _CLOSERS[self._open_brackets()[0].type]
        if self._accepts(closer):
            self._machine.take(self._token(closer))
            self._complete_item()
            self._drop_item()
        else:
            self._drop_bracket()

    def _drop_bracket(self) -> None:
        """Drops the item whose bracket is the innermost open one."""
        bracket = self._open_brackets()[0]
        while self._drop() is not bracket:
            pass
        self._drop_item()


def _kind(value: Any) -> str:
    """Returns the type of a token, and an empty text for other values."""
    return value.type if isinstance(value, Token) else ""
