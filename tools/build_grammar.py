"""Writes conversions and keywords into the grammar of the editor for Visual Studio Code."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

from jausml.language.metamodel import load_metamodels
from jausml.language.semantics.conversions import CONVERSIONS
from jausml.language.text.keywords import classes_by_keyword

ROOT = Path(__file__).resolve().parent.parent
GRAMMAR = ROOT / "integrations" / "vscode" / "syntaxes" / "ros2jaus.tmLanguage.json"

_FIRST_GROUP = re.compile(r"\((?:\w+\|)+\w+\)")


def grammar(text: str) -> str:
    """Returns a grammar with all conversions and with the keywords of all classes.

    Conversions stand behind the colon or the comma before a call.

    Args:
        text: The grammar with others.
    """
    content = json.loads(text)
    names = "|".join(sorted(CONVERSIONS))
    content["repository"]["conversions"]["match"] = rf"(?<=[:,]\s)(?:{names})\b(?!\s*[:.])"
    keywords = sorted(
        keyword for keyword in classes_by_keyword(load_metamodels()) if "." not in keyword
    )
    elements = content["repository"]["elements"]
    elements["match"] = _FIRST_GROUP.sub(f"({'|'.join(keywords)})", elements["match"], count=1)
    return json.dumps(content, indent=2, ensure_ascii=False) + "\n"


def main() -> int:
    """Writes the grammar anew."""
    text = GRAMMAR.read_text(encoding="utf-8")
    GRAMMAR.write_text(grammar(text), encoding="utf-8", newline="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
