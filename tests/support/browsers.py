"""A real browser, and the page of the studio that it opens: where they are, and what is missing."""

from __future__ import annotations

import fcntl
import os
import shutil
import subprocess
import sys
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCES = ROOT / "studio"
PAGE = ROOT / "jausml" / "authoring" / "studio" / "page" / "index.html"
BUILD = ROOT / "tools" / "build_studio.py"
INSTALLED = SOURCES / "node_modules" / ".package-lock.json"
"""npm writes it when all is installed."""

_BROWSERS = ("chromium", "chromium-browser", "google-chrome")
_NO_SOURCES = {"node_modules", "coverage"}
_TAIL = 2000


@cache
def browser() -> str:
    """Returns the program of the browser, empty where there is none."""
    return next((found for each in _BROWSERS if (found := shutil.which(each))), "")


def missing() -> str:
    """Says what is missing, or returns an empty string."""
    if not browser():
        return "the studio in a browser needs chromium: apt install chromium"
    if find_spec("playwright") is None:
        return "the studio in a browser needs playwright: pip install playwright"
    return ""


BROWSER = pytest.mark.skipif(bool(missing()), reason=missing() or "a browser is there")


def is_stale() -> bool:
    """Tells whether the page is older than what it is built from, or not there."""
    if not PAGE.is_file():
        return True
    built = PAGE.stat().st_mtime
    return any(each.stat().st_mtime > built for each in _sources())


def build_page() -> None:
    """Builds the page unless it is fresh; of several processes one does it, and others wait.

    Raises:
        pytest.skip.Exception: What it is built from or with cannot be had here.
        AssertionError: Its build fails.
    """
    with (SOURCES / "package.json").open("rb") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not is_stale():
            return
        result = subprocess.run(
            [sys.executable, str(BUILD), "--no-check"],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
    if result.returncode and not INSTALLED.is_file():
        pytest.skip("the page of the studio needs node and what npm installs: make studio says why")
    assert result.returncode == 0, result.stdout[-_TAIL:]


def _sources():
    for folder, folders, files in os.walk(SOURCES):
        folders[:] = [each for each in folders if each not in _NO_SOURCES]
        yield from (Path(folder) / each for each in files)
