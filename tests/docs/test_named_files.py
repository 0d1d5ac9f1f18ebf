"""Pages about the code: what they name is there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import jausml

PACKAGE = Path(jausml.__file__).parent
ROOT = Path(__file__).resolve().parents[2]
PAGES = (
    "CONTRIBUTING.md",
    "docs/explanation/architecture.md",
    "docs/explanation/glossary.md",
    "docs/how-to/extend.md",
)
FEWEST = {"CONTRIBUTING.md": 5}


@pytest.mark.parametrize("page", PAGES)
def test_places_are_there(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    named = re.findall(r"`([\w.-]+(?:/[\w.-]+)*(?:/|\.(?:py|ecore|xmi|j2|lark|toml|java|md)))`", text)
    # A page names a module by its path in the wing or the folder that it speaks of.
    folders = [ROOT, PACKAGE, *(path for path in PACKAGE.rglob("*") if path.is_dir())]
    lost = [each for each in named if not any((folder / each).exists() for folder in folders)]
    assert len(named) >= FEWEST.get(page, 20)
    assert lost == []
