"""Lets the tests import what they share with each other and with the generators', and a page."""

import sys
from pathlib import Path

import pytest
from browser import PATIENCE

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent / "generators")]


@pytest.fixture
def page(chromium):
    """A page of its own, whose script must not fail and whose policy must not be broken."""
    context = chromium.new_context(viewport={"width": 1280, "height": 800})
    made = context.new_page()
    made.set_default_timeout(PATIENCE)
    faults = []
    made.on("pageerror", lambda error: faults.append(str(error)))
    made.on("console", lambda said: faults.append(said.text) if said.type == "error" else None)
    yield made
    context.close()
    assert not faults
