"""Modules that generated packages offer to users' files, and imports that they no longer serve."""

from __future__ import annotations

import ast
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from jausml.generation.artifact import Artifact, Kind

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.generation.source import SourceImport

_FEWEST_PARTS = 3  # package folder, package, module


class Offers:
    """The modules of generated packages, and the names that packages export."""

    def __init__(self, artifacts: Iterable[Artifact]) -> None:
        python = [each for each in artifacts if each.path.endswith(".py")]
        self._modules = {module: each for each in python if (module := module_of(each.path))}
        self._packages = {
            module.partition(".")[0]
            for module, each in self._modules.items()
            if each.kind is Kind.GENERATED
        }

    def lost(self, found: SourceImport) -> str:
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
