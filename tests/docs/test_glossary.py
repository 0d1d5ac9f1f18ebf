"""The glossary: each word says where it lives, and something lives there."""

from __future__ import annotations

import re
from pathlib import Path

import jausml

PACKAGE = Path(jausml.__file__).parent
GLOSSARY = Path(__file__).resolve().parents[2] / "docs" / "explanation" / "glossary.md"


def test_places_are_there():
    named = re.findall(r"`([a-z_/]+(?:/|\.py))`", GLOSSARY.read_text(encoding="utf-8"))
    assert len(named) > 25
    assert [each for each in named if not (PACKAGE / each).exists()] == []
