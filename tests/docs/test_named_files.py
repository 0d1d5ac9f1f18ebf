"""Pages about the code: what they name is there."""

import re
from pathlib import Path

import pytest

GUARDS = ("CONTRIBUTING.md", "docs/explanation", "docs/how-to/extend.md", "docs/adr")

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("benchmarks", "docs", "generators", "jausml", "metamodels", "models", "tests", "tools")
# Pages, and how many places each names at least: a pattern that finds nothing proves nothing.
PAGES = {
    "CONTRIBUTING.md": 4,
    "docs/explanation/architecture.md": 30,
    "docs/explanation/glossary.md": 25,
    "docs/how-to/extend.md": 30,
}
_PLACE = re.compile(r"`([\w.-]+(?:/[\w.-]+)*(?:/|\.(?:py|ecore|xmi|j2|lark|toml|java)))`")


@pytest.fixture(scope="module")
def tree() -> str:
    """The paths of all files of the project, a line each, with a slash in front."""
    files = [path for folder in FOLDERS for path in (ROOT / folder).rglob("*") if path.is_file()]
    return "\n".join(f"/{path.relative_to(ROOT).as_posix()}" for path in files) + "\n"


@pytest.mark.parametrize("page", PAGES)
def test_places_are_there(page, tree):
    named = _PLACE.findall((ROOT / page).read_text(encoding="utf-8"))
    assert len(named) >= PAGES[page]
    # A page names a module by its path in the folder that it speaks of.
    lost = [path for path in named if f"/{path}" not in tree and not (ROOT / path).exists()]
    assert lost == []


def test_the_index_lists_each_decision():
    folder = ROOT / "docs" / "adr"
    listed = re.findall(r"\]\((\d[^)]+)\)", (folder / "index.md").read_text(encoding="utf-8"))
    there = sorted(path.name for path in folder.glob("[0-9]*.md"))
    assert sorted(listed) == there
