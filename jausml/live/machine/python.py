"""Checks of Python: its version, and the packages that verbs need."""

from __future__ import annotations

import platform
import sys
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

import jausml
from jausml import __version__, installing
from jausml.live.machine.findings import Finding, Verdict

OLDEST = (3, 10)
"""The oldest Python that is promised; that of ROS 2 Jazzy is 3.12."""

_EXTRAS = (
    ("diagram", "graphviz-pure", "pictures of `jausml diagram`"),
    ("studio", "starlette", "`jausml studio`"),
    ("editor", "pygls", "`jausml language-server`"),
    ("top", "textual", "the view of `jausml top`"),
    ("record", "mcap", "`jausml record`"),
)
# It is built, and a wheel may have been made without.
_PAGE_OF_THE_STUDIO = Path(jausml.__file__).parent / "authoring/studio/page/index.html"


def python_checks() -> Iterator[Finding]:
    """Yields the findings about Python."""
    description = f"Python {platform.python_version()} at {sys.executable}, jausml {__version__}"
    if sys.version_info < OLDEST:
        cure = f"use Python {'.'.join(map(str, OLDEST))} or newer"
        yield Finding("python", "version", Verdict.ERROR, description, cure)
    else:
        yield Finding("python", "version", Verdict.OK, description)
    for extra, package, purpose in _EXTRAS:
        if not is_installed(package):
            cure = installing.command(extra)
            yield Finding("python", extra, Verdict.NOTE, f"{purpose} is not installed", cure)
        elif extra == "studio" and not _PAGE_OF_THE_STUDIO.is_file():
            cure = "run `make studio` in the checkout of jausml, or install its `make wheel`"
            yield Finding("python", extra, Verdict.NOTE, f"{purpose} has no page", cure)
        else:
            yield Finding("python", extra, Verdict.OK, f"{purpose} is installed")


def is_installed(package: str) -> bool:
    """Whether pip has installed a package of this name."""
    try:
        metadata.distribution(package)
    except metadata.PackageNotFoundError:
        return False
    return True
