"""Copies of metamodels and library for Eclipse: which are still as they were made."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING

from jausml.language.model.inputs import read_input

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

SUMS = "SHA256SUMS"
"""The file in a folder of copies that says what they were, as `sha256sum` writes it."""


def sums_of(contents: Mapping[str, bytes]) -> bytes:
    """Returns what says of copies what they are."""
    lines = (f"{_digest(data)}  {path}\n" for path, data in sorted(contents.items()))
    return "".join(lines).encode()


def renewed(folder: Path, contents: Mapping[str, bytes]) -> tuple[dict[str, bytes], list[str]]:
    """Returns the copies that are to be written anew, and those that somebody has changed."""
    stored = read_input(folder / SUMS) if (folder / SUMS).is_file() else b""
    lines = stored.decode("utf-8", "replace").splitlines()
    known = {path: digest for digest, _, path in (line.partition("  ") for line in lines)}
    wanted: dict[str, bytes] = {}
    kept = []
    for path, data in contents.items():
        found = read_input(folder / path) if (folder / path).is_file() else None
        if found == data:
            continue
        if found is None or _digest(found) == known.get(path):
            wanted[path] = data
        else:
            kept.append(path)
    sums = sums_of(contents)
    if stored != sums and not kept:
        wanted[SUMS] = sums
    return wanted, kept


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
