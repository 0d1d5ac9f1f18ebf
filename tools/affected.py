"""The test files that a change can break, nearest first.

A test file is as far from a changed module as imports lead from the one to the other. Of files
equally far, one whose name or folder is that of the module is nearer; one that has both is near
though no import leads there, as with verbs that are loaded by name. What is no Python (templates,
grammars) counts as the modules of the package that it lies in.

Where all tests are equally far, as from a metamodel, imports do not tell which of them guard it. A
test file says so itself: `GUARDS = ("metamodels", "jausml/language/semantics/units.py")` names
files and folders of the checkout whose changes it is there to judge. It comes right after the test
files that changed themselves.
"""

from __future__ import annotations

import ast
import re
import subprocess
from collections import defaultdict
from collections.abc import Iterable, Mapping
from pathlib import Path

import grimp

PACKAGES = {"jausml": "jausml", "jausml_generators": "generators/jausml_generators"}
"""Where each package lies in a checkout."""
FAR = 3
"""Imports beyond which a test file says little about a module."""
CHANGED, GUARD = -200, -100
"""Ranks of a test file that changed, and of one that guards what changed: before all distances."""
_IMPORTS = re.compile(
    r"^[ \t]*(?:from \.*([\w.]*) )?import (?:\(([^)]*)\)|([^\n#;]+))", re.MULTILINE
)
"""Read as text, which takes a tenth of the time of a syntax tree of each test file."""
_GUARDS = re.compile(r"^GUARDS = (\(.*?\))$", re.MULTILINE | re.DOTALL)


def changed_files(root: Path, base: str = "") -> list[str]:
    """Files that differ from where this branch left `main`, and files that git does not know yet.

    Args:
        root: the checkout
        base: the commit to compare with, instead of the one where the branch left
    """

    def git(*arguments: str) -> list[str]:
        command = ["git", "-C", str(root), *arguments]
        result = subprocess.run(command, check=False, capture_output=True, text=True)
        return result.stdout.split("\0" if "-z" in arguments else None)

    start = base or "".join(git("merge-base", "HEAD", "main")) or "HEAD"
    names = git("diff", "--name-only", "-z", start)
    names += git("ls-files", "--others", "--exclude-standard", "-z")
    return sorted({name for name in names if name})


class Checkout:
    """What imports what in a checkout, and what its test files import and guard.

    Args:
        root: the checkout; its packages can be imported
    """

    def __init__(self, root: Path) -> None:
        graph = grimp.build_graph(*PACKAGES, cache_dir=None)
        self._root = root
        self._known = graph.modules
        self._imports = {
            module: graph.find_modules_that_directly_import(module) for module in graph.modules
        }
        self._tests = _TestFiles(root, graph.modules)

    def affected(self, changed: Iterable[str]) -> list[Path]:
        """Returns the test files that changed files can break, the nearest first."""
        root, tests = self._root, self._tests
        names = list(changed)
        modules = _modules(root, names, self._known)
        distances = _distances(modules, self._imports)
        words = _words(" ".join(modules)) - _words(" ".join(PACKAGES))
        ends = [_words("/".join(name.rpartition(".")[0].split("/")[-2:])) for name in names]
        files = {root / name for name in names}
        ranked = []
        for test in tests.files:
            place = test.relative_to(root).as_posix()
            likeness = len(words & _words(place))
            reached = [distances[name] for name in tests.imported(test) if name in distances]
            ranks = [distance - likeness for distance in reached if distance <= FAR]
            ranks += [0] if any(end <= _words(place) for end in ends if end) else []
            # The closer the place that a guard names, the more it says.
            touched = [
                guard for guard in guards(test) if any(_within(name, guard) for name in names)
            ]
            ranks += [GUARD - guard.count("/") for guard in touched]
            # What changed itself comes first, and what all tests share last.
            ranks += [CHANGED] if test in files else []
            shared = tests.support(test) & files
            ranks += [FAR if path.name == "conftest.py" else 0 for path in shared]
            if ranks:
                ranked.append((min(ranks), place))
        return [root / place for _, place in sorted(ranked)]


def guards(test: Path) -> tuple[str, ...]:
    """What a test file says that it guards: paths of files and folders of the checkout."""
    match = _GUARDS.search(test.read_text(encoding="utf-8"))
    return tuple(ast.literal_eval(match[1])) if match else ()


def _within(name: str, place: str) -> bool:
    return name == place or name.startswith(f"{place}/")


def _words(text: str) -> set[str]:
    return set(re.findall(r"[a-z]+", text))


def _modules(root: Path, changed: list[str], known: set[str]) -> set[str]:
    """The modules that changed files are, or that lie beside or above what is no module."""
    modules = set()
    for name in changed:
        parts = name.removesuffix(".py").removesuffix("/__init__").split("/")
        if parts[0] == "metamodels":
            modules |= {
                module_name
                for module_name in known
                if module_name.startswith("jausml.language.metamodel.")
            }
        home = next(
            (package_name for package_name, at in PACKAGES.items() if name.startswith(f"{at}/")),
            None,
        )
        if home is None:
            continue
        above = len(PACKAGES[home].split("/"))
        module = ".".join([home, *parts[above:]])
        if module in known:
            modules.add(module)
            continue
        folder = (root / name).parent
        while not (folder / "__init__.py").exists() and folder != root:
            folder = folder.parent
        package = ".".join([home, *folder.relative_to(root).parts[above:]])
        modules |= {
            module_name
            for module_name in known
            if module_name == package or module_name.startswith(f"{package}.")
        }
    return modules


def _distances(modules: set[str], importers: Mapping[str, set[str]]) -> dict[str, int]:
    """How many imports lead from each module to the nearest of some modules."""
    distances = dict.fromkeys(modules, 0)
    pending = list(modules)
    while pending:
        module = pending.pop(0)
        for importer in importers[module]:
            if importer not in distances:
                distances[importer] = distances[module] + 1
                pending.append(importer)
    return distances


class _TestFiles:
    """The test files, and what each imports by itself or through files beside it."""

    def __init__(self, root: Path, known: set[str]) -> None:
        folder = root / "tests"
        self.files = sorted(folder.rglob("test_*.py"))
        self._known = known
        self._named = defaultdict(list)
        for path in folder.rglob("*.py"):
            self._named[path.stem].append(path)
        for path in (root / "tools").glob("*.py"):
            self._named[path.stem].append(path)
        self._names: dict[Path, set[str]] = {}
        self._support: dict[Path, set[Path]] = {}

    def support(self, file: Path) -> set[Path]:
        """A test file, what it imports of files of the tests, and the conftest files above it."""
        if file in self._support:
            return self._support[file]
        files = self._support[file] = set()
        pending = [
            file,
            *(conftest for conftest in self._named["conftest"] if conftest.parent in file.parents),
        ]
        while pending:
            path = pending.pop()
            if path not in files:
                files.add(path)
                for name in self._imports(path):
                    pending += self._named.get(name, ())
        return files

    def imported(self, file: Path) -> set[str]:
        """The modules of the package that a test file imports, by itself or through its support."""
        names = set().union(*map(self._imports, self.support(file)))
        return names & self._known

    def _imports(self, path: Path) -> set[str]:
        if path not in self._names:
            names = set()
            for module, several, one in _IMPORTS.findall(path.read_text(encoding="utf-8")):
                imported_names = [
                    word.split()[0] for word in (several or one).split(",") if word.strip()
                ]
                names |= (
                    {module, *(f"{module}.{name}" for name in imported_names)}
                    if module
                    else {*imported_names}
                )
            self._names[path] = names
        return self._names[path]
