"""The imports of rendered Python: exactly the names that a module uses, and no unknown ones."""

from __future__ import annotations

import ast
import builtins
import re
import sys
from collections import defaultdict
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping

MARKER = "from __future__ import annotations\n"
"""The line of a template that import statements follow."""
_NAMED = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.ExceptHandler)
_DEFINING = (*_NAMED, ast.arg, ast.Import, ast.ImportFrom)
_ANNOTATIONS = frozenset({"annotation", "returns"})
_WITHOUT_NAMES = frozenset({"ctx", "op", "ops", "attr", "id", "kind", "lineno", "type_comment"})
_OF_MODULES = frozenset({"__name__", "__file__", "__doc__"})
# Decorators of classes ask for these while the program runs.
_ALWAYS_RUNNING = frozenset({"typing", "dataclasses"})


class UnknownNameError(NameError):
    """A name that rendered Python uses and that nothing defines or offers."""


@dataclass(frozen=True)
class Origin:
    """Where a name comes from.

    Attributes:
        name: Its name there; empty for the module itself.
    """

    module: str
    name: str = ""


def offered(module: str, *names: str) -> dict[str, Origin]:
    """Returns names as a module offers them."""
    return {name: Origin(module, name) for name in names}


STANDARD: Mapping[str, Origin] = {
    "math": Origin("math"),
    "pytest": Origin("pytest"),
    "socket": Origin("socket"),
    "struct": Origin("struct"),
    **offered("collections.abc", "Callable", "Iterator", "MutableSequence", "Sequence"),
    **offered("dataclasses", "dataclass", "field"),
    **offered("enum", "IntEnum"),
    **offered("pathlib", "Path"),
    **offered("typing", "TYPE_CHECKING", "Any", "ClassVar"),
}
"""What any generated module may use of the standard library, and pytest."""


@dataclass(frozen=True)
class Imports:
    """What a module may import."""

    names: Mapping[str, Origin]
    own: str = ""
    for_user: bool = False

    def and_also(self, names: Mapping[str, Origin]) -> Imports:
        """Returns the same with further names, which come before others of that name."""
        return replace(self, names={**self.names, **names})


@dataclass(frozen=True)
class Names:
    """The names in some statements."""

    running: Collection[str]
    annotating: Collection[str]
    defined: Collection[str]

    @property
    def unknown(self) -> set[str]:
        """Those that are asked for, and that neither the statements nor Python define."""
        used = {*self.running, *self.annotating}.difference(self.defined)
        return {name for name in used if not hasattr(builtins, name) and name not in _OF_MODULES}


def names_in(module: ast.Module) -> Names:
    """Returns the names in the statements of a module."""
    running: set[str] = set()
    annotating: set[str] = set()
    defined: set[str] = set()
    pending: list[tuple[ast.AST, set[str]]] = [(module, running)]
    while pending:
        node, used = pending.pop()
        if isinstance(node, ast.Name):
            (used if isinstance(node.ctx, ast.Load) else defined).add(node.id)
            continue
        if isinstance(node, _DEFINING):
            defined.update(_defined(node))
        for field in node._fields:
            if field in _WITHOUT_NAMES:
                continue
            value = getattr(node, field, None)
            inside = annotating if field in _ANNOTATIONS else used
            if isinstance(value, list):
                pending += [(each, inside) for each in value if isinstance(each, ast.AST)]
            elif isinstance(value, ast.AST):
                pending.append((value, inside))
    return Names(running, annotating, defined)


def import_lines(names: Names, imports: Imports) -> str:
    """Returns the import statements for what a module uses, in ruff's order.

    Raises:
        UnknownNameError: Nothing defines a name that it uses.
    """
    origins = {**STANDARD, **imports.names}
    unknown = sorted(names.unknown - origins.keys())
    if unknown:
        raise UnknownNameError(f"nothing defines the name {unknown[0]!r}")
    imported = origins.keys() - names.defined
    running = imported & set(names.running)
    annotating = imported & set(names.annotating)
    if imports.for_user:
        running |= annotating
    running |= {name for name in annotating if origins[name].module in _ALWAYS_RUNNING}
    only_typing = annotating - running
    if only_typing:
        running.add("TYPE_CHECKING")
    blocks = _sections(running, origins, imports.own)
    if only_typing:
        inner = "\n\n".join(_sections(only_typing, origins, imports.own))
        blocks.append("if TYPE_CHECKING:\n" + re.sub("^(?=.)", "    ", inner, flags=re.MULTILINE))
    return "\n".join(f"{each}\n" for each in blocks)


def _defined(node: ast.AST) -> list[str]:
    if isinstance(node, ast.arg):
        return [node.arg]
    if isinstance(node, ast.Import | ast.ImportFrom):
        return [each.asname or each.name.partition(".")[0] for each in node.names]
    return [node.name] if isinstance(node, _NAMED) and node.name else []


def _sections(names: Iterable[str], origins: Mapping[str, Origin], own: str) -> list[str]:
    """Returns the import statements of the standard library, of others and of the package."""
    sections: dict[int, dict[str, Origin]] = defaultdict(dict)
    for name in names:
        top = origins[name].module.partition(".")[0]
        number = 2 if top in {"", own} else int(top not in sys.stdlib_module_names)
        sections[number][name] = origins[name]
    return ["\n".join(statements(sections[number])) for number in sorted(sections)]


def statements(origins: Mapping[str, Origin]) -> Iterator[str]:
    """Yields the import statements for names, in ruff's order."""
    modules = [name for name, origin in origins.items() if not origin.name]
    yield from (f"import {origins[name].module}" for name in sorted(modules, key=_natural))
    members: dict[tuple[str, str], set[str]] = defaultdict(set)
    for name, origin in origins.items():
        if origin.name == name:
            members[origin.module, ""].add(name)
        elif origin.name:
            members[origin.module, name].add(f"{origin.name} as {name}")
    lines = [(module, sorted(each, key=_rank)) for (module, _), each in members.items()]
    for module, each in sorted(lines, key=lambda line: (_natural(line[0]), _rank(line[1][0]))):
        yield f"from {module} import {', '.join(each)}"


def _rank(name: str) -> tuple[int, str, str]:
    """Constants come before classes, classes before functions; numbers count as numbers."""
    group = 0 if len(name) > 1 and name.isupper() else 1 if name[0].isupper() else 2
    return group, _natural(name), name


def _natural(text: str) -> str:
    return re.sub(r"\d+", lambda number: number.group().zfill(20), text.lower())
