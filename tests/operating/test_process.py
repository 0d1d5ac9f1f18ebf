"""A process of its own: what it does not load, what it learns, and what is said when it is gone."""

import json
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path

import pytest
from large_systems import large_system
from scripts import succeeded
from simulated_vehicle import STOP, TIMEOUT, VEHICLE, Vehicle, take, until
from studio_client import Page, RefusedError, Server, operating, started

from jausml.language.model.library import LIBRARY_URI

pytestmark = pytest.mark.ports

WINCH = Path(__file__).parents[2] / "models" / "examples" / "winch" / "service.xmi"
GAPS = Path(__file__).parents[1] / "support" / "gap_process.py"

LEASE = 2.0
OPTIONS = ("--stop-all", "standby", "--lease", str(LEASE), "--stop", STOP)
LONGEST_WORK = 0.05
GROUPS = 72
"""21 elements a group: fifteen hundred in all."""


def test_it_loads_nothing_that_reads_models():
    code = "import sys; from jausml.cli.live import operate;"
    code += "from jausml.live.operating import serving; print('\\n'.join(sys.modules))"
    line = [sys.executable, "-c", code]
    loaded = succeeded(line).stdout.split()
    heavy = ("jausml.authoring", "jausml.language.metamodel", "jausml.language.model", "pyecore")
    assert [name for name in loaded if name.startswith(heavy)] == []


def test_services_that_are_modelled_after_its_start_are_learnt(folder, built, port):
    asked = {"component": VEHICLE, "message": "SetWinchCommand"}
    with operating(folder, built, "--jaus-port", str(port)) as server, server.page() as page:
        until(lambda: page.project["state"]["own"] or page.await_told("operate.state")["own"])
        with pytest.raises(RefusedError, match="no message 'SetWinchCommand'"):
            page.ask("form", **asked)
        (folder / "half.ros2jaus").write_text("service_set {", encoding="utf-8")
        text = WINCH.read_text(encoding="utf-8").replace("../../library/", LIBRARY_URI)
        (folder / "service.xmi").write_text(text, encoding="utf-8")

        def learnt() -> list[str]:
            page.await_told("operate.learnt")
            try:
                [record] = page.ask("form", **asked)["fields"]
            except RefusedError:
                return []
            return [member["name"] for member in record["members"]]

        assert until(learnt) == ["RopeSpeed"]


# ---- when it is gone -----------------------------------------------------------------------------


@contextmanager
def driving(folder: Path, built: Path, port: int, vehicle: Vehicle) -> Iterator[Server]:
    """A unit of its own process whose page drives the vehicle, and says so until it is gone."""
    process = started(folder, built, *OPTIONS, "--jaus-port", str(port), verb="operate")
    try:
        assert process.stdout is not None
        addresses = [process.stdout.readline().strip().partition(": ")[2] for _ in range(2)]
        server = Server(process, *addresses)
        with server.connect() as socket:
            page = page_of(socket, server)
            assert vehicle.status == "READY"
            number = page.ask("stick.begin", component=VEHICLE, message="SetWrenchEffort")["stick"]
            for _ in range(3):
                fields = {"PropulsiveLinearEffortX": 30.0}
                page.ask("stick.move", stick=number, fields=fields)
            until(lambda: vehicle.last == 30.0)
            yield server
    finally:
        process.kill()
        process.communicate()


def page_of(socket: object, server: Server) -> Page:
    from studio_client import Page

    page = Page(socket)  # type: ignore[arg-type]
    page.project = page.ask("hello", token=server.token)
    page.ask("claim", right=server.right, name="anna")
    take(page)
    page.ask("resume", component=VEHICLE)
    return page


def test_a_unit_that_is_killed_has_its_stops_said(folder, built, port, vehicle):
    with driving(folder, built, port, vehicle) as server:
        server.process.kill()
        until(lambda: vehicle.last == 0.0)
        until(lambda: vehicle.status == "STANDBY")
        _, log = server.process.communicate()
    assert f"guardian: the operator unit (process {server.process.pid}) has died: 2 stops" in log


def test_a_unit_that_stands_still_has_its_stops_said_and_says_so(folder, built, port, vehicle):
    with driving(folder, built, port, vehicle) as server:
        server.process.send_signal(signal.SIGSTOP)
        until(lambda: vehicle.last == 0.0)
        moved = {effort: moment for moment, effort in vehicle.efforts}
        # Not sooner either: what lives shorter than is said could not be held.
        assert moved[0.0] - moved[30.0] >= TIMEOUT / 2
        until(lambda: vehicle.status == "STANDBY")
        server.process.send_signal(signal.SIGCONT)
        with server.page() as page:
            texts = lambda told: [alarm["text"] for alarm in told["alarms"]]  # noqa: E731
            told = "it stood still, and its guardian said the stops"
            page.await_told("operate.state", lambda state: told in texts(state))


# ---- beside others -------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_an_edit_of_a_large_model_does_not_hold_it_up(folder, built, port, vehicle):
    """Fifteen hundred elements are edited, which a child of the unit reads; a stick is held."""
    model = folder / "large.ros2jaus"
    text = large_system(GROUPS)
    model.write_text(text, encoding="utf-8")
    stop = "SetWrenchEffort 60 PropulsiveLinearEffortX=0"  # this page waits for the edits too
    options = ("--stop-all", "standby", "--lease", "60", "--stop", stop, "--jaus-port", str(port))
    with operating(model, built, *options, start=partial(started, script=GAPS)) as unit:
        with unit.connect() as socket:
            page = page_of(socket, unit)
            asked = {"component": VEHICLE, "message": "SetWrenchEffort"}
            number = page.ask("stick.begin", **asked)["stick"]
            model.write_text(f"{text}// Edited.\n", encoding="utf-8")
            while not any(told["method"] == "operate.learnt" for told in page.told):
                page.ask("renew")
                fields = {"PropulsiveLinearEffortX": 9.0}
                with suppress(RefusedError):  # the vehicle is here, and as busy as all is
                    page.ask("stick.move", stick=number, fields=fields)
                time.sleep(0.02)
        unit.process.send_signal(signal.SIGTERM)
        assert unit.process.stderr is not None
        _, _, told = unit.process.stderr.read().partition("worked ")
    worked = json.loads(told.splitlines()[0])
    assert max(worked["longest"]) < LONGEST_WORK, worked["longest"]
    assert worked["collections"] == []
    assert worked["readers"] == []
    assert min(worked["turns"]) >= 1
    assert vehicle.last == 0.0
