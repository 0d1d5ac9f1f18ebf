"""What became of names of the generated interface from one state of it to another."""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from jausml.generation.contract.symbols import Class, Module, Modules, Symbol, Value, is_enumeration

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping


def renames(old: Modules, new: Modules, names: Iterable[str]) -> dict[str, str]:
    """Returns the names that are gone, with the one that each has now; empty for none.

    What has the same code, number or bytes on the wire is the same; a name that only resembles
    another one is none. Names are dotted, those inside a renamed class by its present name.

    Args:
        names: The dotted names of modules of the former state.
    """
    found: dict[str, str] = {}
    for name in names:
        former, present = old.find(name), new.find(name)
        if isinstance(former, Module) and isinstance(present, Module):
            found.update(_Difference(old, new).of_modules(former, present))
    return found


class _Difference:
    def __init__(self, old: Modules, new: Modules) -> None:
        self._old, self._new = old, new

    def of_modules(self, former: Module, present: Module) -> Iterator[tuple[str, str]]:
        """Yields the names of a module, and of the classes in it."""
        before = {name: self._old.member(former, name) for name in self._old.names(former)}
        after = {name: self._new.member(present, name) for name in self._new.names(present)}
        offered = self._old.offered(former)
        gone = [name for name in _public(before, after) if name in offered]
        come = _public(after, before)
        successors = dict(_paired(gone, come, lambda n: _key(before[n]), lambda n: _key(after[n])))
        yield from ((f"{former.name}.{name}", successors.get(name, "")) for name in gone)
        for name, one in before.items():
            other = after.get(successors.get(name, name))
            if isinstance(one, Class) and isinstance(other, Class) and one.module is former:
                yield from self._of_classes(one, other)

    def _of_classes(self, former: Class, present: Class) -> Iterator[tuple[str, str]]:
        if ast.dump(former.node) == ast.dump(present.node):
            return
        before, after = self._old.members(former), self._new.members(present)
        gone, come = _public(before, after), _public(after, before)
        successors = dict(self._members(former, present, gone, come))
        place = f"{present.module.name}.{present.name}"
        yield from ((f"{place}.{name}", successors.get(name, "")) for name in gone)
        for name, one in before.items():
            other = after.get(successors.get(name, name))
            if isinstance(one, Class) and isinstance(other, Class):
                yield from self._of_classes(one, other)

    def _members(
        self, former: Class, present: Class, gone: list[str], come: list[str]
    ) -> Iterator[tuple[str, str]]:
        """Yields enumerators of one number, inner classes and fields that differ in the name."""
        before, after = self._old.members(former), self._new.members(present)
        key = _number if is_enumeration(self._old, former) else _key
        same = list(_paired(gone, come, lambda n: key(before[n]), lambda n: key(after[n])))
        yield from same
        ours = [name for name in gone if isinstance(before[name], Value)]
        theirs = [name for name in come if isinstance(after[name], Value)]
        if key is _number or len(ours) != len(theirs):
            return
        fields = list(zip(ours, theirs, strict=True))
        text = _code(former.node)
        for one, other in (*same, *fields):
            text = re.sub(rf"\b{one}\b", other, text)
        if text == _code(present.node):
            yield from fields


def _public(names: Mapping[str, object], others: Mapping[str, object]) -> list[str]:
    """Returns the public names that others lack."""
    return [each for each in names if each not in others and not each.startswith("_")]


def _paired(
    gone: list[str], come: list[str], old_key: Callable[[str], str], new_key: Callable[[str], str]
) -> Iterator[tuple[str, str]]:
    """Yields names with the same key, where just one of each state has it."""
    ours, theirs = [old_key(each) for each in gone], [new_key(each) for each in come]
    for name, key in zip(gone, ours, strict=True):
        if key and ours.count(key) == theirs.count(key) == 1:
            yield name, come[theirs.index(key)]


def _key(symbol: Symbol | None) -> str:
    """Returns what stays of a class when it is renamed; empty when nothing is known."""
    if isinstance(symbol, Class):
        for each in symbol.node.body:
            if (
                isinstance(each, ast.AnnAssign)
                and ast.unparse(each.target) == "CODE"
                and each.value
            ):
                return f"{symbol.module.name.partition('.')[0]}: {ast.unparse(each.value)}"
        return _code(symbol.node)
    return ""


def _number(symbol: Symbol) -> str:
    value = symbol.value if isinstance(symbol, Value) else None
    return ast.unparse(value) if value is not None else ""


def _code(node: ast.ClassDef) -> str:
    """Returns the code of a class without its name and its documentation."""
    text = ast.unparse(_Bare().visit(ast.parse(ast.unparse(node))))
    return re.sub(rf"\b{node.name}\b", "_", text)


class _Bare(ast.NodeTransformer):
    """Takes documentation out of a tree."""

    def visit_Expr(self, node: ast.Expr) -> ast.AST | None:
        return ast.Pass() if isinstance(node.value, ast.Constant) else node
