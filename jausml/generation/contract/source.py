"""Classes of users' Python files, read from their syntax trees; nothing in them is run."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.generation.contract.syntax import flat

if TYPE_CHECKING:
    from collections.abc import Iterator

Function = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass(frozen=True)
class Definition:
    """A name defined in the body of a class.

    Attributes:
        line: Where, from 1.
        function: The function; None for an assignment (`on_x = helper`).
    """

    line: int
    function: Function | None


@dataclass(frozen=True)
class SourceClass:
    """A class of the file.

    Attributes:
        line: Where, from 1.
        ancestors: Names of the base classes, as they were called where they were imported from;
            with those of base classes in the same file.
    """

    name: str
    line: int
    methods: dict[str, Definition]
    ancestors: frozenset[str]


def read_classes(tree: ast.Module) -> dict[str, SourceClass]:
    """Returns the top-level classes of a Python file by name."""
    statements = list(flat(tree.body))
    aliases = {
        alias.asname: alias.name
        for statement in statements
        if isinstance(statement, ast.ImportFrom)
        for alias in statement.names
        if alias.asname
    }
    classes: dict[str, SourceClass] = {}
    for statement in statements:
        if isinstance(statement, ast.ClassDef):
            classes[statement.name] = _read_class(statement, aliases, classes)
    return classes


def _read_class(
    node: ast.ClassDef, aliases: dict[str, str], earlier: dict[str, SourceClass]
) -> SourceClass:
    bases = [name for name in map(_base_name, node.bases) if name]
    methods: dict[str, Definition] = {}
    ancestors = {aliases.get(name, name) for name in bases}
    for base in (earlier[name] for name in reversed(bases) if name in earlier):
        methods.update(base.methods)
        ancestors |= base.ancestors
    for statement in flat(node.body):
        methods.update(_definitions(statement))
    return SourceClass(node.name, node.lineno, methods, frozenset(ancestors))


def _base_name(node: ast.expr) -> str:
    if isinstance(node, ast.Subscript):
        return _base_name(node.value)
    if isinstance(node, ast.Attribute):
        return node.attr
    return node.id if isinstance(node, ast.Name) else ""


def _definitions(statement: ast.stmt) -> Iterator[tuple[str, Definition]]:
    if isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef)):
        yield statement.name, Definition(statement.lineno, statement)
    elif isinstance(statement, ast.Assign):
        for target in statement.targets:
            if isinstance(target, ast.Name):
                yield target.id, Definition(statement.lineno, None)
    elif isinstance(statement, ast.AnnAssign) and isinstance(statement.target, ast.Name):
        yield statement.target.id, Definition(statement.lineno, None)
