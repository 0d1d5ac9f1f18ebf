from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from studio_client import Page, Server, serving

from jausml.language.model.library import LIBRARY_URI

MODELS = Path(__file__).parents[3] / "models"


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A page as small as one can be."""
    folder = tmp_path_factory.mktemp("page")
    (folder / "index.html").write_text("<!doctype html><title>page</title>", encoding="utf-8")
    (folder / "assets").mkdir()
    (folder / "assets" / "page.js").write_text("'use strict'", encoding="utf-8")
    return folder


@pytest.fixture(scope="session")
def models() -> Path:
    """The shipped models."""
    return MODELS


@pytest.fixture(scope="session")
def new_project() -> Callable[[Path], Path]:
    """Makes a project in a folder."""
    return made


def made(beside: Path) -> Path:
    root = beside / "project"
    root.mkdir()
    text = (MODELS / "catvehicle" / "catvehicle.xmi").read_text(encoding="utf-8")
    text = text.replace("../library/", LIBRARY_URI)
    (root / "catvehicle.xmi").write_text(text, encoding="utf-8")
    return root


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A project that may be changed."""
    return made(tmp_path)


@pytest.fixture
def server(folder: Path, built: Path) -> Iterator[Server]:
    with serving(folder / "catvehicle.xmi", built) as server:
        yield server


@pytest.fixture
def page(server: Server) -> Iterator[Page]:
    with server.page() as page:
        yield page
