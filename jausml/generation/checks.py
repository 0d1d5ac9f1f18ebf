"""Checks of rendered text: what no reader of its format would accept is never written."""

from __future__ import annotations

import ast
import io
import json
import tokenize
import warnings
import xml.parsers.expat
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

CANNOT_PARSE = (ValueError, SyntaxError, SyntaxWarning, RecursionError)
"""What Python raises for text that it cannot read, or reads with a warning."""


def syntax_problem(text: str, path: str, *, is_parsed: bool = False) -> str | None:
    """Says why the text, as its bytes on disk, cannot be read as what the path's suffix names.

    Args:
        path: Its path; only Python, XML and JSON are read, other formats pass.

    Returns:
        The problem with its line, or None.
    """
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
