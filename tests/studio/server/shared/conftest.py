"""One process for all tests here: it begins in seconds, and they leave nothing behind."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from studio_client import Page, Server, serving

from jausml.language.model.library import LIBRARY_URI


@pytest.fixture(scope="package")
def folder(
    tmp_path_factory: pytest.TempPathFactory, new_project: Callable[[Path], Path], models: Path
) -> Path:
    """A project and a service beside it, whose edits are undone after each test."""
    root = new_project(tmp_path_factory.mktemp("shared"))
    text = (models / "examples" / "winch" / "service.xmi").read_text(encoding="utf-8")
    text = text.replace("../../library/", LIBRARY_URI)
    (root / "service.xmi").write_text(text, encoding="utf-8")
    return root


@pytest.fixture(scope="package")
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
