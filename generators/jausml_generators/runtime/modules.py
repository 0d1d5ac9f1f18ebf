"""Modules of the runtime that code needs: those that it imports, and what these import in turn.

Imports in functions count, and those for type checkers: a workspace can be checked as it is. A
package that only passes names on, such as the face, brings those modules whose names are asked for.
"""

from __future__ import annotations

import ast
import functools
import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import jausml
from jausml.generation.artifact import CANNOT_PARSE
from jausml_generators.python.package import FACE

_FOLDER = Path(jausml.__file__).parent / "runtime"
_WHOLE = "*"  # stands for all names of a package
_GAP = r"[ \t]+"
_FROM = rf"(?:from{_GAP}\S+{_GAP})?import{_GAP}"
_IMPORT = re.compile(rf"^[ \t]*({_FROM}(?:\([^)]*\)|.*))$", re.MULTILINE)
_IMPORT_IN_LINE = re.compile(rf"[;:][ \t]*{_FROM}|from{_GAP}.*\\$", re.MULTILINE)


@dataclass(frozen=True)
class Module:
    """A module of the runtime.

    Attributes:
        name: Dotted, below the runtime; empty for the face.
        path: Its file, relative to the folder of the runtime.
    """

    name: str
    path: str
    text: str

    @property
    def package(self) -> str:
        """The package that its relative imports start from."""
        return self.name if self.path.endswith("__init__.py") else self.name.rpartition(".")[0]

    @functools.cached_property
    def imports(self) -> tuple[tuple[str, str], ...]:
        """The imports from the runtime, as module and name."""
        return tuple(_imports(_importing(self.text), f"{FACE}.{self.package}".rstrip(".")))

    @property
    def foreign(self) -> set[str]:
        """The imports from elsewhere, as packages."""
        packages: set[str] = set()
        for node in _importing(self.text):
            if isinstance(node, ast.Import):
                packages.update(alias.name.partition(".")[0] for alias in node.names)
            elif isinstance(node, ast.ImportFrom) and not node.level:
                packages.add(str(node.module).partition(".")[0])
        return packages

    @functools.cached_property
    def passes_on(self) -> Mapping[str, str]:
        """Modules by the names that a package passes on."""
        if self.package != self.name:
            return {}
        return {name: module for module, name in self.imports}


@functools.cache
def runtime_modules() -> Mapping[str, Module]:
    """Returns the modules of the runtime by name."""
    modules: dict[str, Module] = {}
    for file in sorted(_FOLDER.rglob("*.py")):
        path = file.relative_to(_FOLDER).as_posix()
        name = path.removesuffix(".py").replace("/", ".").removesuffix("__init__").rstrip(".")
        modules[name] = Module(name, path, file.read_text(encoding="utf-8"))
    return modules


def needed(code: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Returns the modules that code needs, each with the first file of it that does.

    Args:
        code: Path and text of each file.
    """
    known = runtime_modules()
    reasons: dict[str, str] = {}
    read: set[str] = set()
    for path, text in sorted(code):
        asked = _asked(text) if FACE in text else []
        while asked:
            name = _origin(*asked.pop())
            parts = name.split(".")
            for module in ("", *(".".join(parts[:end]) for end in range(1, len(parts) + 1))):
                reasons.setdefault(module, path)
                # A package on the way passes on what is needed for other reasons, no more.
                is_read = module == name or not known[module].passes_on
                if is_read and module not in read:
                    read.add(module)
                    asked += known[module].imports
    return reasons


def copied(module: Module, kept: Mapping[str, str]) -> str:
    """Returns the text of a module among those that are kept: a package passes on theirs."""
    origins = module.passes_on
    gone = {name for name, origin in origins.items() if _origin(origin, name) not in kept}
    lines = module.text.splitlines(keepends=True)
    for node in ast.parse(module.text).body:
        # It passes on each name by a line of its own.
        if isinstance(node, ast.ImportFrom) and node.names[0].name in gone:
            lines[node.lineno - 1] = ""
    return "".join(lines)


def _asked(text: str) -> list[tuple[str, str]]:
    """Returns the imports of code from the runtime, also of older runs or by hand.

    Of a package that is imported as a whole, it is what the code names behind a dot.
    """
    known = runtime_modules()
    asked: list[tuple[str, str]] = []
    with suppress(*CANNOT_PARSE):
        for module, name in _imports(_importing(text), ""):
            inner = f"{module}.{name}".strip(".")
            passed = known[inner].passes_on if inner in known else {}
            # Few packages pass names on, and the code may be long.
            named = re.findall(rf"\b{re.escape(name)}\.(\w+)", text) if passed else []
            if module in known:
                asked += [(inner, word) for word in passed.keys() & named] or [(module, name)]
    return asked


def _origin(module: str, name: str) -> str:
    """Returns the module that defines a name which is imported from another one."""
    known = runtime_modules()
    inner = f"{module}.{name}".strip(".")
    if inner in known:
        return inner
    passed = known[module].passes_on.get(name)
    return module if passed is None else _origin(passed, name)


def _importing(text: str) -> Iterable[ast.stmt]:
    """Returns the statements of code that import, among others.

    Those that begin a line are parsed alone, as there are few of them. Where a line cannot be read
    so (it goes on, or stands in a string), the whole is parsed.
    """
    last = text.rfind("import")
    head = text[:last] + text[last:].partition("\n\n")[0]
    if not _IMPORT_IN_LINE.search(head):
        with suppress(*CANNOT_PARSE):
            return ast.parse("\n".join(_IMPORT.findall(head))).body
    return _statements(ast.parse(text))


def _statements(node: ast.AST) -> Iterator[ast.stmt]:
    """Yields the statements inside of a node: imports stand nowhere else."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.stmt):
            yield child
        if not isinstance(child, ast.expr):
            yield from _statements(child)


def _imports(statements: Iterable[ast.stmt], package: str) -> Iterator[tuple[str, str]]:
    """Yields the imports from the runtime by a module of a package: module and name."""
    for node in statements:
        if isinstance(node, ast.ImportFrom):
            above = package.split(".")[: len(package.split(".")) - node.level + 1]
            base = [*above, node.module or ""] if node.level else [node.module or ""]
            top, _, inner = ".".join(filter(None, base)).partition(".")
            if top == FACE:
                yield from ((inner, alias.name) for alias in node.names)
        elif isinstance(node, ast.Import):
            names = (alias.name.partition(".") for alias in node.names)
            yield from ((inner, _WHOLE) for top, _, inner in names if top == FACE)
