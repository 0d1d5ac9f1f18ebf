"""Classes and names of Python files, read from their syntax trees; nothing in them is run."""

from __future__ import annotations

import ast
import warnings
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from jausml.generation.artifact import Artifact, Kind

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

Function = ast.FunctionDef | ast.AsyncFunctionDef


class SourceProblem(Exception):  # noqa: N818 - a finding, not a failure of jausml
    """The file is not Python.

    Args:
        line: Where, from 1.
    """

    def __init__(self, message: str, line: int) -> None:
        super().__init__(message)
        self.line = line


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


@dataclass(frozen=True)
class SourceImport:
    """An import of names from a module, `from module import name`.

    Attributes:
        line: Where, from 1.
    """

    module: str
    names: tuple[str, ...]
    line: int


def read_imports(data: bytes) -> list[SourceImport]:
    """Returns what a Python file imports by name; relative imports are left out.

    Args:
        data: The file's bytes, in any encoding that it declares.
    """
    return [
        SourceImport(node.module, tuple(alias.name for alias in node.names), node.lineno)
        for node in ast.walk(_tree(data))
        if isinstance(node, ast.ImportFrom) and node.module and not node.level
    ]


def read_classes(data: bytes) -> dict[str, SourceClass]:
    """Returns the top-level classes of a Python file by name.

    Args:
        data: The file's bytes, in any encoding that it declares.
    """
    statements = list(_flat(_tree(data).body))
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


def _tree(data: bytes) -> ast.Module:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # an invalid escape of the user is not our subject
            return ast.parse(data)
    except SyntaxError as error:
        raise SourceProblem(f"syntax error: {error.msg}", error.lineno or 1) from error
    except (ValueError, RecursionError, MemoryError) as error:
        raise SourceProblem(f"cannot be parsed: {error}", 1) from error


def _read_class(
    node: ast.ClassDef, aliases: dict[str, str], earlier: dict[str, SourceClass]
) -> SourceClass:
    bases = [name for name in map(_base_name, node.bases) if name]
    methods: dict[str, Definition] = {}
    ancestors = {aliases.get(name, name) for name in bases}
    for base in (earlier[name] for name in reversed(bases) if name in earlier):
        methods.update(base.methods)
        ancestors |= base.ancestors
    for statement in _flat(node.body):
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


def _flat(body: Iterable[ast.stmt]) -> Iterator[ast.stmt]:
    """Yields statements in order, those inside `if`, `try` and `with` too."""
    for statement in body:
        yield statement
        if isinstance(statement, (ast.If, ast.Try, ast.With)):
            for block in ("body", "handlers", "orelse", "finalbody"):
                for part in getattr(statement, block, ()):
                    yield from _flat(part.body if isinstance(part, ast.ExceptHandler) else [part])


_FEWEST_PARTS = 3  # package folder, package, module


class GeneratedNames:
    """The modules of generated packages, and the names that packages export."""

    def __init__(self, artifacts: Iterable[Artifact]) -> None:
        python = [each for each in artifacts if each.path.endswith(".py")]
        self._modules = {module: each for each in python if (module := module_of(each.path))}
        self._packages = {
            module.partition(".")[0]
            for module, each in self._modules.items()
            if each.kind is Kind.GENERATED
        }

    def missing(self, found: SourceImport) -> str:
        """Says what became of the module that a user's file imports from, or nothing."""
        package = found.module.partition(".")[0]
        if package not in self._packages:
            return ""
        message = f"there is no module {found.module} any more"
        if found.module in self._modules:
            missing = self._missing(found)
            if not missing:
                return ""
            message = f"{found.module} has no {' and no '.join(missing)} any more"
        exported = exports(self._modules[package].text) if package in self._modules else frozenset()
        if exported.issuperset(found.names):
            message += f"; write `from {package} import {', '.join(found.names)}`"
        return message

    def _missing(self, found: SourceImport) -> list[str]:
        module = self._modules[found.module]
        if module.kind is not Kind.GENERATED:
            return []  # the user's own file
        known = bound(module.text)
        if "*" in known | {*found.names}:
            return []
        inside = {each.rpartition(".") for each in self._modules}
        return [
            name
            for name in found.names
            if name not in known and (found.module, ".", name) not in inside
        ]


def module_of(path: str) -> str:
    """Returns the dotted name of a module, or nothing for what is outside of a package.

    Args:
        path: Path of the file in the workspace, e.g. `vehicle/vehicle/main.py`.
    """
    parts = PurePosixPath(path).with_suffix("").parts
    if len(parts) < _FEWEST_PARTS or parts[0] != parts[1]:
        return ""
    return ".".join(parts[1:]).removesuffix(".__init__")


def bound(text: str) -> frozenset[str]:
    """Returns the names that a module binds, with `*` for those of an import of everything."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            names.add(node.name)
        elif isinstance(node, (ast.Import, ast.ImportFrom)):
            names |= {alias.asname or alias.name for alias in node.names}
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.add(node.id)
    return frozenset(names)


def exports(text: str) -> frozenset[str]:
    """Returns the names in `__all__` of a module."""
    for node in ast.parse(text).body:
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__":
            values = node.value.elts if isinstance(node.value, (ast.List, ast.Tuple)) else ()
            return frozenset(str(each.value) for each in values if isinstance(each, ast.Constant))
    return frozenset()
