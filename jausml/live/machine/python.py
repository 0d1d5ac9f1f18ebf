"""Python, the packages that only some verbs need, and the compiler of translations."""

from __future__ import annotations

import os
import platform
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import jausml
from jausml import __version__
from jausml.generation import native
from jausml.live.machine.finding import Finding, Outcome

if TYPE_CHECKING:
    from collections.abc import Iterator

OLDEST = (3, 10)
"""The oldest Python that is promised; that of ROS 2 Jazzy is 3.12."""

_EXTRAS = (
    ("diagram", "pygraphviz", "pictures of `jausml diagram`"),
    ("studio", "starlette", "`jausml studio`"),
    ("editor", "pygls", "`jausml language-server`"),
    ("top", "textual", "the view of `jausml top`"),
    ("record", "mcap", "`jausml record`"),
)
_PAGE = Path(jausml.__file__).parent / "authoring" / "studio" / "page" / "index.html"
"""What the studio shows; it is built, and a wheel may have been made without."""


def checks() -> Iterator[Finding]:
    """Yields what is to be said of Python."""
    found = f"Python {platform.python_version()} at {sys.executable}, jausml {__version__}"
    if sys.version_info < OLDEST:
        oldest = ".".join(map(str, OLDEST))
        yield Finding("python", "version", Outcome.ERROR, found, f"use Python {oldest} or newer")
    else:
        yield Finding("python", "version", Outcome.OK, found)
    for extra, module, purpose in _EXTRAS:
        if find_spec(module) is None:
            cure = f"pip install 'jausml[{extra}]'"
            yield Finding("python", extra, Outcome.NOTE, f"{purpose} is not installed", cure)
        elif extra == "studio" and not _PAGE.is_file():
            cure = "run `make studio` in the checkout of jausml, or install its `make wheel`"
            yield Finding("python", extra, Outcome.NOTE, f"{purpose} has no page", cure)
        else:
            yield Finding("python", extra, Outcome.OK, f"{purpose} is installed")
    yield _compiler()


def _compiler() -> Finding:
    found = native.compiler()
    if found is not None:
        text = f"{found} compiles the translations of bridges"
        return Finding("python", "compiler", Outcome.OK, text)
    named = os.environ.get("CXX")
    text = f"CXX names {named}, which is no program" if named else "there is no g++ or clang++"
    cure = "install g++, or name a compiler in CXX"
    return Finding("python", "compiler", Outcome.NOTE, f"{text}: bridges translate in Python", cure)
