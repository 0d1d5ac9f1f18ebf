"""A real browser: headless Chromium, shared by the tests of a process.

A `conftest.py` that wants it says `from browser import browser, page`. Tests of pages that cannot
have it skip, with one reason.
"""

from __future__ import annotations

import os
import shutil
from importlib.util import find_spec
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator

    from playwright.sync_api import Browser, Page

PATIENCE = 30_000
"""Milliseconds that a page may take for what it is asked; the machine may be busy."""

_NAMES = ("chromium", "chromium-browser", "google-chrome")


def executable() -> str:
    """Returns the path of Chromium, empty where there is none; CHROMIUM names another."""
    named = os.environ.get("CHROMIUM", "")
    return named or next(filter(None, map(shutil.which, _NAMES)), "")


def missing() -> str:
    """Returns what pages are not tested for, empty where nothing is missing."""
    if find_spec("playwright") is None:
        return "pages need playwright: pip install playwright"
    return "" if executable() else "pages need Chromium: apt-get install chromium"


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """Headless Chromium."""
    if missing():
        pytest.skip(missing())
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        found = playwright.chromium.launch(executable_path=executable(), timeout=2 * PATIENCE)
        yield found
        found.close()


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    """A page of its own, which fails the test where its script fails or its policy is broken."""
    context = browser.new_context(viewport={"width": 1280, "height": 800})
    context.set_default_timeout(PATIENCE)
    made = context.new_page()
    faults: list[str] = []
    made.on("pageerror", lambda error: faults.append(str(error)))
    made.on("console", lambda said: faults.append(said.text) if said.type == "error" else None)
    yield made
    context.close()
    assert not faults
