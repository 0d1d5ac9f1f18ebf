"""One browser for the tests of a module."""

import needs
import pytest

UNSEEN = ("WebUIOmniboxPopup", "WebUIOmniboxAimPopup", "SpareRendererForSitePerProcess")
"""What each window would begin beside its page, which takes longer than most pages: what drops
from the line for addresses, and a process for the next site."""
PATIENCE = 40_000
"""Milliseconds: long enough for a computer that is busy with other tests."""


@pytest.fixture(scope="module")
def chromium():
    """A browser without windows; it is ended soon, for its driver runs an event loop here."""
    needs.ask("chromium")
    from playwright.sync_api import expect, sync_playwright

    expect.set_options(timeout=PATIENCE)
    with sync_playwright() as playwright:
        line = [f"--disable-features={','.join(UNSEEN)}"]
        started = playwright.chromium.launch(executable_path=needs.CHROMIUM, args=line)
        yield started
        started.close()
