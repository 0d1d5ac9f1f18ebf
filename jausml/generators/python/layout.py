"""Python statements laid out as ruff's formatter lays them out.

Templates write what fits on a line by themselves; a statement whose length depends on names of the
model goes through here, so that generated files need no formatter.
"""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.generation.literals import LINE_WIDTH, python_string

if TYPE_CHECKING:
    from collections.abc import Sequence

_INDENT = "    "
_LAMBDA = "lambda: "


@dataclass(frozen=True)
class Call:
    """A call whose arguments may be calls.

    Attributes:
        function: What is called, as Python text.
        arguments: The arguments, as Python text or calls.
    """

    function: str
    arguments: tuple[str | Call, ...]

    def __str__(self) -> str:
        return f"{self.function}({', '.join(map(str, self.arguments))})"


Expression = str | Call


def statement(expression: Expression, before: str = "", column: int = 0, after: str = "") -> str:
    """Returns a statement around one expression.

    Args:
        expression: A call, or an expression without brackets that ruff could split.
        before: Text before the expression, e.g. `value = `.
        column: Column at which the statement will stand; the lines themselves begin at 0.
        after: Text after the expression, e.g. ` << 3`.
    """
    line = f"{before}{expression}{after}"
    if len(line) + column <= LINE_WIDTH or not (before or isinstance(expression, Call)):
        return line
    if isinstance(expression, Call) and not after:
        opening = len(before) + len(expression.function) + 1
        if opening + column <= LINE_WIDTH or not before:
            return "\n".join(_split(expression, before, column, ""))
    lines = [f"{expression}{after}"]
    if isinstance(expression, Call) and len(lines[0]) + column + len(_INDENT) > LINE_WIDTH:
        lines = statement(expression, "", column + len(_INDENT)).split("\n")
        lines += [after.strip()] if after else []
    return "\n".join([f"{before}(", *(_INDENT + text for text in lines), ")"])


def annotated(name: str, annotation: str, value: Expression, column: int = 0) -> str:
    """Returns an assignment with a type.

    Args:
        name: The name.
        annotation: The type, as Python text.
        value: The value.
        column: Column at which the statement will stand; the lines themselves begin at 0.
    """
    before = f"{name}: {annotation} = "
    room = LINE_WIDTH - column - len(before)
    if len(str(value)) <= room or (isinstance(value, Call) and room > 0):
        return statement(value, before, column)
    if value != "[]" and room > 0:
        return f"{before}(\n{_INDENT}{value}\n)"
    if annotation.startswith("list[") and annotation.endswith("]"):
        return f"{name}: list[\n{_INDENT}{annotation[5:-1]}\n] = {value}"
    return f"{name}: (\n{_INDENT}{annotation}\n) = {value}"


def comprehension(
    name: str, element: Expression, source: str, column: int = 0, item: str = "item"
) -> str:
    """Returns an assignment of a list of one expression for each item of a source.

    Args:
        name: The name.
        element: The expression.
        source: What is iterated over, as Python text.
        column: Column at which the statement will stand; the lines themselves begin at 0.
        item: Name of the item in the expression.
    """
    inner = f"{element} for {item} in {source}"
    if len(name) + len(inner) + 5 + column <= LINE_WIDTH:
        return f"{name} = [{inner}]"
    lines = [inner]
    if len(inner) + column + len(_INDENT) > LINE_WIDTH:
        first = statement(element, "", column + len(_INDENT))
        lines = [*first.split("\n"), f"for {item} in {source}"]
    return "\n".join([f"{name} = [", *(_INDENT + text for text in lines), "]"])


def collection(
    before: str, opening: str, items: Sequence[str], closing: str, column: int = 0
) -> str:
    """Returns a statement that ends with a dictionary, tuple or list of some items.

    Args:
        before: Text before the opening bracket.
        opening: The opening bracket.
        items: The items, as Python text.
        closing: The closing bracket.
        column: Column at which the statement will stand; the lines themselves begin at 0.
    """
    lone = "," if opening == "(" and len(items) == 1 else ""
    line = f"{before}{opening}{', '.join(items)}{lone}{closing}"
    if len(line) + column <= LINE_WIDTH:
        return line
    return "\n".join([f"{before}{opening}", *(f"{_INDENT}{item}," for item in items), closing])


def text(value: str, before: str, after: str, column: int = 0) -> str:
    """Returns a string in a statement or argument, in pieces when it is long.

    Args:
        value: The string.
        before: Text before it, e.g. `description=`.
        after: Text after it, e.g. a comma.
        column: Column at which it will stand; the lines themselves begin at 0.
    """
    line = f"{before}{python_string(value)}{after}"
    if len(line) + column <= LINE_WIDTH:
        return line
    # Room for the quotes and for characters that become escapes.
    width = (LINE_WIDTH - column - 8) // 2 if not value.isascii() else LINE_WIDTH - column - 16
    pieces = [value]
    if len(python_string(value)) + len(_INDENT) + column > LINE_WIDTH:
        pieces = textwrap.wrap(value, width, drop_whitespace=False, break_on_hyphens=False)
    return "\n".join([f"{before}(", *(_INDENT + python_string(p) for p in pieces), f"){after}"])


def hexadecimal(name: str, data: bytes, column: int = 0) -> str:
    """Returns a tuple of a name and the digits of some bytes, in lines when they are many.

    Args:
        name: The name.
        data: The bytes.
        column: Column at which it will stand; the lines themselves begin at 0.
    """
    line = f'("{name}", "{data.hex()}"),'
    if len(line) + column <= LINE_WIDTH:
        return line
    digits = textwrap.wrap(data.hex(" ", -4), LINE_WIDTH - column - len(_INDENT))
    return "\n".join(
        ["(", *(_INDENT + text for text in (f'"{name}",', '"""', *digits, '""",')), "),"]
    )


def call(function: str, arguments: Sequence[Expression]) -> Call:
    """Returns a call, for templates.

    Args:
        function: What is called.
        arguments: The arguments.
    """
    return Call(function, tuple(arguments))


def unpacking(targets: Sequence[str], value: str, column: int = 0) -> str:
    """Returns an assignment of the items of a tuple to names.

    Args:
        targets: The names.
        value: The tuple, as Python text.
        column: Column at which the statement will stand; the lines themselves begin at 0.
    """
    flat = f"({targets[0]},)" if len(targets) == 1 else ", ".join(targets)
    line = f"{flat} = {value}"
    if len(line) + column <= LINE_WIDTH:
        return line
    return "\n".join(["(", *(f"{_INDENT}{name}," for name in targets), f") = {value}"])


def union(name: str, options: Sequence[str], column: int = 0) -> str:
    """Returns an assignment of a union of types to a name.

    Args:
        name: The name.
        options: The types.
        column: Column at which the statement will stand; the lines themselves begin at 0.
    """
    line = f"{name} = {' | '.join(options)}"
    if len(line) + column <= LINE_WIDTH:
        return line
    inner = f"{_INDENT}{' | '.join(options)}"
    first, *others = options
    lines = [f"{_INDENT}{first}", *(f"{_INDENT}| {option}" for option in others)]
    if len(inner) + column <= LINE_WIDTH:
        lines = [inner]
    return "\n".join([f"{name} = (", *lines, ")"])


def signature(
    head: str, parameters: Sequence[str], result: str, column: int = 0, comment: str = ""
) -> str:
    """Returns the first line or lines of a function.

    Args:
        head: Text up to the bracket, e.g. `def read_from`.
        parameters: The parameters.
        result: The type of the result.
        column: Column at which the function will stand; the lines themselves begin at 0.
        comment: A `# noqa` for the linter, which does not count for the line's length.
    """
    line = f"{head}({', '.join(parameters)}) -> {result}:"
    remark = f"  {comment}" if comment else ""
    if len(line) + column <= LINE_WIDTH:
        return line + remark
    lines = [f"{_INDENT}{', '.join(parameters)}"]
    # The formatter gives a lone parameter a comma too.
    if len(parameters) == 1 or len(lines[0]) + column > LINE_WIDTH:
        lines = [f"{_INDENT}{parameter}," for parameter in parameters]
    return "\n".join([f"{head}({remark}", *lines, f") -> {result}:"])


def _split(expression: Call, before: str, column: int, after: str) -> list[str]:
    """Returns the lines of a call that does not fit on one."""
    inner = column + len(_INDENT)
    opening, closing = f"{before}{expression.function}(", f"){after}"
    together = ", ".join(map(str, expression.arguments))
    if len(together) + inner <= LINE_WIDTH:
        return [opening, f"{_INDENT}{together}", closing]
    lines = [opening]
    for argument in expression.arguments:
        text = f"{argument},"
        if isinstance(argument, Call) and len(text) + inner > LINE_WIDTH:
            lines += [_INDENT + line for line in _split(argument, "", inner, ",")]
        elif isinstance(argument, str) and _LAMBDA in argument and len(text) + inner > LINE_WIDTH:
            head, body = argument.split(_LAMBDA)
            lines += [f"{_INDENT}{head}{_LAMBDA}(", f"{_INDENT * 2}{body}", f"{_INDENT}),"]
        else:
            lines.append(_INDENT + text)
    return [*lines, closing]
