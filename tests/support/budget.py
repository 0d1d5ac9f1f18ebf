"""A time for a run of tests, `-p budget --budget 15`: what is left after it is skipped."""

from __future__ import annotations

import time

import pytest

START = time.monotonic()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Adds the option."""
    parser.addoption("--budget", type=float, metavar="SECONDS", help="skip what starts after it")


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skips a test that would start too late."""
    if time.monotonic() - START > item.config.getoption("budget"):
        pytest.skip("out of time: make test runs it")
