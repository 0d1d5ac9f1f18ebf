"""A time for a run of tests, `-p budget --budget 15`: what is left after it is skipped."""

import time

import pytest

BEGAN = pytest.StashKey[float]()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Adds the option."""
    parser.addoption("--budget", type=float, metavar="SECONDS", help="skip what starts after it")


def pytest_collection_finish(session: pytest.Session) -> None:
    """Begins the time: on a busy computer there would be none left after all files were read."""
    session.config.stash[BEGAN] = time.monotonic()


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skips a test that would start too late."""
    spent = time.monotonic() - item.config.stash[BEGAN]
    if spent > item.config.getoption("budget"):
        pytest.skip("out of time: make test runs it")
