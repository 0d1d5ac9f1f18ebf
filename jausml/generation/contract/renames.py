"""Which names of the generated modules are gone since the last run, and their successors."""

from __future__ import annotations

import ast
import copy
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from jausml.generation.contract.interface import Interface
from jausml.generation.contract.symbols import Class, Module, Modules, Symbol, Value, is_enumeration

_Symbols = Mapping[str, Symbol | None]
"""The symbols of a module or a class, by name."""


def former_names(before: Interface, after: Interface, remembered: object = None) -> dict[str, str]:
    """Returns the names that an interface had and has no more, with what each is called now.

    What has the same code, number or bytes on the wire is the same; a name that only resembles
    another one is none. Names are dotted, those inside a renamed class by its present name; the
    successor is the last part alone, and empty for a name that was removed.

    Args:
        remembered: Renames of earlier runs, from the manifest, which anybody may have edited.
    """
    finder = _RenameFinder(before.modules, after.modules)
    new = dict(finder.of_modules(after.changed_modules(before)))
    earlier = {
        _in_present_classes(name, new): successor
        for name, successor in (remembered.items() if isinstance(remembered, dict) else ())
        if isinstance(name, str) and isinstance(successor, str)
    }
    # A name that was renamed before leads on to the present one.
    followed = {
        name: new.get(f"{name.rpartition('.')[0]}.{successor}", successor)
        for name, successor in {**earlier, **new}.items()
    }
    return {
        name: successor for name, successor in followed.items() if not _has(after.modules, name)
    }


def _in_present_classes(name: str, renames: Mapping[str, str]) -> str:
    """Returns a dotted name with the classes around it as they are called now."""
    parts = name.split(".")
    # The outermost first, since renames name a class inside another by the present name of that.
    for count in range(1, len(parts) - 1):
        parts[count] = renames.get(".".join(parts[: count + 1])) or parts[count]
    return ".".join(parts)


def _has(modules: Modules, dotted: str) -> bool:
    """Tells whether a name exists inside a module, or inside a class of it."""
    parts = dotted.split(".")
    # The longest beginning that is a module; the rest lies inside it.
    for count in range(len(parts) - 1, 0, -1):
        symbol: object = modules.find(".".join(parts[:count]))
        if isinstance(symbol, Module):
            for name in parts[count:]:
                if isinstance(symbol, Module):
                    symbol = modules.member(symbol, name)
                elif isinstance(symbol, Class):
                    symbol = modules.members(symbol).get(name)
                else:
                    return False
            return symbol is not None
    return False


class _RenameFinder:
    """Compares modules before and after a run.

    Yields pairs: each dotted name that is gone, and its successor or an empty one.
    """

    def __init__(self, old: Modules, new: Modules) -> None:
        self._old, self._new = old, new

    def of_modules(self, names: Iterable[str]) -> Iterator[tuple[str, str]]:
        """Yields the names of modules, and of the classes in them."""
        for name in names:
            old_module, new_module = self._old.find(name), self._new.find(name)
            if isinstance(old_module, Module) and isinstance(new_module, Module):
                yield from self._of_module(old_module, new_module)

    def _of_module(self, old_module: Module, new_module: Module) -> Iterator[tuple[str, str]]:
        before = {name: self._old.member(old_module, name) for name in self._old.names(old_module)}
        after = {name: self._new.member(new_module, name) for name in self._new.names(new_module)}
        offered = self._old.offered(old_module)
        removed = {
            name: symbol
            for name, symbol in _public_without(before, after).items()
            if name in offered
        }
        successors = _paired(removed, _public_without(after, before), _identity)
        yield from ((f"{old_module.name}.{name}", successors.get(name, "")) for name in removed)
        own = {
            name: symbol
            for name, symbol in before.items()
            if isinstance(symbol, Class) and symbol.module is old_module
        }
        yield from self._of_classes(own, after, successors)

    def _of_classes(
        self, before: _Symbols, after: _Symbols, successors: Mapping[str, str]
    ) -> Iterator[tuple[str, str]]:
        for name, old_class in before.items():
            new_class = after.get(successors.get(name, name))
            if isinstance(old_class, Class) and isinstance(new_class, Class):
                yield from self._of_class(old_class, new_class)

    def _of_class(self, old_class: Class, new_class: Class) -> Iterator[tuple[str, str]]:
        # Most classes stay as they are, and need no comparison.
        if ast.dump(old_class.node) == ast.dump(new_class.node):
            return
        before, after = self._old.members(old_class), self._new.members(new_class)
        removed, added = _public_without(before, after), _public_without(after, before)
        is_enum = is_enumeration(self._old, old_class)
        successors = _paired(removed, added, _enumerator_value if is_enum else _identity)
        if not is_enum:
            old_fields = [name for name, symbol in removed.items() if isinstance(symbol, Value)]
            new_fields = [name for name, symbol in added.items() if isinstance(symbol, Value)]
            successors |= _renamed_fields(old_class, new_class, old_fields, new_fields, successors)
        place = f"{new_class.module.name}.{new_class.name}"
        yield from ((f"{place}.{name}", successors.get(name, "")) for name in removed)
        yield from self._of_classes(before, after, successors)


def _renamed_fields(
    old_class: Class,
    new_class: Class,
    old_fields: Sequence[str],
    new_fields: Sequence[str],
    renamed_classes: Mapping[str, str],
) -> dict[str, str]:
    """Returns the new names of fields, if nothing but names differs between two classes."""
    if len(old_fields) != len(new_fields):
        return {}
    fields = dict(zip(old_fields, new_fields, strict=True))
    text = _normalized_code(old_class.node)
    for old_name, new_name in {**renamed_classes, **fields}.items():
        text = re.sub(rf"\b{old_name}\b", new_name, text)
    return fields if text == _normalized_code(new_class.node) else {}


def _public_without(symbols: _Symbols, excluded: _Symbols) -> _Symbols:
    """Returns the symbols with a public name that others lack."""
    return {
        name: symbol
        for name, symbol in symbols.items()
        if name not in excluded and not name.startswith("_")
    }


def _paired(
    removed: _Symbols, added: _Symbols, identity: Callable[[Symbol | None], str]
) -> dict[str, str]:
    """Returns the new name of each old one, where exactly one of each state has the identity."""
    old_names, new_names = _by_unique(identity, removed), _by_unique(identity, added)
    return {name: new_names[key] for key, name in old_names.items() if key in new_names}


def _by_unique(identity: Callable[[Symbol | None], str], symbols: _Symbols) -> dict[str, str]:
    """Returns names by their identities, without those that several share or that are not known."""
    identities = {name: identity(symbol) for name, symbol in symbols.items()}
    counts = Counter(identities.values())
    return {key: name for name, key in identities.items() if key and counts[key] == 1}


def _identity(symbol: Symbol | None) -> str:
    """Returns the identity of a class, which outlasts a new name; empty for other symbols."""
    if not isinstance(symbol, Class):
        return ""
    for statement in symbol.node.body:
        if (
            isinstance(statement, ast.AnnAssign)
            and ast.unparse(statement.target) == "CODE"
            and statement.value
        ):
            # A module may import messages of several packages, and of these two may have one code.
            package = symbol.module.name.partition(".")[0]
            return f"{package}: {ast.unparse(statement.value)}"
    return _normalized_code(symbol.node)


def _enumerator_value(symbol: Symbol | None) -> str:
    value = symbol.value if isinstance(symbol, Value) else None
    return ast.unparse(value) if value is not None else ""


def _normalized_code(node: ast.ClassDef) -> str:
    """Returns the code of a class without its name and its documentation."""
    # The tree is that of the module, which others read too.
    text = ast.unparse(_WithoutDocstrings().visit(copy.deepcopy(node)))
    return re.sub(rf"\b{node.name}\b", "_", text)


class _WithoutDocstrings(ast.NodeTransformer):
    """Puts `pass` for each statement that is a constant: documentation, and `...` as well."""

    def visit_Expr(self, node: ast.Expr) -> ast.AST | None:
        return ast.Pass() if isinstance(node.value, ast.Constant) else node
