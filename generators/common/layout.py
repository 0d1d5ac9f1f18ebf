"""Python statements laid out as ruff's formatter lays them out.

Templates write what fits on a line by themselves; a statement whose length depends on names of the
model goes through here, so that generated files need no formatter.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

LINE_WIDTH = 100
_INDENT = "    "


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


def statement(expression: Expression, before: str = "", indent: int = 0, after: str = "") -> str:
    """Returns a statement around one expression.

    Args:
        expression: A call, or an expression without brackets that ruff could split.
        before: Text before the expression, e.g. `value = `.
        indent: Columns before the statement; the first line is not indented here.
        after: Text after the expression, e.g. ` << 3`.
    """
    line = f"{before}{expression}{after}"
    if len(line) + indent <= LINE_WIDTH or not (before or isinstance(expression, Call)):
        return line
    if isinstance(expression, Call) and not after:
        return "\n".join(_split(expression, before, indent, ""))
    inner = f"{expression}{after}"
    if isinstance(expression, Call) and len(inner) + indent + len(_INDENT) > LINE_WIDTH:
        split = _split(expression, "", indent + len(_INDENT), "")
        lines = [*split, f"{' ' * (indent + len(_INDENT))}{after.strip()}"]
        inner = "\n".join(lines)
    margin = " " * indent
    return f"{before}(\n{margin}{_INDENT}{inner}\n{margin})"


def call(function: str, arguments: Sequence[Expression]) -> Call:
    """Returns a call, for templates.

    Args:
        function: What is called.
        arguments: The arguments.
    """
    return Call(function, tuple(arguments))


def unpacking(targets: Sequence[str], value: str, indent: int = 0) -> str:
    """Returns an assignment of the items of a tuple to names.

    Args:
        targets: The names.
        value: The tuple, as Python text.
        indent: Columns before the statement; the first line is not indented here.
    """
    flat = f"({targets[0]},)" if len(targets) == 1 else ", ".join(targets)
    line = f"{flat} = {value}"
    if len(line) + indent <= LINE_WIDTH:
        return line
    margin = " " * indent
    return "\n".join(
        ["(", *(f"{margin}{_INDENT}{name}," for name in targets), f"{margin}) = {value}"]
    )


def union(name: str, options: Sequence[str], indent: int = 0) -> str:
    """Returns an assignment of a union of types to a name.

    Args:
        name: The name.
        options: The types.
        indent: Columns before the statement; the first line is not indented here.
    """
    line = f"{name} = {' | '.join(options)}"
    if len(line) + indent <= LINE_WIDTH:
        return line
    margin = " " * indent
    first, *others = options
    lines = [f"{_INDENT}{first}", *(f"{_INDENT}| {option}" for option in others)]
    return "\n".join([f"{name} = (", *(margin + text for text in lines), f"{margin})"])


def signature(head: str, parameters: Sequence[str], result: str, indent: int = 0) -> str:
    """Returns the first line or lines of a function.

    Args:
        head: Text up to the bracket, e.g. `def read_from`.
        parameters: The parameters.
        result: The type of the result.
        indent: Columns before the function; the first line is not indented here.
    """
    line = f"{head}({', '.join(parameters)}) -> {result}:"
    if len(line) + indent <= LINE_WIDTH:
        return line
    margin = " " * indent
    middle = f"{margin}{_INDENT}{', '.join(parameters)}"
    lines = [middle]
    if len(middle) > LINE_WIDTH:
        lines = [f"{margin}{_INDENT}{parameter}," for parameter in parameters]
    return "\n".join([f"{head}(", *lines, f"{margin}) -> {result}:"])


def _split(expression: Call, before: str, indent: int, after: str) -> list[str]:
    """Returns the lines of a call that does not fit on one; the first is not indented."""
    margin = " " * indent
    inner = indent + len(_INDENT)
    opening, closing = f"{before}{expression.function}(", f"{margin}){after}"
    together = ", ".join(map(str, expression.arguments))
    if len(together) + inner <= LINE_WIDTH:
        return [opening, f"{margin}{_INDENT}{together}", closing]
    lines = [opening]
    for argument in expression.arguments:
        text = f"{argument},"
        if isinstance(argument, Call) and len(text) + inner > LINE_WIDTH:
            first, *others = _split(argument, "", inner, ",")
            lines += [margin + _INDENT + first, *others]
        else:
            lines.append(margin + _INDENT + text)
    return [*lines, closing]
