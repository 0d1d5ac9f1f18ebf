"""Lists that a page has drawn: their bytes, their way, and what ends them, at a real component."""

import math
import time
from typing import Any

import pytest
from lossy_network import LossyTransport
from simulated_vehicle import VEHICLE, Vehicle, take, until
from studio_client import Page, RefusedError, Server, operating

from jausml import Component
from jausml.runtime.component import process

pytestmark = pytest.mark.ports

LOCAL, GLOBAL = "SetLocalWaypoint", "SetGlobalWaypoint"
ROUTE = [{"X": 3.0, "Y": -4.0}, {"X": 6.5, "Y": 0.0}, {"X": 0.0, "Y": 2.0}]


@pytest.fixture
def server(operated: Server) -> Server:
    return operated


def drawn(page: Page, elements: list[dict[str, float]] = ROUTE, message: str = LOCAL) -> Any:
    return page.ask("list.set", component=VEHICLE, message=message, elements=elements)


def execute(page: Page, elements: list[dict[str, float]] = ROUTE, first: int = 1) -> Any:
    asked = {"component": VEHICLE, "message": LOCAL, "elements": elements, "first": first}
    return page.ask("list.execute", speed=1.5, **asked)


def journal(page: Page) -> list[str]:
    return [entry["text"] for entry in page.ask("journal")["entries"]]


def scaled(value: float, low: float, high: float) -> bytes:
    """The 32 bits of a number (AS5684: offset and scale of the range), computed apart."""
    return math.floor((value - low) / (high - low) * (2**32 - 1) + 0.5).to_bytes(4, "little")


def test_a_list_arrives_as_it_is_drawn(holding, vehicle):
    drawn(holding)
    # X forward or north and Y right or east keep their signs; no optional field is made up.
    assert [element.data for element in vehicle.list] == [
        b"\x0d\x04\x00" + scaled(x, -1e5, 1e5) + scaled(y, -1e5, 1e5)
        for x, y in ((3, -4), (6.5, 0), (0, 2))
    ]
    assert vehicle.list[0].data.hex() == "0d0400a8fb008074b0fe7f"
    chained = [(element.uid, element.previous_uid, element.next_uid) for element in vehicle.list]
    assert chained == [(1, 0, 2), (2, 1, 3), (3, 2, 0)]
    assert vehicle.executed == []
    assert any("list of 3 SetLocalWaypoint to 100.1.10: 1: X=" in text for text in journal(holding))


def test_a_list_is_executed_in_its_order_and_told(holding, vehicle):
    drawn(holding)
    holding.ask("watch", component=VEHICLE, report="ActiveElement", rate=5)

    def active() -> str:
        values: str = holding.ask("values")["values"][0]["fields"][0][1]
        return values

    assert execute(holding)["time"]
    places = []
    for uid in ("1", "2", "3"):
        until(lambda uid=uid: active() == uid)
        vehicle.reach()
        places.append(tuple(round(coordinate, 3) for coordinate in vehicle.place))
    until(lambda: active() == "0")
    assert places == [(3.0, -4.0), (6.5, 0.0), (0.0, 2.0)]
    assert vehicle.executed == [(1.5, 1)]


def test_what_the_vehicle_does_not_have_is_not_executed(holding, vehicle):
    for elements in (ROUTE, ROUTE[:2], [*ROUTE[:2], {"X": 0.0, "Y": 2.1}]):
        with pytest.raises(RefusedError, match="another list than the one that is drawn"):
            execute(holding, elements)
        if elements is ROUTE:
            drawn(holding)
    assert vehicle.executed == []


@pytest.mark.parametrize(
    ("element", "path"),
    [({"X": 100000.5, "Y": 0.0}, "X"), ({"X": 0.0}, "Y"), ({"X": 0.0, "Y": 0.0, "Yaw": 4}, "Yaw")],
)
def test_a_waypoint_out_of_range_is_refused_at_its_place(holding, vehicle, element, path):
    drawn(holding)
    with pytest.raises(RefusedError) as refused:
        drawn(holding, [ROUTE[0], element])
    assert refused.value.data["path"] == f"elements[1].LocalWaypointRec.{path}"
    assert len(vehicle.list) == 3


def test_a_speed_out_of_range_is_refused(holding, vehicle):
    drawn(holding)
    with pytest.raises(RefusedError) as refused:
        holding.ask(
            "list.execute", component=VEHICLE, message=LOCAL, elements=ROUTE, speed=400.0, first=1
        )
    assert refused.value.data["path"].endswith("Speed")
    assert vehicle.executed == []


@pytest.mark.parametrize("elements", [[], [ROUTE[0]] * 1001])
def test_no_list_and_too_long_ones_are_refused(holding, elements):
    with pytest.raises(RefusedError, match="1 to 1000"):
        drawn(holding, elements)


def test_a_component_without_the_driver_is_told_no_list(holding, vehicle):
    with pytest.raises(RefusedError, match="no driver for lists of SetGlobalWaypoint"):
        drawn(holding, [{"Latitude": 48.0, "Longitude": 11.0}], GLOBAL)
    assert vehicle.list == []


def test_its_end_leaves_nothing_that_could_go_on(holding, vehicle):
    drawn(holding)
    execute(holding)
    holding.ask("list.end", component=VEHICLE)
    assert vehicle.executed == [(1.5, 1), (0.0, None)]
    assert vehicle.list == []


def test_a_page_that_is_lost_while_it_drives_stops_it(server, holding, vehicle):
    drawn(holding)
    execute(holding)
    assert vehicle.active == 1
    holding.socket.close()
    until(lambda: vehicle.status == "STANDBY" and vehicle.controller is None)
    assert vehicle.active == 0
    # What was drawn is sent again by a person alone.
    with server.page() as page:
        page.ask("claim", right=server.right, name="berta")
        take(page)
        page.ask("resume", component=VEHICLE)
    assert vehicle.executed == [(1.5, 1)]


def test_a_silent_page_stops_what_it_executes(holding, vehicle):
    drawn(holding)
    execute(holding)
    until(lambda: vehicle.status == "STANDBY" and vehicle.controller is None)
    assert vehicle.active == 0
    with pytest.raises(RefusedError, match="nobody commands"):
        execute(holding)


@pytest.mark.slow
def test_an_emergency_ends_it_where_the_person_chose_that(folder, built, port, vehicle):
    options = ("--stop-all", "emergency", "--lease", "1", "--jaus-port", str(port))
    with operating(folder, built, *options) as server, server.page() as page:
        page.ask("claim", right=server.right, name="")
        take(page)
        page.ask("resume", component=VEHICLE)
        drawn(page)
        execute(page)
        until(lambda: vehicle.status == "EMERGENCY")
        assert vehicle.active == 0
        page.ask("clear", component=VEHICLE)


@pytest.fixture
def lossy(monkeypatch: pytest.MonkeyPatch) -> list[LossyTransport]:
    """The transports that are made from now on, which lose a fifth of what comes."""
    made: list[LossyTransport] = []

    def new(settings: Any, loop: Any) -> LossyTransport:
        made.append(LossyTransport(settings, loop, 0.2, seed=7))
        return made[-1]

    monkeypatch.setattr(process, "JudpTransport", new)
    return made


@pytest.mark.slow
def test_where_a_fifth_is_lost_the_list_is_whole_and_in_order(folder, built, port, lossy):
    long = [{"X": float(at), "Y": -float(at)} for at in range(150)]
    options = ("--stop-all", "standby", "--lease", "60", "--jaus-port", str(port))
    with (
        Vehicle(port) as vehicle,
        operating(folder, built, *options) as server,
        server.page() as page,
    ):
        page.ask("claim", right=server.right, name="")
        take(page)
        until(lambda: is_done(page, "resume", component=VEHICLE))
        until(lambda: is_done(page, "list.set", component=VEHICLE, message=LOCAL, elements=long))
        assert [element.uid for element in vehicle.list] == list(range(1, 151))
    assert sum(transport.counters.snapshot()["lost"] for transport in lossy) > 0


def test_a_stop_ends_what_is_being_set(commanding, port, lossy):
    with Vehicle(port) as vehicle:
        for transport in lossy:
            transport.share = 0.0
        take(commanding)
        commanding.ask("messages", component=VEHICLE)  # what it provides is known from now on
        for transport in lossy:
            transport.share = 1.0
        asked = {"component": VEHICLE, "message": LOCAL, "elements": ROUTE}
        setting = commanding.send("list.set", **asked)
        noted = "list of 3 SetLocalWaypoint"
        commanding.await_told("operate.journal", lambda told: noted in told["entry"]["text"])
        commanding.send("stop")
        with pytest.raises(RefusedError, match="stopped meanwhile"):
            commanding.answer(setting)
        for transport in lossy:
            transport.share = 0.0
        # Longer than the unit repeats what is not answered.
        time.sleep(1.5)
        assert vehicle.list == []


def test_a_change_of_state_that_nobody_reports_is_not_called_done(commanding, port, lossy):
    with Vehicle(port):
        for transport in lossy:
            transport.share = 0.0
        take(commanding)
        for transport in lossy:
            transport.share = 1.0
        for method in ("resume", "clear"):
            with pytest.raises(RefusedError, match=r"but not (Resume|ClearEmergency)"):
                commanding.ask(method, component=VEHICLE)
        for transport in lossy:
            transport.share = 0.0


def is_done(page: Page, method: str, **params: Any) -> bool:
    try:
        page.ask(method, **params)
    except RefusedError:
        return False
    return True


@pytest.mark.parametrize(
    ("latitude", "longitude", "data"),
    [(0.0, 0.0, None), (-33.5, 151.25, None), (90.0, -180.0, "0c0400ffffffff00000000"),
     (-90.0, 180.0, "0c040000000000ffffffff")],
)  # fmt: skip
def test_global_waypoints_have_latitude_before_longitude(
    commanding, port, latitude, longitude, data
):
    component = Component("100.1.11", provides="GlobalWaypointListDriver", name="g", port=port)
    with component:
        take(commanding, "100.1.11")
        elements = [{"Latitude": latitude, "Longitude": longitude}]
        commanding.ask("list.set", component="100.1.11", message=GLOBAL, elements=elements)
        [element] = component._operator._component.elements
        told = scaled(latitude, -90, 90) + scaled(longitude, -180, 180)
        assert element.data == b"\x0c\x04\x00" + told
        assert data in (None, element.data.hex())
        commanding.ask("release", component="100.1.11")
