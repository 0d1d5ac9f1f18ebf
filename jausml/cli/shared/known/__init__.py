"""What is known without a model of the user: rules, and what the library has.

Each file beside this module holds a list, one JSON object a line, as `--format json` prints it.
`tools/build_known.py` writes them from the rules and the library, and a test compares them, so that
lists are printed, and words completed, without reading either, which takes several times as long.
"""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path
from typing import Any

NAMES = ("rules", "services", "messages", "fields", "maps")
"""The lists; the files of the maps are relative to the library."""

FOLDER = Path(__file__).parent


def known(name: str) -> list[dict[str, Any]]:
    """Returns a list."""
    lines = (FOLDER / f"{name}.jsonl").read_text(encoding="utf-8").splitlines()
    return [json.loads(line) for line in lines]


def library_file(name: str) -> str:
    """Returns the path of a file of the library."""
    return str(files("jausml.models") / "library" / name)
