"""Fixes of users' files: what is certain is written, the rest stays as it is."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING

from jausml.generation.contract.edits import Edit, edited
from jausml.generation.writer import replace_file
from jausml.language.model.inputs import read_input

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from jausml.generation.contract.finding import Finding


@dataclass(frozen=True)
class Fix:
    """An edit that was made.

    Attributes:
        path: The file, relative to the output folder.
    """

    path: str
    edit: Edit


def fix_files(out: Path, findings: Sequence[Finding]) -> list[Fix]:
    """Makes the edits of findings, and returns them; a file in which they do not fit stays.

    Raises:
        WriteError: A file was edited meanwhile, or the operating system refused.
    """
    fixed: list[Fix] = []
    for path, found in groupby(sorted(findings, key=lambda f: f.path), key=lambda f: f.path):
        edits = sorted({edit for finding in found for edit in finding.edits})
        data = read_input(out / path) if edits else b""
        new = edited(data, edits) if edits else None
        if new is not None and new != data:
            replace_file(out, path, data, new)
            fixed += [Fix(path, edit) for edit in edits]
    return fixed
