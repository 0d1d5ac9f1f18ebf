"""The generated interface of a workspace, now and before, and what became of its names."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path, PurePosixPath

from jausml.generation.artifact import Artifact, Kind
from jausml.generation.contract.symbols import (
    UNKNOWN,
    Class,
    Module,
    Modules,
    Symbol,
    Unknown,
    Value,
    is_enumeration,
)
from jausml.generation.manifest import Manifest
from jausml.language.model.inputs import read_input


def renames(old: Modules, new: Modules, names: Iterable[str]) -> dict[str, str]:
    """Returns the names that are gone, with the one that each has now; empty for none.

    What has the same code, number or bytes on the wire is the same; a name that only resembles
    another one is none. Names are dotted, those inside a renamed class by its present name.
    """
    successors: dict[str, str] = {}
    for name in names:
        former, present = old.find(name), new.find(name)
        if isinstance(former, Module) and isinstance(present, Module):
            successors.update(_Difference(old, new).of_modules(former, present))
    return successors


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
        # Most classes stay as they are, and need no comparison.
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
        # Fields have other names and nothing else if the code is the same with the new ones put in.
        text = _code(former.node)
        for one, other in (*same, *fields):
            text = re.sub(rf"\b{one}\b", other, text)
        if text == _code(present.node):
            yield from fields


def _public(names: Mapping[str, object], others: Mapping[str, object]) -> list[str]:
    """Returns the public names that others lack."""
    return [name for name in names if name not in others and not name.startswith("_")]


def _paired(
    gone: list[str], come: list[str], old_key: Callable[[str], str], new_key: Callable[[str], str]
) -> Iterator[tuple[str, str]]:
    """Yields names with the same key, where just one of each state has it."""
    ours, theirs = (
        [old_key(old_name) for old_name in gone],
        [new_key(new_name) for new_name in come],
    )
    for name, key in zip(gone, ours, strict=True):
        if key and ours.count(key) == theirs.count(key) == 1:
            yield name, come[theirs.index(key)]


def _key(symbol: Symbol | None) -> str:
    """Returns what stays of a class when it is renamed; empty when nothing is known."""
    if isinstance(symbol, Class):
        # A message that is renamed keeps its code.
        for statement in symbol.node.body:
            if (
                isinstance(statement, ast.AnnAssign)
                and ast.unparse(statement.target) == "CODE"
                and statement.value
            ):
                return f"{symbol.module.name.partition('.')[0]}: {ast.unparse(statement.value)}"
        return _code(symbol.node)
    return ""


def _number(symbol: Symbol) -> str:
    value = symbol.value if isinstance(symbol, Value) else None
    return ast.unparse(value) if value is not None else ""


def _code(node: ast.ClassDef) -> str:
    """Returns the code of a class without its name and its documentation."""
    # A copy, since taking documentation out changes the tree.
    text = ast.unparse(_Bare().visit(ast.parse(ast.unparse(node))))
    return re.sub(rf"\b{node.name}\b", "_", text)


class _Bare(ast.NodeTransformer):
    """Takes documentation out of a tree."""

    def visit_Expr(self, node: ast.Expr) -> ast.AST | None:
        return ast.Pass() if isinstance(node.value, ast.Constant) else node


_FEWEST_PARTS = 3  # package folder, package, module


class Interface:
    """The modules that code of users may import, those of this run from memory.

    Args:
        artifacts: The files of this run; without any, the interface is that on the disk.
    """

    def __init__(
        self,
        artifacts: Sequence[Artifact],
        out: Path,
        manifest: Manifest,
        deleted: frozenset[str] = frozenset(),
    ) -> None:
        self._out = out
        self._deleted = deleted
        self._texts = {a.path: a.text for a in artifacts if a.kind is Kind.GENERATED}
        self._shared = {a.path for a in artifacts if a.is_shared}
        known = {path for path, entry in manifest.files.items() if entry.kind is Kind.GENERATED}
        self._generated = known | self._texts.keys()
        live = self._generated - deleted
        self._live = {_package(path) for path in live if path.endswith(".py")}
        packages = {_package(path) for path in {*manifest.files, *live} if path.endswith(".py")}
        self._words = {package.encode() for package in packages if package}
        self.modules = Modules(self.read, packages - {""}, self.is_generated)

    def is_generated(self, path: str) -> bool:
        """Whether a file is none of the user."""
        return path in self._generated

    def is_inside(self, path: str) -> bool:
        """Whether a file is in a package of the interface."""
        return _package(path) in self.modules.packages

    def changed_from(self, before: Interface) -> list[str]:
        """Returns the modules of a model whose text was another."""
        return [
            module_of(path)
            for path, text in self._texts.items()
            if path not in self._shared
            and module_of(path)
            and path.endswith(".py")
            and before.read(path) not in (None, UNKNOWN, text, text.encode())
        ]

    def concerns(self, path: str, data: bytes) -> bool:
        """Whether a file may import from the interface; not one that the model left behind."""
        if self.is_inside(path):
            return _package(path) in self._live
        return any(word in data for word in self._words)

    def read(self, path: str) -> str | bytes | Unknown | None:
        """Returns the text of a path; None for none, UNKNOWN for what is there and is no text."""
        if path in self._texts or path in self._deleted:
            return self._texts.get(path)
        place = self._out / path
        try:
            if not path.endswith(".py"):
                return UNKNOWN if self._is_otherwise(place) else None
            return read_input(place) if place.is_file() else None
        except OSError:
            return UNKNOWN

    def _is_otherwise(self, place: Path) -> bool:
        """Whether something else than text of Python can be imported from a place."""
        if any(path.suffix in (".so", ".pyd") for path in place.parent.glob(f"{place.name}.*")):
            return True
        inside = (path.relative_to(self._out).as_posix() for path in place.rglob("*.py"))
        return any(relative_path not in self._deleted for relative_path in inside)


def former_names(before: Interface, after: Interface, known: object = None) -> dict[str, str]:
    """Returns the names that an interface had and has no more, with what each is called now."""
    new = renames(before.modules, after.modules, after.changed_from(before))
    former = {**_strings(known), **new}
    # A name that was renamed before leads on to the present one.
    followed = {
        name: new.get(f"{name.rpartition('.')[0]}.{successor}", successor)
        for name, successor in former.items()
    }
    return {
        name: successor for name, successor in followed.items() if not _has(after.modules, name)
    }


def _strings(known: object) -> Mapping[str, str]:
    """Returns what the manifest knows, which anybody may have edited."""
    pairs = known.items() if isinstance(known, dict) else ()
    return {k: v for k, v in pairs if isinstance(k, str) and isinstance(v, str)}


def _has(modules: Modules, dotted: str) -> bool:
    """Tells whether there is a name inside a module, or inside a class of it."""
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


def _package(path: str) -> str:
    return module_of(path).partition(".")[0]


def module_of(path: str) -> str:
    """Returns the dotted name of a module, or nothing for what is outside of a package."""
    parts = PurePosixPath(path).with_suffix("").parts
    if len(parts) < _FEWEST_PARTS or parts[0] != parts[1]:
        return ""
    return ".".join(parts[1:]).removesuffix(".__init__")
