"""The layout of rendered Python: long statements broken as ruff's formatter breaks them.

Templates and views write a statement on one line. Where that is too long, or already broken, it is
laid out here. Quotes, spaces within a line and blank lines stay as they are.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence

from jausml.generation.literals import LINE_WIDTH
from jausml.generation.python.tokens import (
    Bracket,
    Part,
    Token,
    can_be_flat,
    ends_operand,
    flat,
    is_word,
    items,
    read,
    split_at,
)

_STEP = " " * 4
_KEYWORDS = {"if", "elif", "while", "return", "assert", "raise", "yield", "await", "del", "except"}
_PRAGMAS = ("# noqa", "# type:", "# pragma:", "# fmt:")
_ASSIGNMENTS = {"=", "+=", "-=", "*=", "/=", "//=", "%=", "@=", "&=", "|=", "^=", ">>=", "<<="}
# From the loosest to the tightest: an expression is broken at the loosest of its operators.
_OPERATORS = (
    {"or"},
    {"and"},
    {"<", ">", "==", "!=", "<=", ">=", "in", "not", "is"},
    {"|"},
    {"^"},
    {"&"},
    {"<<", ">>"},
    {"+", "-"},
    {"*", "@", "/", "//", "%"},
    {"**"},
)
_BOOLEAN = {"and", "or"}


def layout(text: str, module: ast.Module | None = None) -> str:
    """Returns a Python module with its long and its broken statements laid out."""
    try:
        module = module or ast.parse(text)
    except (SyntaxError, ValueError, RecursionError):
        return text
    lines = text.split("\n")
    new_lines: list[str] = []
    done = 0
    for start, end in sorted(set(_spans(module, lines))):
        if start >= done and (start < end or len(lines[start]) > LINE_WIDTH):
            new_lines += lines[done:start]
            new_lines += lay_out_statement(lines[start : end + 1])
            done = end + 1
    return "\n".join([*new_lines, *lines[done:]])


def _spans(module: ast.Module, lines: Sequence[str]) -> Iterator[tuple[int, int]]:
    """Yields the first and last line of each statement or head of a compound one, from 0."""
    for node in _statements(module):
        for decorator in getattr(node, "decorator_list", ()):
            yield decorator.lineno - 1, decorator.end_lineno - 1
        if isinstance(node, (ast.stmt, ast.ExceptHandler)) and not isinstance(node, ast.Match):
            body = getattr(node, "body", None)
            end = _end_of_head(body[0], lines) if body else node.end_lineno
            if end is not None and end >= node.lineno:
                yield node.lineno - 1, end - 1


def _statements(module: ast.Module) -> Iterator[ast.AST]:
    """Yields statements and what holds some; expressions, of which there are far more, do not."""
    pending: list[ast.AST] = [module]
    while pending:
        node = pending.pop()
        yield node
        for name in ("body", "handlers", "orelse", "finalbody", "cases"):
            pending += getattr(node, name, ())


def _end_of_head(first: ast.stmt, lines: Sequence[str]) -> int | None:
    """Returns the last line of what stands before a body; None when both share a line."""
    decorators = getattr(first, "decorator_list", ())
    start = min(node.lineno for node in (first, *decorators))
    if not decorators and lines[start - 1][: first.col_offset].strip():
        return None
    end: int = start - 1
    # Comments and blank lines before the body are its own, decorators too.
    while lines[end - 1].lstrip()[:1] in {"", "#", "@"}:
        end -= 1
    return end


def lay_out_statement(lines: Sequence[str]) -> list[str]:
    """Returns the lines of one statement as they are to be."""
    code = lines[0].lstrip()
    indent = lines[0][: len(lines[0]) - len(code)]
    statement = read("\n".join([code, *lines[1:]]))
    if statement is None:
        return list(lines)
    laid, comment = _statement(statement.parts, indent), statement.comment
    if not comment or comment.startswith("# fmt: skip"):
        return list(lines) if comment else laid
    last = f"{laid[-1]}  {comment}"
    if len(last) > LINE_WIDTH and not comment.startswith(_PRAGMAS):
        return [indent + comment, *laid]
    return [*laid[:-1], last]


# ---------------------------------------------------------------- statements


def _statement(parts: Sequence[Part], indent: str) -> list[str]:
    words = [part.text if isinstance(part, Token) else "" for part in parts]
    if words[0] in {"from", "import"}:
        return _import(parts, indent)
    if "def" in words[:2]:
        return _definition(parts, indent)
    if words[0] == "for":
        start = words.index("in") + 1
        return _value(flat(parts[:start]) + " ", parts[start:-1], ":", indent)
    if words[0] in {"async", "with", "class"}:
        return _bracketed(parts, indent)
    if words[0] == "assert" and "," in words:
        return _assertion(parts, words.index(","), indent)
    if words[0] in _KEYWORDS:
        colon = len(words) - 1 if words[-1] == ":" else len(words)
        stop = words.index("from") if words[0] == "raise" and "from" in words else colon
        return _value(words[0] + " ", parts[1:stop], _tail(parts[stop:]), indent)
    assigned = [at for at, word in enumerate(words) if word in _ASSIGNMENTS]
    if assigned and "lambda" not in words[: assigned[-1]]:
        return _assignment(parts, words, assigned[-1], indent)
    return _value("", parts, "", indent)


def _assertion(parts: Sequence[Part], comma: int, indent: str) -> list[str]:
    """Lays out an assertion with a message, which is broken rather than the test."""
    head = f"assert {flat(parts[1:comma])}, "
    if len(indent + head) < LINE_WIDTH and can_be_flat(parts[:comma]):
        return _value(head, parts[comma + 1 :], "", indent)
    return _value("assert ", parts[1:comma], ", " + flat(parts[comma + 1 :]), indent)


def _tail(parts: Sequence[Part]) -> str:
    return (" " if parts and parts[0].spaced else "") + flat(parts)


def _import(parts: Sequence[Part], indent: str) -> list[str]:
    at = next(index for index, part in enumerate(parts) if is_word(part, "import"))
    head, names = flat(parts[: at + 1]), parts[at + 1 :]
    bracket = names[0] if isinstance(names[0], Bracket) else Bracket("(", tuple(names))
    line = f"{indent}{head} {flat(bracket.inside)}"
    if len(line) <= LINE_WIDTH and not bracket.comma:
        return [line]
    inner = [f"{indent}{_STEP}{flat(item)}," for item in items(bracket)]
    return [f"{indent}{head} (", *inner, f"{indent})"]


def _definition(parts: Sequence[Part], indent: str) -> list[str]:
    line = indent + flat(parts)
    if len(line) <= LINE_WIDTH and can_be_flat(parts):
        return [line]
    at = next(index for index, part in enumerate(parts) if isinstance(part, Bracket))
    parameters = parts[at]
    if not (isinstance(parameters, Bracket) and parameters.inside):
        return _bracketed(parts, indent)
    opening = f"{indent}{flat(parts[:at])}("
    together = f"{indent}{_STEP}{flat(parameters.inside)}"
    every = items(parameters)
    inner = [together]
    # The formatter gives a lone parameter a comma too.
    if len(every) == 1 or parameters.comma or len(together) > LINE_WIDTH:
        inner = [line for parameter in every for line in _inside(parameter, indent + _STEP, ",")]
    return [opening, *inner, *_bracketed(parts[at + 1 :], indent, ")" + " " * parts[at + 1].spaced)]


def _assignment(parts: Sequence[Part], words: Sequence[str], at: int, indent: str) -> list[str]:
    place, value = parts[:at], parts[at + 1 :]
    sign = f" {words[at]} "
    before = flat(place)
    is_short = len(indent + before + sign) < LINE_WIDTH
    is_empty = isinstance(value[0], Bracket) and not value[0].inside and len(value) == 1
    line = indent + before + sign + flat(value)
    # The formatter breaks a long annotation before the value.
    if ":" in words[:at] and (not is_short or (is_empty and len(line) > LINE_WIDTH)):
        colon = words.index(":")
        annotation = parts[colon + 1 : at]
        return _value(flat(parts[:colon]) + ": ", annotation, sign + flat(value), indent)
    if isinstance(place[0], Bracket) and place[0].stays_open and len(place) == 1:
        place, is_short, words = place[0].inside, False, (",",)
    if not is_short and "," in words[:at]:
        targets = _exploded(Bracket("(", tuple(place), comma=True), indent)
        return [f"{indent}(", *targets, *_value(")" + sign, value, "", indent)]
    return _value(before + sign, value, "", indent)


# ---------------------------------------------------------------- expressions


def _value(before: str, parts: Sequence[Part], after: str, indent: str) -> list[str]:
    """Lays out an expression that gets parentheses where it has no brackets to break at."""
    parts = _without_parentheses(parts)
    line = f"{indent}{before}{flat(parts)}{after}"
    if len(line) <= LINE_WIDTH and can_be_flat(parts):
        return [line]
    if any(is_word(part, ",") for part in parts):
        broken = _bracketed(parts, indent, before, after)
        if before == "return " and _has_content(parts[-1]) and _fit(broken):
            return broken
        inner = _exploded(Bracket("(", tuple(parts), comma=True), indent)
        return [f"{indent}{before}(", *inner, f"{indent}){after}"]
    if is_word(parts[0], "lambda"):
        return _lambda(before, parts, after, indent)
    broken = _bracketed(parts, indent, before, after)
    inner = _inside(parts, indent + _STEP)
    wrapped = [f"{indent}{before}(", *inner, f"{indent}){after}"]
    operators = _precedence(parts)
    if not operators:
        can_wrap = len(parts) > 0 and (_fit(inner) if len(inner) == 1 else bool(before))
        first_fits = len(broken) > 1 and len(broken[0]) <= LINE_WIDTH
        return wrapped if can_wrap and not first_fits and len(wrapped[0]) <= LINE_WIDTH else broken
    last = parts[-1]
    is_index = isinstance(last, Bracket) and last.trails and last.opening == "["
    is_open = (_has_content(last) and not is_index) or _has_content(parts[0])
    can_stay = operators == 1 and is_open and len(broken) > 1
    return broken if can_stay and _fit(broken) else wrapped


def _fit(lines: Sequence[str]) -> bool:
    return all(len(line) <= LINE_WIDTH for line in lines)


def _without_parentheses(parts: Sequence[Part]) -> Sequence[Part]:
    """Returns the parts inside needless parentheses."""
    if len(parts) == 1 and isinstance(parts[0], Bracket) and parts[0].opening == "(":
        bracket = parts[0]
        plain = not bracket.comma and not any(is_word(part, ",", "for") for part in bracket.inside)
        if bracket.inside and plain:
            return _without_parentheses(bracket.inside)
    return parts


def _has_content(part: Part) -> bool:
    return isinstance(part, Bracket) and bool(part.inside)


def _precedence(parts: Sequence[Part]) -> int:
    """Returns how many operators of the loosest kind an expression has."""
    if _choices(parts):
        return 2
    loosest = _loosest(parts)
    if loosest and is_word(parts[loosest[0]], *_BOOLEAN):
        return sum(is_word(part, *_BOOLEAN) for part in parts)
    return len(loosest)


def _choices(parts: Sequence[Part]) -> list[int]:
    """Positions of the words of a conditional expression."""
    if any(is_word(part, "lambda") for part in parts):
        return []
    positions = [at for at, part in enumerate(parts) if is_word(part, "if", "else")]
    return positions if any(is_word(parts[at], "else") for at in positions) else []


def _clauses(parts: Sequence[Part]) -> list[int]:
    """Positions at which the clauses of a comprehension begin."""
    loops = [at for at, part in enumerate(parts) if is_word(part, "for")]
    if not loops:
        return []
    starts = [at - 1 if at and is_word(parts[at - 1], "async") else at for at in loops]
    tests = [at for at, part in enumerate(parts) if at > loops[0] and is_word(part, "if")]
    return sorted([*starts, *tests])


def _adjacent_strings(parts: Sequence[Part]) -> list[int]:
    """Positions of strings that follow a string."""
    return [
        at
        for at in range(1, len(parts))
        if all(isinstance(part, Token) and part.is_string for part in parts[at - 1 : at + 1])
    ]


def _loosest(parts: Sequence[Part]) -> list[int]:
    """Positions of the loosest operators of an expression."""
    if any(is_word(part, "lambda") for part in parts):
        return []
    strings = _adjacent_strings(parts)
    binary = [
        at
        for at, part in enumerate(parts)
        if at and isinstance(part, Token) and not part.is_string and ends_operand(parts[at - 1])
    ]
    for number, level in enumerate(_OPERATORS):
        operators = [at for at in binary if is_word(parts[at], *level)]
        if strings and number == len(_BOOLEAN):
            return strings
        if operators:
            return operators
    return strings


def _inside(parts: Sequence[Part], indent: str, after: str = "", before: str = "") -> list[str]:
    """Lays out an expression that stands in brackets, on lines of its own."""
    line = f"{indent}{before}{flat(parts)}{after}"
    if len(line) <= LINE_WIDTH and can_be_flat(parts):
        return [line]
    function = next((at for at, part in enumerate(parts) if is_word(part, "lambda")), None)
    if function is not None:
        head = before + flat(parts[:function]) + " " * (function and parts[function].spaced)
        return _lambda(head, parts[function:], after, indent)
    clauses = _clauses(parts)
    if clauses:
        element, *between, last_clause = split_at(parts, clauses)
        clause_lines = _inside(element, indent, "", before)
        for clause in between:
            clause_lines += _clause(clause, indent, "")
        return [*clause_lines, *_clause(last_clause, indent, after)]
    colon = next((at for at, part in enumerate(parts) if is_word(part, ":")), None)
    if colon:
        *above, last = _bracketed(parts[: colon + 1], indent, before)
        return [*above, *_inside(parts[colon + 1 :], indent, after, last.strip() + " ")]
    cuts = _choices(parts) or _loosest(parts)
    if not cuts:
        return _bracketed(parts, indent, before, after)
    first, *others = split_at(parts, cuts)
    operands = [(before, first), *map(_operand, others)]
    lines = [line for word, operand in operands[:-1] for line in _inside(operand, indent, "", word)]
    word, operand = operands[-1]
    return [*lines, *_inside(operand, indent, after, word)]


def _operand(parts: tuple[Part, ...]) -> tuple[str, tuple[Part, ...]]:
    """Returns the operator at the beginning of parts, and its operand."""
    return ("", parts) if _is_string(parts[0]) else (flat(parts[:1]) + " ", parts[1:])


def _is_string(part: Part) -> bool:
    return isinstance(part, Token) and part.is_string


def _clause(parts: Sequence[Part], indent: str, after: str) -> list[str]:
    if is_word(parts[0], "if"):
        return _inside(parts[1:], indent, after, "if ")
    at = next(index for index, part in enumerate(parts) if is_word(part, "in"))
    return _inside(parts[at + 1 :], indent, after, flat(parts[: at + 1]) + " ")


def _lambda(before: str, parts: Sequence[Part], after: str, indent: str) -> list[str]:
    at = next(index for index, part in enumerate(parts) if is_word(part, ":"))
    head, body = f"{before}{flat(parts[: at + 1])} ", parts[at + 1 :]
    if _precedence(body) and len(indent + head + flat(body) + after) > LINE_WIDTH:
        return [f"{indent}{head}(", *_inside(body, indent + _STEP), f"{indent}){after}"]
    return _value(head, body, after, indent)


def _bracketed(parts: Sequence[Part], indent: str, before: str = "", after: str = "") -> list[str]:
    """Lays out parts whose brackets alone can be broken, from the left to the right."""
    line, lines = indent + before, []
    for at, part in enumerate(parts):
        space = " " if at and part.spaced else ""
        if not (isinstance(part, Bracket) and part.inside):
            line += space + flat([part])
            continue
        rest = parts[at + 1 :]
        stop = next(
            (index for index, next_part in enumerate(rest) if _has_content(next_part)), None
        )
        following = _tail(rest if stop is None else rest[:stop])
        following += after if stop is None else " " * rest[stop].spaced + "("
        whole = line + space + flat([part])
        if can_be_flat([part]) and len(whole + following) <= LINE_WIDTH:
            line = whole
        else:
            lines.append(line + space + part.opening)
            lines += _exploded(part, indent)
            line = indent + part.closing
    return [*lines, line + after]


def _exploded(bracket: Bracket, indent: str) -> list[str]:
    """Returns the lines between two brackets."""
    inner = indent + _STEP
    every = items(bracket)
    if len(every) == 1 and not bracket.comma:
        return _inside(bracket.inside, inner)
    together = f"{inner}{flat(bracket.inside)}"
    if bracket.trails and len(together) <= LINE_WIDTH and can_be_flat([bracket]):
        return [together]
    return [line for inner_part in every for line in _inside(inner_part, inner, ",")]
