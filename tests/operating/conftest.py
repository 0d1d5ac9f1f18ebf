from collections.abc import Iterator
from pathlib import Path

import pytest
from ports import free_port
from simulated_vehicle import LEASE, STOP, VEHICLE, Vehicle, take, until
from studio_client import Page, Server, operating


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A page as small as one can be."""
    folder = tmp_path_factory.mktemp("page")
    (folder / "index.html").write_text("<!doctype html><title>page</title>", encoding="utf-8")
    return folder


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder without a model."""
    return tmp_path


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
    options = ("--stop-all", "standby", "--lease", str(LEASE), "--stop", STOP)
    with operating(folder, built, *options, "--jaus-port", str(port)) as server:
        yield server


@pytest.fixture
def commanding(operated: Server) -> Iterator[Page]:
    with operated.page() as page:
        page.ask("claim", right=operated.right, name="anna")
        yield page
    until(lambda: is_idle(operated))


def is_idle(server: Server) -> bool:
    """Whether what pages commanded is stopped: a stop that is late would reach the next vehicle."""
    with server.page() as page:
        state = page.project["state"]
    return state["commander"] is None and not state["holds"]


@pytest.fixture
def holding(vehicle: Vehicle, commanding: Page) -> Page:
    """A page that controls the vehicle, which is Ready."""
    take(commanding)
    commanding.ask("resume", component=VEHICLE)
    assert vehicle.status == "READY"
    return commanding
