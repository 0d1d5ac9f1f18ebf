"""Baselines: the findings that were there when a team began to look, so that new ones count.

A finding is known by its rule, its file, its element without positions, and its message: lines
may move, and elements may come before it.
"""

from __future__ import annotations

import json
import os
import re
from collections import Counter
from dataclasses import replace
from pathlib import Path, PurePath
from typing import NamedTuple

from jausml.language.model.diagnostics import Diagnostic
from jausml.language.model.files import read_input
from jausml.language.validation.rule import Ground, Report, SetAside

SCHEMA = 1
_POSITION = re.compile(r"\[\d+\]")


class Identity(NamedTuple):
    """The parts by which a finding is known.

    Attributes:
        file: The path from the folder of the baseline.
        element: The element without positions among its siblings.
    """

    rule: str
    file: str
    element: str
    message: str


class BaselineError(Exception):
    """A file is no baseline."""


def read(path: Path) -> Counter[Identity]:
    """Returns the findings that a baseline lists, with the count of each.

    Raises:
        BaselineError: It is no baseline, or one of another schema.
        OSError: It cannot be read.
    """
    try:
        content = json.loads(read_input(path))
    except ValueError as error:
        raise BaselineError(f"it is no JSON: {error}") from error
    except RecursionError as error:
        raise BaselineError("it is no JSON of findings: nested too deep") from error
    if not isinstance(content, dict) or content.get("schema") != SCHEMA:
        raise BaselineError(f"it has no 'schema': {SCHEMA}")
    entries = content.get("findings")
    if not isinstance(entries, list):
        raise BaselineError("'findings' is no list")
    known: Counter[Identity] = Counter()
    for entry in entries:
        identity, count = _entry(entry)
        known[identity] += count
    return known


def _entry(entry: object) -> tuple[Identity, int]:
    if isinstance(entry, dict):
        count = entry.get("count", 1)
        match [entry.get(part) for part in Identity._fields]:
            case [str(rule), str(file), str(element), str(message)]:
                # No bool, which is an int as well.
                if type(count) is int and count > 0:
                    return Identity(rule, file, element, message), count
    raise BaselineError(f"'findings' has what is no finding: {str(entry)[:60]!r}")


def written(report: Report, former: Counter[Identity], path: Path) -> str:
    """Returns a baseline that lists the findings of a report.

    Args:
        former: What the baseline listed before; of files that the report is not about it stays.
        path: Where it will stand; the files that it names are relative to its folder.
    """
    counted = Counter(_identity(diagnostic, path) for diagnostic in report.diagnostics)
    counted += _elsewhere(former, report, path)
    entries = [
        identity._asdict() | ({"count": count} if count > 1 else {})
        for identity, count in sorted(counted.items(), key=lambda item: (item[0].file, item[0]))
    ]
    content = {"schema": SCHEMA, "findings": entries}
    return json.dumps(content, indent=2, ensure_ascii=True) + "\n"


def without_known(report: Report, known: Counter[Identity], path: Path) -> tuple[Report, int]:
    """Returns a report in which known findings do not count, and how many of them are gone.

    Those of files that the report is not about are not gone.
    """
    left = known.copy()
    standing = []
    aside = list(report.set_aside)
    reason = f"listed in {path.name}"
    for diagnostic in report.diagnostics:
        identity = _identity(diagnostic, path)
        if left[identity] > 0:
            left[identity] -= 1
            aside.append(SetAside(diagnostic, Ground.KNOWN, reason))
        else:
            standing.append(diagnostic)
    aside.sort(key=lambda suppression: suppression.diagnostic.sort_key)
    gone = left - _elsewhere(known, report, path)
    return replace(report, diagnostics=tuple(standing), set_aside=tuple(aside)), gone.total()


def _elsewhere(known: Counter[Identity], report: Report, path: Path) -> Counter[Identity]:
    """Returns the known findings of existing files that a report is not about."""
    seen = {_relative(file, path) for file in report.files}
    return Counter(
        {
            identity: count
            for identity, count in known.items()
            # Unlike Path.exists this is False where nothing may be looked at.
            if identity.file not in seen and os.path.exists(path.parent / identity.file)  # noqa: PTH110
        }
    )


def _identity(diagnostic: Diagnostic, path: Path) -> Identity:
    file = _relative(diagnostic.location.path, path)
    element = _POSITION.sub("[]", diagnostic.element)
    return Identity(diagnostic.rule, file, element, diagnostic.message)


def _relative(file: str | Path, path: Path) -> str:
    """Returns the path of a file from the folder of a baseline."""
    return PurePath(
        os.path.relpath(os.path.realpath(file), os.path.realpath(path.parent))
    ).as_posix()
