"""The operator unit in one process: whom its stops are for, and what they keep from being sent."""

import asyncio
import re
import webbrowser
from collections.abc import Iterator
from contextlib import AsyncExitStack, suppress
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from simulated_vehicle import VEHICLE, Vehicle, until
from starlette.types import Message
from starlette.websockets import WebSocket

from jausml import Component
from jausml.cli.live.operate import _opened
from jausml.live.messages import load_catalogue
from jausml.live.operating.guarding import UnitGuardian
from jausml.live.operating.reading import read
from jausml.live.operating.seats import Seat
from jausml.live.operating.serving import KEPT_SOCKETS, UnitSockets
from jausml.live.operating.unit import OperatorUnit, Powers
from jausml.live.peers.control import Hold
from jausml.live.peers.network import DEFAULT_GROUP, make_network
from jausml.live.peers.operator import Operator, running_operator
from jausml.live.peers.query_client import NoAnswer, Refused
from jausml.live.serving.rpc import Request, RpcError, parsed
from jausml.live.serving.server import MOST_SOCKETS
from jausml.live.serving.subscribers import Subscribers
from jausml.runtime import ControlState
from jausml.runtime.base.address import JausAddress

pytestmark = pytest.mark.ports


@pytest.fixture
def unit(tmp_path: Path, port: int) -> Iterator[OperatorUnit]:
    """A unit, of which page 1 may take control."""
    network = make_network(None, "127.0.0.1", port, DEFAULT_GROUP, ())
    unit = OperatorUnit(read(tmp_path), network, Powers("standby", 60.0), lambda *_: None)
    unit.system.start()
    yield unit
    unit.system.stop()


ADDRESS = JausAddress.parse(VEHICLE)
WAYPOINTS = Path(__file__).parents[2] / "models" / "examples" / "waypoints" / "waypoints.ros2jaus"


def take_in(unit: OperatorUnit) -> Hold:
    def taken() -> bool:
        with suppress(Refused, NoAnswer):
            unit.take(1, "anna", ADDRESS, 205)
        return bool(unit.system.operator.holds)

    until(taken)
    return unit.system.operator.holds[0]


def guarded(unit: OperatorUnit) -> list[JausAddress]:
    assert unit.sticks.guardian is not None
    return list(unit.sticks.guardian._controlled)


@pytest.mark.usefixtures("vehicle")
def test_what_a_higher_authority_has_taken_is_not_stopped(unit, port):
    hold = take_in(unit)
    assert guarded(unit) == [ADDRESS]
    network = make_network(None, "127.0.0.1", port, DEFAULT_GROUP, ())
    with running_operator(network, load_catalogue()) as other:
        until(lambda: controlled_by(other))
        until(lambda: hold.session and hold.session.state is ControlState.REFUSED)
        assert unit.stop_all("anna", ()) == []
        until(lambda: guarded(unit) == [])
        other.release(ADDRESS)


def controlled_by(other: Operator) -> bool:
    with suppress(Refused, NoAnswer):
        other.control(ADDRESS, 220)
    return other.controls(ADDRESS)


@pytest.mark.usefixtures("vehicle")
def test_what_is_controlled_is_not_taken_again(unit):
    hold = take_in(unit)
    with pytest.raises(Refused, match="is controlled already"):
        unit.take(1, "anna", ADDRESS, 210)
    assert (unit.system.operator.holds, hold.is_held) == ((hold,), True)


def test_what_does_not_answer_any_more_is_stopped_all_the_same(unit, port):
    with Vehicle(port):
        hold = take_in(unit)
    until(lambda: hold.session and hold.session.state is ControlState.SEEKING)
    assert guarded(unit) == [ADDRESS]
    stopped = {"component": VEHICLE, "outcome": "its state is not told", "confirmed": False}
    assert unit.stop_all("anna", ()) == [stopped]


@pytest.mark.parametrize("is_closed", [True, False], ids=["closed", "reads nothing"])
def test_a_page_that_gives_way_does_not_hold_up_the_next_one(unit, is_closed):
    """Places are kept, whatever becomes of the socket that gives way."""

    async def receive() -> dict[str, str]:
        return {"type": "websocket.connect"}

    async def send(message: Message) -> None:
        if message["type"] == "websocket.close" and not is_closed:
            await asyncio.Event().wait()

    async def served() -> list[bool]:
        sockets = UnitSockets()
        async with AsyncExitStack() as open_sockets:
            accepted = []
            for _ in range(MOST_SOCKETS + KEPT_SOCKETS + 1):
                page = WebSocket({"type": "websocket"}, receive, send)
                sockets.seats[page] = looking
                accepted.append(await open_sockets.enter_async_context(sockets.accepted(page)))
                if is_closed and len(accepted) == 1:
                    await page.close()
            return accepted

    looking = Seat(unit, Subscribers(), 1)
    assert all(asyncio.run(asyncio.wait_for(served(), 60)))


def test_the_guardian_says_whom_it_could_not_stop(port):
    network = make_network(None, "127.0.0.1", port, DEFAULT_GROUP, ())
    with running_operator(network, load_catalogue()) as operator:
        guardian = UnitGuardian(operator, 2.0, "standby", lambda: None)
        assert guardian.failure == ""
        guardian.control([JausAddress(100, 1, 99)])  # of which nothing was heard
        assert guardian.failure == "has no datagram for 100.1.99"
        guardian.close()


def test_commands_that_a_bridge_does_not_take_are_not_offered(unit, port, tmp_path):
    def offered(text: str) -> set[str]:
        model = tmp_path / "waypoints.ros2jaus"
        model.write_text(text, encoding="utf-8")
        unit.learn(read(model))
        return {command["name"] for command in unit.offers(ADDRESS)["commands"]}

    text = WAYPOINTS.read_text(encoding="utf-8")
    without_speed = re.sub(r"connection travel_speed \{.*?\n    \}", "", text, flags=re.DOTALL)
    both = {"SetLocalWaypoint", "SetTravelSpeed"}
    with Component(VEHICLE, provides=("LocalWaypointDriver",), port=port):
        until(lambda: both <= offered(text))
        assert both & offered(without_speed) == {"SetLocalWaypoint"}


def test_what_was_asked_before_a_stop_is_not_sent_after_it(unit, vehicle):
    take_in(unit)

    async def ask() -> None:
        seat = Seat(unit, Subscribers(), 1)
        seat.may_command = True
        with seat.subscribed(lambda _: None):
            # As many as there are threads, of components that nobody answers for.
            slow = [asked(seat, "messages", component=f"100.2.{number}") for number in range(1, 9)]
            late = asked(seat, "resume", component=VEHICLE)
            await asyncio.sleep(0)  # so far all have begun
            await asked(seat, "stop")
            with pytest.raises(RpcError, match="a stop came before"):
                await late
            await asyncio.gather(*slow, return_exceptions=True)

    asyncio.run(ask())
    assert vehicle.status == "STANDBY"


def asked(seat: Seat, method: str, **params: Any) -> asyncio.Task[object]:
    return asyncio.create_task(seat.answer(Request(method, params, 1)))


@pytest.mark.usefixtures("vehicle")
def test_control_is_released_also_where_a_stop_fails(unit, monkeypatch):
    def stop_all(*_: object) -> None:
        raise RuntimeError("a fault of ours")

    take_in(unit)
    monkeypatch.setattr(unit, "stop_all", stop_all)
    with pytest.raises(RuntimeError):
        unit.leave(1)
    assert unit.system.operator.holds == ()
    monkeypatch.undo()


@pytest.mark.parametrize("number", ["1e999", "-1e999", "1e300"])
def test_an_id_that_no_answer_could_have_is_refused(number):
    with pytest.raises(RpcError, match="too large"):
        parsed(f'{{"jsonrpc": "2.0", "id": {number}, "method": "renew"}}')


def test_the_browser_is_not_told_the_right_to_command(monkeypatch, capsys):
    opened: list[str] = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    unit: Any = SimpleNamespace(address="looking", commanding_address="commanding")
    _opened(unit, no_browser=False)
    assert opened == ["looking"]
    assert "to command: commanding\n" in capsys.readouterr().out
