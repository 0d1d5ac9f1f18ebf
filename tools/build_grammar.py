"""Writes the names of conversions into the grammar of the editor for Visual Studio Code."""

from __future__ import annotations

import json
import sys
from pathlib import Path

from jausml.semantics.conversions import CONVERSIONS

ROOT = Path(__file__).resolve().parent.parent
GRAMMAR = ROOT / "editors" / "vscode" / "syntaxes" / "ros2jaus.tmLanguage.json"


def grammar(text: str) -> str:
    """Returns a grammar with all conversions, behind the colon or the comma before a call.

    Args:
        text: The grammar with others.
    """
    content = json.loads(text)
    names = "|".join(sorted(CONVERSIONS))
    content["repository"]["conversions"]["match"] = rf"(?<=[:,]\s)(?:{names})\b(?!\s*[:.])"
    return json.dumps(content, indent=2, ensure_ascii=False) + "\n"


def main() -> int:
    """Writes the grammar anew."""
    text = GRAMMAR.read_text(encoding="utf-8")
    GRAMMAR.write_text(grammar(text), encoding="utf-8", newline="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
