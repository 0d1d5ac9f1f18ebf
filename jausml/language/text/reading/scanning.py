"""Scanner: cuts text into tokens and comments, and says what was expected in place of others.

A comment belongs to the item behind it, but on the last line of an item to that one. One within an
item that has no list there goes before the item. What stands before a closing bracket stays there.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from lark import Token

from jausml.language.model.values import nearest
from jausml.language.text import tree
from jausml.language.text.comments import documentation_text, is_documentation
from jausml.language.text.keywords import KEYWORDS
from jausml.language.text.reading.machine import NOT_PARSED, grammar
from jausml.language.text.reading.shaping import Items, span_of

_LONE_RETURN = re.compile(r"\r(?!\n)")
_BAD_ESCAPE = re.compile(r"""\\(?:u(?![0-9a-fA-F]{4})|[^"`\\ntru])""")
_LONE_SURROGATE = re.compile(
    # A high surrogate without the low one behind it, or a low one without the high one before.
    r"\\u[dD][89abAB]\w\w(?!\\u[dD][c-fC-F])|(?<!\\u[dD][89abAB]\w\w)\\u[dD][c-fC-F]\w\w"
)
_INSTEAD = {
    "→": "write '->'",
    "⇒": "write '->'",
    "↔": "write '<->'",
    "#": "comments begin with '//'",
    "'": 'texts stand in quotation marks: "..."',
    "“": 'texts stand in straight quotation marks: "..."',
    "”": 'texts stand in straight quotation marks: "..."',
    "-": "a name with '-' stands in back quotes",
    "$": "a name with '$' stands in back quotes",
    "@": 'a reference by file and fragment is written @"file#fragment"',
}


class SyntaxFault(NamedTuple):
    """A syntax error."""

    span: tree.Span
    message: str
    hint: str = ""


@dataclass(slots=True)
class Scan:
    """The tokens and comments of a text, with what is no token."""

    tokens: list[Token] = field(default_factory=list)
    comments: list[Token] = field(default_factory=list)
    faults: list[SyntaxFault] = field(default_factory=list)


def with_line_feeds(text: str) -> str:
    """Returns a text with a line feed for each carriage return that ends a line alone."""
    return _LONE_RETURN.sub("\n", text) if "\r" in text else text


def line_end(text: str) -> str:
    """Returns the line end of a text: that of its first line."""
    match = re.search(r"\r\n|\n|\r", text)
    return match.group() if match else "\n"


def scan(text: str) -> Scan:
    """Returns the tokens, comments and wrong characters of a text.

    Lines end with LF, CR and LF, or CR alone: else a comment could swallow the file.
    """
    # With one kind of line end less, lines are counted by line feeds alone.
    text = with_line_feeds(text)
    keywords = grammar().keywords
    result = Scan()
    # Where lines begin: that of a token is the last one that is not behind its start.
    begins = [0, *(match.end() for match in re.finditer("\n", text)), len(text)]
    line = 1
    before: Token | None = None
    for match in grammar().pattern.finditer(text):
        kind = match.lastgroup
        if kind is None:
            break
        start, end = match.span(kind)
        value = match[kind]
        while begins[line] <= start:
            line += 1
        end_line = line
        while begins[end_line] < end:
            end_line += 1
        token: Token = str.__new__(Token, value)  # lark's own way takes twice as long
        token.type, token.value = keywords.get(value, kind), value
        token.start_pos, token.line, token.column = start, line, start - begins[line - 1] + 1
        token.end_pos, token.end_line = end, end_line
        token.end_column = end - begins[end_line - 1] + 1
        if kind == "COMMENT":
            result.comments.append(token)
        elif kind in NOT_PARSED:
            _mend(token, before, result)
        else:
            if "\\" in value:
                result.faults += _escape_faults(token)
            result.tokens.append(token)
            before = token
    return result


def _mend(token: Token, before: Token | None, result: Scan) -> None:
    """Reports a wrong token, and replaces it by the intended one."""
    span = span_of(token)
    if token.type == "OPEN_COMMENT":
        start = tree.Span(span.line, span.column, span.line, span.column + 2)
        result.faults.append(SyntaxFault(start, "the comment is not closed", "it ends with '*/'"))
    elif token.type == "OPEN_TEXT":
        result.faults.append(
            SyntaxFault(span, "the text is not closed on its line", "a line break is written \\n")
        )
        kind, value = ("HREF", token[1:]) if token.startswith("@") else ("TEXT", token)
        closed = f'{_whole(value)}"'
        result.tokens.append(token.update(kind, closed if kind == "TEXT" else f"@{closed}"))
    # A name in back quotes is taken as if it were closed, so that the item still parses.
    elif token.type == "OPEN_NAME":
        result.faults.append(SyntaxFault(span, "the name in back quotes is not closed on its line"))
        result.tokens.append(token.update("WORD", f"{_whole(token)}`"))
    elif token.type == "WRONG_NUMBER":
        hint = f"a name that begins with a digit stands in back quotes: `{token}`"
        result.faults.append(SyntaxFault(span, f"'{token}' is no number", hint))
        result.tokens.append(token.update("WORD", f"`{token}`"))
    else:
        shown = str(token) if token.isprintable() else f"U+{ord(token):04X}"
        joins = before is not None and before.end_pos == token.start_pos
        # A minus or dollar beside a word belongs to a name; alone it means nothing.
        hint = _INSTEAD.get(str(token), "") if joins or str(token) not in "-$" else ""
        result.faults.append(SyntaxFault(span, f"nothing is written with '{shown}' here", hint))


def _whole(text: str) -> str:
    """Returns a text without the first half of an escape at its end."""
    # An even number of them are escaped backslashes.
    halves = len(text) - len(text.rstrip("\\"))
    return text[:-1] if halves % 2 else text


def _escape_faults(token: Token) -> Iterator[SyntaxFault]:
    # Escaped backslashes are no beginning of an escape; columns must stay.
    plain = token.replace("\\\\", "//")
    for pattern in (_BAD_ESCAPE, _LONE_SURROGATE):
        for match in pattern.finditer(plain):
            column = (token.column or 1) + match.start()
            span = tree.Span(token.line or 1, column, token.line or 1, column + len(match.group()))
            message = f"'{match.group()}' is no escape"
            known = '\\" \\` \\\\ \\n \\t \\r \\uXXXX'
            yield SyntaxFault(span, message, f"there are {known}")


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
    """Returns a sentence with the expected tokens, the token before them, and the actual one.

    Args:
        position: Of the token that was found; behind the last at the end of the text.
    """
    behind = f" behind {shown(tokens[position - 1])}" if position else ""
    is_end = position >= len(tokens)
    actual = "the end of the text" if is_end else shown(tokens[position])
    return f"expected {_alternatives(_phrases(set(accepted)))}{behind}, found {actual}"


def suggestion(accepted: Collection[str], tokens: Sequence[Token], position: int) -> str:
    """Returns the probable intention, or an empty text."""
    if position >= len(tokens):
        return ""
    unexpected_token = tokens[position]
    if (
        unexpected_token.type in _KEYWORD_TYPES
        and "WORD" in accepted
        and "SEMICOLON" not in accepted
    ):
        return f"as a name it stands in back quotes: `{unexpected_token}`"
    if unexpected_token.type in ("EQUAL", "GIVES"):
        if "ARROW" in accepted:
            return "an assignment is written 'source -> target'"
        if "COLON" in accepted:
            return f"a feature is written '{tokens[position - 1]}: ...'"
    if unexpected_token.type == "ARROW" and "COMMA" in accepted:
        return "no comma stands between assignments"
    for token in reversed(tokens[max(position - 2, 0) : position + 1]):
        meant = nearest(token, KEYWORDS) if token.type == "WORD" else None
        if meant:
            return f"did you mean '{meant}'?"
    return ""


def _phrases(accepted: set[str]) -> list[str]:
    """Returns the possible tokens in a reader's words: marks first, the end of the list last."""
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
    """Returns the noun for the items of a list that begin with certain tokens."""
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


@dataclass(slots=True)
class _Body:
    """A list of items with the comments before its closing bracket; None where none are kept."""

    items: Sequence[tree.Item]
    closing: list[str] | None
    start: tuple[int, int]
    end: tuple[int, int]


def attach(document: tree.SyntaxTree, comments: Sequence[Token]) -> None:
    """Puts comments to the items of a document."""
    far = (1 << 60, 0)
    _distribute(_Body(document.items, document.closing, (1, 1), far), list(comments))


def _ordinary(comment: Token) -> str:
    """Returns a comment with further lines indented as relative to its start."""
    text = str(comment)
    # It would become a documentation comment of the next item when it is read again.
    if text.startswith("/**") and text[3] not in "*/":
        text = f"/*{text[3:]}"
    first, *further = (line.rstrip() for line in text.split("\n"))
    margin = (comment.column or 1) - 1
    blank = " \t"
    # Blanks up to the margin are layout, further ones are of the comment.
    cut = [line[min(margin, len(line) - len(line.lstrip(blank))) :] for line in further]
    return "\n".join([first, *cut])


def _distribute(body: _Body, comments: list[Token]) -> list[Token]:
    """Puts comments to the items of a list, behind an item that ends on a line.

    Returns:
        Those that the list has no place for.
    """
    if not comments:
        return comments
    pending = list(reversed(comments))
    line = 0  # of the end of the item before
    for item in body.items:
        start, end = _start(item), _end(item)
        leading = _take(pending, start)
        inner = _take(pending, end)
        _lead(item, leading, line)
        line = end[0]
        for comment in _within(item, inner):
            item.comments.append(_ordinary(comment))
        # Only comments that end on the line, or the rest of them would move.
        while pending and pending[-1].line == pending[-1].end_line == end[0]:
            item.trailing = f"{item.trailing} {_ordinary(pending.pop())}".lstrip()
    rest = list(reversed(pending))
    if body.closing is None:
        return rest
    for comment in rest:
        if line and (comment.line or 1) > line + 1:
            body.closing.append("")
        body.closing.append(_ordinary(comment))
        line = comment.end_line or 1
    return []


def _take(pending: list[Token], end: tuple[int, int]) -> list[Token]:
    """Takes the comments before a position from a reversed list."""
    taken = []
    while pending and _position(pending[-1]) < end:
        taken.append(pending.pop())
    return taken


def _lead(item: tree.Item, comments: Sequence[Token], line: int) -> None:
    """Puts the comments before an item to it."""
    first = (comments[0].line if comments else item.span.line) or 1
    item.spaced = bool(line) and first > line + 1
    documenting = next((token for token in reversed(comments) if is_documentation(token)), None)
    line = first
    for comment in comments:
        _keep_empty_line(item, line, comment.line or 1)
        line = comment.end_line or 1
        if comment is documenting:
            item.documentation = documentation_text(comment)
        else:
            item.comments.append(_ordinary(comment))
    if comments and comments[-1] is not documenting:
        _keep_empty_line(item, line, item.span.line)


def _keep_empty_line(item: tree.Item, line: int, next_line: int) -> None:
    if next_line > line + 1 and item.comments and item.comments[-1]:
        item.comments.append("")


def _within(item: tree.Item, comments: list[Token]) -> list[Token]:
    """Puts comments to what an item consists of.

    Returns:
        Those that stand between its parts.
    """
    if not comments:
        return comments
    # From the first list to the last, so that what is behind one is left for the next.
    for body in _bodies(item):
        before = [comment for comment in comments if _position(comment) < body.start]
        inside = [comment for comment in comments if body.start <= _position(comment) < body.end]
        behind = comments[len(before) + len(inside) :]
        comments = before + _distribute(body, inside) + behind
    return comments


def _bodies(item: tree.Item) -> Iterator[_Body]:
    """Yields the lists of an item, from the first to the last."""
    for items, closing in tree.lists_of(item):
        if isinstance(items, Items) and items.start is not None:
            start = items.start
            if isinstance(item, tree.Vector) and items is item.expected and item.given:
                # What stands before the arrow, on lines of its own, is about what stands behind it.
                start = _end(item.given[-1])
            yield _Body(items, closing, start, items.end)


def _position(token: Token) -> tuple[int, int]:
    return (token.line or 1, token.column or 1)


def _start(item: tree.Item) -> tuple[int, int]:
    return (item.span.line, item.span.column)


def _end(item: tree.Item) -> tuple[int, int]:
    return (item.span.end_line, item.span.end_column)
