"""Syntax trees of Python, and questions to them."""

from __future__ import annotations

import ast
import warnings
from collections.abc import Iterable, Iterator


class SourceProblem(Exception):  # noqa: N818 - a finding, not a failure of jausml
    """The file is not Python."""

    def __init__(self, message: str, line: int) -> None:
        super().__init__(message)
        self.line = line


def tree_of(text: str | bytes) -> ast.Module:
    """Returns the syntax tree of a file; raises SourceProblem where it is not Python."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # an invalid escape of the user is not our subject
            return ast.parse(text)
    except SyntaxError as error:
        raise SourceProblem(f"syntax error: {error.msg}", error.lineno or 1) from error
    except (ValueError, RecursionError, MemoryError) as error:
        raise SourceProblem(f"cannot be parsed: {error}", 1) from error


def flat(body: Iterable[ast.stmt]) -> Iterator[ast.stmt]:
    """Yields statements in order, those inside `if`, `try` and `with` too."""
    for statement in body:
        yield statement
        if isinstance(statement, (ast.If, ast.Try, ast.With)):
            for block in ("body", "handlers", "orelse", "finalbody"):
                for part in getattr(statement, block, ()):
                    yield from flat(part.body if isinstance(part, ast.ExceptHandler) else [part])


def absolute(node: ast.ImportFrom, module: str, *, is_package: bool) -> str:
    """Returns the dotted name of the module that an import names; empty when there is none."""
    if not node.level:
        return node.module or ""
    parts = module.split(".")
    kept = len(parts) - node.level + is_package
    if not module or kept < 1:
        return ""
    return ".".join((*parts[:kept], *([node.module] if node.module else [])))


def last_name(node: ast.expr) -> str:
    """Returns the last part of a dotted name, called or with parameters; empty for no name."""
    if isinstance(node, ast.Call):
        node = node.func
    if isinstance(node, ast.Subscript):
        node = node.value
    if isinstance(node, ast.Attribute):
        return node.attr
    return node.id if isinstance(node, ast.Name) else ""


def is_decorated_by(decorator: ast.expr, *names: str) -> bool:
    """Tells whether a decorator, called or not, has one of some names."""
    return last_name(decorator) in names
