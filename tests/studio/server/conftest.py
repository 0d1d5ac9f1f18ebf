from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from ports import free_port
from simulated_vehicle import LEASE, STOP, VEHICLE, Vehicle, take, until
from studio_client import serving

from jausml.language.model.library import LIBRARY_URI

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from studio_client import Page, Server

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


# ---- operating: a studio whose pages may command, and a vehicle ----------------------------------


@pytest.fixture(scope="module")
def port() -> int:
    return free_port()


@pytest.fixture
def vehicle(port: int) -> Iterator[Vehicle]:
    with Vehicle(port) as vehicle:
        yield vehicle


@pytest.fixture(scope="module")
def operated(tmp_path_factory: pytest.TempPathFactory, built: Path, port: int) -> Iterator[Server]:
    folder = tmp_path_factory.mktemp("project")
    options = ("--operate", "standby", "--lease", str(LEASE), "--stop", STOP)
    with serving(folder, built, *options, "--jaus-port", str(port)) as server:
        yield server


@pytest.fixture
def commanding(operated: Server) -> Iterator[Page]:
    with operated.page("/operate") as page:
        page.ask("claim", right=operated.right, name="anna")
        yield page
    until(lambda: is_idle(operated))


def is_idle(server: Server) -> bool:
    """Whether what pages commanded is stopped: a stop that is late would reach the next vehicle."""
    with server.page("/operate") as page:
        state = page.project["state"]
    return state["commander"] is None and not state["holds"]


@pytest.fixture
def holding(vehicle: Vehicle, commanding: Page) -> Page:  # noqa: ARG001 - it is there
    """A page that controls the vehicle, which is Ready."""
    take(commanding)
    assert commanding.ask("resume", component=VEHICLE)["state"] == "READY"
    return commanding
