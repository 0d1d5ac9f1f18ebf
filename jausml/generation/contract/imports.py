"""Imports of the generated interface that find nothing, and their cures."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from jausml.generation.contract.finding import Edit, File, name_edit, removal
from jausml.generation.contract.scopes import Scope, own_nodes
from jausml.generation.contract.symbols import Module
from jausml.generation.contract.syntax import absolute
from jausml.generation.contract.types import Names, Types
from jausml.language.model.values import nearest


@dataclass(frozen=True)
class Lost:
    """An import without a target (`edits`: those that make it fit for certain)."""

    node: ast.stmt | ast.alias
    message: str
    edits: tuple[Edit, ...] = ()


@dataclass(frozen=True)
class Surroundings:
    """The surroundings of a file that is checked.

    Attributes:
        former: The names that generated modules had, with what they are now, or nothing.
        derived: Names of classes from which files of the user derive.
        imported: Pairs of a module and a name that files of the user import.
        uncalled: Methods of the file that nothing calls, which is told already.
    """

    types: Types
    former: Mapping[str, str]
    derived: frozenset[str] = frozenset()
    imported: frozenset[tuple[str, str]] = frozenset()
    uncalled: frozenset[str] = frozenset()


class Imports:
    """The imports of a file of the user."""

    def __init__(self, file: File, names: Names, around: Surroundings) -> None:
        self._file = file
        self._names = names
        self._around = around
        self._module = file.module
        self._modules = around.types.modules

    def of_modules(self, node: ast.Import) -> Iterator[Lost]:
        """Yields the modules of `import a.b` that do not exist."""
        for alias in node.names:
            parts = alias.name.split(".")
            names = [".".join(parts[: count + 1]) for count in range(len(parts))]
            gone = next((name for name in names if self._modules.find(name) is None), "")
            if gone:
                yield Lost(alias, f"there is no module {gone} any more")

    def of_names(self, node: ast.ImportFrom, scope: Scope) -> Iterator[Lost]:
        """Yields the names of `from a import b` that do not exist."""
        source = absolute(node, self._module.name, is_package=self._module.is_package)
        module = self._modules.find(source) if source else self._module
        if module is None:
            yield self._without_module(node, source)
        elif isinstance(module, Module) and module.is_generated:
            gone = [
                name
                for name in node.names
                if name.name != "*" and self._modules.member(module, name.name) is None
            ]
            unused = [lost_alias for lost_alias in gone if self._is_unused(lost_alias)]
            cut = self._without(node, unused)
            for alias in gone:
                yield self._without_name(module, alias, scope, cut if alias in unused else ())

    def _without_module(self, node: ast.ImportFrom, source: str) -> Lost:
        elsewhere = self._elsewhere(node.names, source)
        message = f"there is no module {source} any more{elsewhere}"
        is_unused = not elsewhere and all(self._is_unused(alias) for alias in node.names)
        edits = self._without(node, node.names) if is_unused else ()
        return Lost(node, message + _unused(edits), edits)

    def _without_name(
        self, module: Module, alias: ast.alias, scope: Scope, cut: tuple[Edit, ...]
    ) -> Lost:
        message = f"{module.name} has no {alias.name} any more"
        successor = self._around.former.get(f"{module.name}.{alias.name}", "")
        if successor:
            message += f"; it is {successor} now"
            return Lost(alias, message, self._renamed(alias, scope, successor))
        names = self._modules.names(module)
        elsewhere = self._elsewhere([alias], module.name)
        if elsewhere:
            return Lost(alias, message + elsewhere)
        return Lost(alias, message + (_unused(cut) or alike(alias.name, names)), cut)

    def _elsewhere(self, aliases: Sequence[ast.alias], source: str) -> str:
        """Returns a remark that the package itself has the names that an inner module has lost."""
        package = source.partition(".")[0]
        face = self._modules.find(package)
        if package == source or not isinstance(face, Module):
            return ""
        names = [alias.name for alias in aliases]
        is_there = self._modules.offered(face).issuperset(names)
        return f"; write `from {package} import {', '.join(names)}`" if is_there else ""

    def _is_unused(self, alias: ast.alias) -> bool:
        name = alias.asname or alias.name
        is_given = self._module.is_package or (self._module.name, name) in self._around.imported
        return not is_given and name not in self._file.names | self._file.words

    def _without(self, node: ast.ImportFrom, unused: Sequence[ast.alias]) -> tuple[Edit, ...]:
        is_alone = self._file.is_alone(node)
        return removal(self._file.lines, node, unused, is_alone=is_alone)

    def _renamed(self, alias: ast.alias, scope: Scope, successor: str) -> tuple[Edit, ...]:
        """Returns the edits for a name that is imported: there, and where it is used."""
        name = alias.name
        edit = name_edit(alias.lineno, alias.col_offset, name, successor)
        if alias.asname:
            return (edit,)
        is_taken = any(successor in namespace.bindings for namespace in self._names.scopes.values())
        is_given = self._module.is_package or (self._module.name, name) in self._around.imported
        is_single = len(scope.bindings.get(name, ())) == 1
        # Where the new name may clash or the old one is used out of sight, `as` keeps the old one.
        if is_taken or is_given or not is_single or name in self._file.words:
            kept = f"{successor} as {name}"
            return (name_edit(alias.lineno, alias.col_offset, name, kept),)
        return (edit, *self._uses(name, scope, successor))

    def _uses(self, name: str, scope: Scope, successor: str) -> Iterator[Edit]:
        for namespace in self._names.scopes.values():
            definition = namespace.find(name)
            for node in own_nodes(namespace.node) if definition and definition[0] is scope else ():
                if isinstance(node, ast.Name) and node.id == name:
                    yield name_edit(node.lineno, node.col_offset, name, successor)


def alike(name: str, names: Iterable[str]) -> str:
    """Returns a question whether a similar name is meant; empty where there is none."""
    likely = [candidate for candidate in names if candidate[:1].isupper() == name[:1].isupper()]
    nearest_name = nearest(name, likely)
    return f"; is it {nearest_name} now?" if nearest_name else ""


def _unused(cut: tuple[Edit, ...]) -> str:
    return "; nothing uses it, take it out" if cut else ""
