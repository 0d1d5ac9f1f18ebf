"""Writes jausml/cli/shared/known/: what verbs print, and shells complete, at once."""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING, Any

from jausml.cli.lookup import listed
from jausml.cli.shared.names import FOLDER, KNOWN
from jausml.language.model import library_root

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


def lists() -> Mapping[str, Sequence[Mapping[str, Any]]]:
    """Returns each list by its name; files are relative to the library."""
    root = library_root()
    maps = listed.maps(())
    for each in maps:
        each["file"] = each["file"].removeprefix(f"{root}/")
    made = (
        listed.rules(),
        listed.services(()),
        listed.messages(()),
        listed.fields(()),
        maps,
    )
    return dict(zip(KNOWN, made, strict=True))


def main() -> int:
    """Writes the lists; with --check only tells whether they are up to date (exit 1 when not)."""
    stale = []
    for name, entries in lists().items():
        path = FOLDER / f"{name}.jsonl"
        text = "".join(f"{json.dumps(each)}\n" for each in entries)
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            stale.append(name)
            if "--check" not in sys.argv[1:]:
                path.write_text(text, encoding="utf-8", newline="\n")
    print(f"{len(stale)} lists changed: {', '.join(stale)}" if stale else "lists are up to date")
    return 1 if stale and "--check" in sys.argv[1:] else 0


if __name__ == "__main__":
    sys.exit(main())
