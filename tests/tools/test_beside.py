"""What stands beside the checkout is asked for in one place: nothing else looks outside of it."""

import ast
import re
from pathlib import Path

from for_each import for_each

HERE = Path(__file__).resolve()
ROOT = HERE.parents[2]
ASKING = ROOT / "tests" / "support" / "needs.py"
FOLDERS = ("tests", "tools", "benchmarks", "experiments")
FILES = [
    path for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*.py")) if path != HERE
]
UPWARDS = re.compile(r"parent|\.\.[/\"']|shared|JAUSML_SHARED")


class Looking:
    """Follows the paths of a module as far as they can be known without running it.

    They begin at `__file__`, or at a name `ROOT` that is imported.
    """

    def __init__(self, text: str, file: Path) -> None:
        self._file = file
        self._known: dict[str, Path] = {}
        self.outside: list[int] = []
        tree = ast.parse(text)
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and "ROOT" in {name.name for name in node.names}:
                self._known["ROOT"] = ROOT
        for node in tree.body:
            if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
                path = self._path(node.value)
                if path is not None:
                    self._known[node.targets[0].id] = path
        for node in ast.walk(tree):
            path = self._path(node)
            if (path is not None and not path.is_relative_to(ROOT)) or self._names_shared(node):
                self.outside.append(node.lineno)

    def _path(self, node: ast.AST) -> Path | None:
        if isinstance(node, ast.Name):
            return self._file if node.id == "__file__" else self._known.get(node.id)
        if isinstance(node, ast.Call):
            if isinstance(node.func, ast.Name) and node.func.id in ("Path", "str") and node.args:
                return self._path(node.args[0])
            if isinstance(node.func, ast.Attribute) and node.func.attr in ("resolve", "absolute"):
                return self._path(node.func.value)
        if isinstance(node, ast.Attribute) and node.attr == "parent":
            path = self._path(node.value)
            return path and path.parent
        if isinstance(node, ast.Subscript) and isinstance(node.value, ast.Attribute):
            path = self._path(node.value.value)
            if path and node.value.attr == "parents" and isinstance(node.slice, ast.Constant):
                return path.parents[node.slice.value]
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div):
            path, name = self._path(node.left), getattr(node.right, "value", None)
            if path and isinstance(name, str):
                return Path(*_without_dots((path / name).parts))
        return None

    @staticmethod
    def _names_shared(node: ast.AST) -> bool:
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            return "../shared/" in node.value or node.value == "JAUSML_SHARED"
        is_piece = isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div)
        name = getattr(node.right, "value", None) if is_piece else None
        return isinstance(name, str) and Path(name).parts[:1] == ("shared",)


def _without_dots(parts: tuple[str, ...]) -> list[str]:
    found: list[str] = []
    for part in parts:
        if part == "..":
            found.pop()
        else:
            found.append(part)
    return found


def test_nothing_else_looks_outside_of_the_checkout():
    outside = {}
    for path in FILES:
        text = path.read_text(encoding="utf-8")
        # To read the tree of each takes seconds: what leads outside has one of these, and more
        # than the usual way from a folder in a folder to the checkout.
        is_deep = len(path.relative_to(ROOT).parts) > 2
        unusual = text.replace("Path(__file__).resolve().parents[2]", "") if is_deep else text
        if UPWARDS.search(unusual):
            outside[path] = Looking(text, path).outside
    assert {path for path, lines in outside.items() if lines} == {ASKING}


@for_each(
    "line",
    [
        'GOLDEN = Path(__file__).resolve().parents[3] / "golden"',
        "GOLDEN = Path(__file__).parents[2].parent",
        "GOLDEN = FOLDER.parents[2]",
        "from support import ROOT; GOLDEN = ROOT.parent",
        'GOLDEN = FOLDER / "../../../golden"',
        'GOLDEN = somewhere / "shared" / "golden"',
        'GOLDEN = somewhere / "shared/golden"',
        'open("../shared/golden")',
        'os.environ["JAUSML_SHARED"]',
        "def golden(): return FOLDER.parent.parent.parent",
    ],
)
def test_a_look_outside_is_found(line):
    text = f"FOLDER = Path(__file__).parent\nFURTHER = FOLDER.parents[1]\n{line}\n"
    assert set(Looking(text, ROOT / "tests" / "tools" / "test_planted.py").outside) == {3}
