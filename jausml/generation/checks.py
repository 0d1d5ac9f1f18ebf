"""Checks of what would be written: paths that lead elsewhere, texts that no reader accepts."""

from __future__ import annotations

import ast
import io
import json
import keyword
import re
import tokenize
import warnings
import xml.parsers.expat
from collections import defaultdict
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from jausml.generation.artifact import Artifact

CANNOT_PARSE = (ValueError, SyntaxError, SyntaxWarning, RecursionError)
"""What Python raises for text that it cannot read, or reads with a warning."""


def syntax_problem(text: str, path: str, *, is_parsed: bool = False) -> str | None:
    """Says why the text, as its bytes on disk, cannot be read as what the path's suffix names."""
    try:
        data = text.encode("utf-8")
        check = _check_encoding if is_parsed else _CHECKS.get(PurePosixPath(path).suffix)
        if check is not None and data:
            check(data)
    except (*CANNOT_PARSE, xml.parsers.expat.ExpatError) as error:
        return f"{path} would not be readable: {error}"
    return None


def _check_encoding(data: bytes) -> None:
    encoding, _ = tokenize.detect_encoding(io.BytesIO(data).readline)
    if encoding != "utf-8":
        raise SyntaxError(f"it would be read as {encoding}")


def _check_python(data: bytes) -> None:
    _check_encoding(data)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ast.parse(data)


def _check_xml(data: bytes) -> None:
    parser = xml.parsers.expat.ParserCreate()
    parser.Parse(data, True)  # noqa: FBT003 - expat takes it by position only


_CHECKS: dict[str, Callable[[bytes], object]] = {
    ".py": _check_python,
    ".pyi": _check_python,
    ".xml": _check_xml,
    ".urdf": _check_xml,
    ".svg": _check_xml,
    ".json": json.loads,
}


# Letters, digits and a few marks: leaves out separators, drive letters, NUL, blanks and controls.
_SEGMENT = re.compile(r"[A-Za-z0-9_.+-]{1,200}")
_DEVICES = {"con", "prn", "aux", "nul"} | {f"{d}{n}" for d in ("com", "lpt") for n in range(1, 10)}
_RESERVED_FOLDERS = {".jausml", ".git"}


def path_problem(path: str) -> str | None:
    """Says why a path is no safe relative posix path, or returns None."""
    if path.startswith("/"):
        return "the path is absolute"
    for segment in path.split("/"):
        if not segment.strip("."):
            return "the path has an empty segment, '.' or '..'"
        if not _SEGMENT.fullmatch(segment) or segment.endswith("."):
            return f"{segment!a} is no portable file name (letters, digits and _ . + - only)"
        if segment.split(".")[0].lower() in _DEVICES:
            return f"{segment!a} is a device name on Windows"
        if segment.lower() in _RESERVED_FOLDERS:
            return f"{segment!a} is not a target's to write"
    return _module_problem(path)


def _module_problem(path: str) -> str | None:
    if not path.endswith((".py", ".pyi")):
        return None
    for segment in path.split("/"):
        if keyword.iskeyword(segment.split(".")[0]):
            return f"{segment!a} is a Python keyword and cannot be imported"
    return None


def find_problems(artifacts: Iterable[Artifact]) -> dict[str, str]:
    """Returns the first problem of each path: unsafe, used twice, or colliding with another."""
    owners: dict[str, list[Artifact]] = defaultdict(list)
    for artifact in artifacts:
        owners[artifact.path].append(artifact)
    problems = _collisions(owners)
    for path, claims in owners.items():
        if len(claims) > 1:
            names = ", ".join(sorted(f"{a.element_id} ({a.target})" for a in claims))
            problems[path] = f"{len(claims)} elements ask for this file: {names}"
        problem = path_problem(path)
        if problem is not None:
            problems[path] = problem
    return problems


def _collisions(paths: Iterable[str]) -> dict[str, str]:
    problems: dict[str, str] = {}
    spelling: dict[str, str] = {}
    files = set(paths)
    for path in sorted(files):
        segments = path.split("/")
        for length in range(1, len(segments) + 1):
            prefix = "/".join(segments[:length])
            first = spelling.setdefault(prefix.lower(), prefix)
            if first != prefix:
                problems[path] = f"differs from '{first}' in upper and lower case only"
            elif length < len(segments) and prefix in files:
                problems[path] = f"'{prefix}' is a file in the same run, not a folder"
    return problems
