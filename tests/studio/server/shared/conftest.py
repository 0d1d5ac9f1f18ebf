"""One process for the tests of a file: it begins in seconds, and they leave nothing behind."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from studio_client import serving

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from studio_client import Page, Server


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, new_project: Callable[[Path], Path]) -> Path:
    """A project whose edits are undone after each test."""
    return new_project(tmp_path_factory.mktemp("shared"))


@pytest.fixture(scope="module")
def server(folder: Path, built: Path) -> Iterator[Server]:
    with serving(folder / "catvehicle.xmi", built) as server:
        yield server


@pytest.fixture(autouse=True)
def _undone(server: Server) -> Iterator[None]:
    """Undoes what a test has edited, by whichever page."""
    with server.page() as page:
        before = page.ask("log")["at"]
    yield
    with server.page() as page:
        while page.ask("log")["at"] > before:
            page.ask("undo")


@pytest.fixture
def page(server: Server, _undone: None) -> Iterator[Page]:
    with server.page() as page:
        yield page
