"""Who may command by a page, and what stops when nobody does, with a real component."""

import fcntl
import signal
import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from typing import Any

import pytest
import warm
from simulated_vehicle import LEASE, STOP, TIMEOUT, VEHICLE, Vehicle, take, until
from studio_client import LONGEST, Page, RefusedError, Server, begun, operating
from websockets.exceptions import ConnectionClosed, InvalidStatus

from jausml.live.operating.reading import read
from jausml.live.operating.serving import KEPT_SOCKETS
from jausml.live.operating.stops import TRIES
from jausml.live.operating.unit import OperatorUnit, Powers
from jausml.live.peers.network import DEFAULT_GROUP, make_network
from jausml.live.peers.query_client import NoAnswer, Refused
from jausml.live.recording.mcap_reading import McapRecording
from jausml.live.serving.server import MOST_SOCKETS
from jausml.runtime import ComponentSettings, HandoffAnswer, JausComponent, ServiceIdentity
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.component.process import running_transport
from jausml.runtime.messages import SetEmergency
from jausml.runtime.services.definitions import CORE
from jausml.runtime.transports.transport import Transport

pytestmark = pytest.mark.ports

REFUSED, UNAUTHORIZED, BUSY = -32000, -32001, -32002
COMMANDS: dict[str, dict[str, Any]] = {
    "renew": {},
    "take": {"component": VEHICLE, "authority": 205},
    "release": {"component": VEHICLE},
    "resume": {"component": VEHICLE},
    "standby": {"component": VEHICLE},
    "send": {"component": VEHICLE, "message": "SetWrenchEffort", "fields": {}},
    "stop": {},
    "clear": {"component": VEHICLE},
    "silence": {"numbers": [1], "reason": "seen"},
    "handoff": {"component": VEHICLE, "authority": 205, "reason": ""},
    "decide": {"component": VEHICLE, "number": 0, "decision": "grant"},
    "list.set": {"component": VEHICLE, "message": "SetLocalWaypoint", "elements": []},
    "list.execute": {
        "component": VEHICLE,
        "message": "SetLocalWaypoint",
        "elements": [],
        "speed": 1.0,
        "first": 1,
    },
    "list.end": {"component": VEHICLE},
    "stick.begin": {"component": VEHICLE, "message": "SetWrenchEffort"},
    "stick.move": {"stick": 1, "fields": {}},
    "stick.end": {"stick": 1},
}


@pytest.fixture(scope="module")
def server(operated: Server) -> Server:
    return operated


def nobody_commands(server: Server) -> bool:
    with server.page() as page:
        return page.project["state"]["commander"] is None


# ---- the right -----------------------------------------------------------------------------------


def test_each_command_is_refused_without_the_right(server):
    with server.page() as page:
        for method, params in COMMANDS.items():
            with pytest.raises(RefusedError) as refused:
                page.ask(method, **params)
            assert refused.value.code == UNAUTHORIZED, method
        assert page.project["can_command"]


@pytest.mark.usefixtures("vehicle")
def test_pages_that_look_leave_places_to_those_that_may_command(server):
    with ExitStack() as held:
        looking = [held.enter_context(server.page()) for _ in range(MOST_SOCKETS)]
        late = [held.enter_context(server.page()) for _ in range(2 * KEPT_SOCKETS)]
        page = held.enter_context(server.page())
        page.ask("claim", right=server.right, name="person")
        for _ in range(2 * KEPT_SOCKETS):
            late.append(held.enter_context(server.page()))
        assert page.ask("stop", components=[VEHICLE])["stopped"]
        with pytest.raises(ConnectionClosed) as closed:
            looking[0].ask("journal")
        assert late[-1].ask("journal")["entries"]
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 1013


def test_a_page_that_asks_without_end_is_read_slowly(server):
    with server.page() as flooding, server.page() as other:
        other.ask("claim", right=server.right, name="person")
        for _ in range(60):
            flooding.send("claim", right="wrong" * 50_000, name="")

        def asked() -> int:
            entries = other.ask("journal")["entries"]
            return sum(entry["who"] == f"page {flooding.project['page']}" for entry in entries)

        until(lambda: asked() >= 30)
        assert max(asked() for _ in range(10)) < 60
        flooding.socket.socket.shutdown(socket.SHUT_RDWR)  # a close waits until all is read


def test_a_stop_is_never_one_request_too_many(server):
    with server.page() as page:
        for number in range(1, 101):  # of components that nobody answers for
            page.send("messages", component=f"100.2.{number}")
        for method, code in (("journal", BUSY), ("stop", UNAUTHORIZED), ("renew", UNAUTHORIZED)):
            with pytest.raises(RefusedError) as refused:
                page.ask(method)
            assert refused.value.code == code, method


@pytest.mark.parametrize("right", ["", "wrong"])
def test_another_right_is_none(server, right):
    with server.page() as page:
        for claimed in (right, server.token):
            with pytest.raises(RefusedError) as refused:
                page.ask("claim", right=claimed, name="")
            assert refused.value.code == UNAUTHORIZED
        with pytest.raises(RefusedError) as refused:
            page.ask("take", component=VEHICLE, authority=205)
        assert refused.value.code == UNAUTHORIZED


def test_the_right_does_not_open_a_socket(server):
    assert server.right not in ("", server.token)
    with server.connect("/socket") as socket:
        socket.send(
            f'{{"jsonrpc":"2.0","id":1,"method":"hello","params":{{"token":"{server.right}"}}}}'
        )
        assert '"error"' in str(socket.recv(20))


@pytest.mark.parametrize("origin", [None, "null", "http://attacker.example", "http://localhost:1"])
def test_a_page_of_another_site_commands_nothing(server, origin):
    with pytest.raises(InvalidStatus) as refused, server.connect("/socket", origin=origin):
        pass
    assert refused.value.response.status_code == 403


def test_a_studio_without_the_word_commands_nothing(folder, built, port, vehicle):
    options = ("--jaus-port", str(port))
    with operating(folder, built, *options) as server, server.page() as page:
        assert not page.project["can_command"]
        for right in ("", server.token):
            with pytest.raises(RefusedError) as refused:
                page.ask("claim", right=right, name="")
            assert refused.value.code == UNAUTHORIZED
        with pytest.raises(RefusedError) as refused:
            page.ask("take", component=VEHICLE, authority=205)
        assert refused.value.code == UNAUTHORIZED
        # It watches all the same.
        watch(page)
    assert vehicle.efforts == []


def watch(page: Page) -> None:
    def watched() -> bool:
        try:
            page.ask("watch", component=VEHICLE, report="VelocityState", rate=10)
        except RefusedError:
            return False
        return True

    until(watched)
    until(lambda: page.ask("values")["values"][0]["count"] > 2)


# ---- one commands --------------------------------------------------------------------------------


def test_a_command_comes_to_the_vehicle_and_its_answer_back(holding, vehicle):
    fields = {"PropulsiveLinearEffortX": 20.0}
    answer = holding.ask("send", component=VEHICLE, message="SetWrenchEffort", fields=fields)
    assert "ReportWrenchEffort" in answer["answer"]
    assert vehicle.last == 20.0
    texts = [entry["text"] for entry in holding.ask("journal")["entries"]]
    assert any("SetWrenchEffort to 100.1.10: PropulsiveLinearEffortX=20" in text for text in texts)


def test_a_value_out_of_range_is_refused_at_its_field(holding, vehicle):
    fields = {"PropulsiveLinearEffortX": 200.0}
    with pytest.raises(RefusedError, match=r"-100.0 \.\. 100.0") as refused:
        holding.ask("send", component=VEHICLE, message="SetWrenchEffort", fields=fields)
    assert refused.value.data["path"].endswith("PropulsiveLinearEffortX")
    assert vehicle.efforts == []


def test_a_second_page_does_not_command_and_sees_who_does(server, holding):
    with server.page() as second:
        second.ask("claim", right=server.right, name="berta")
        state = second.await_told("operate.state", lambda told: told["commander"])
        assert state["commander"]["name"].startswith("anna")
        for method in ("take", "release", "resume", "send", "stick.begin"):
            with pytest.raises(RefusedError, match="anna") as refused:
                second.ask(method, **COMMANDS[method])
            assert refused.value.code == REFUSED
        # Everybody with the right may stop.
        assert second.ask("stop")["stopped"] == [
            {"component": VEHICLE, "outcome": "STANDBY", "confirmed": True}
        ]
    holding.ask("renew")


def test_stop_brings_what_is_controlled_to_standby(holding, vehicle):
    assert holding.ask("stop")["stopped"] == [
        {"component": VEHICLE, "outcome": "STANDBY", "confirmed": True}
    ]
    assert vehicle.status == "STANDBY"


def test_control_is_released(holding, server):
    holding.ask("release", component=VEHICLE)
    assert nobody_commands(server)
    with pytest.raises(RefusedError, match="nobody commands"):
        holding.ask("send", component=VEHICLE, message="SetWrenchEffort", fields={})


# ---- leases --------------------------------------------------------------------------------------


def held(page: Page) -> int:
    number: int = page.ask("stick.begin", component=VEHICLE, message="SetWrenchEffort")["stick"]
    return number


def move(page: Page, number: int, effort: float) -> None:
    page.ask("stick.move", stick=number, fields={"PropulsiveLinearEffortX": effort})


def test_a_stick_that_is_released_stops(holding, vehicle):
    number = held(holding)
    move(holding, number, 30.0)
    until(lambda: vehicle.last == 30.0)
    holding.ask("stick.end", stick=number)
    until(lambda: vehicle.last == 0.0)
    with pytest.raises(RefusedError, match="its stop was sent"):
        move(holding, number, 30.0)
    assert vehicle.last == 0.0


def test_a_stick_that_is_not_renewed_stops_in_time_and_says_nothing_more(holding, vehicle):
    number = held(holding)
    for effort in (10.0, 20.0, 30.0):
        move(holding, number, effort)
    until(lambda: vehicle.last == 0.0)
    times = {effort: moment for moment, effort in vehicle.efforts}
    # Not sooner either: a stick that lives shorter than is said could not be held.
    assert times[0.0] - times[30.0] >= TIMEOUT - 0.1
    with pytest.raises(RefusedError, match="its stop was sent"):
        move(holding, number, 40.0)
    said = "stopped: the page said nothing for 0.6 s"
    holding.await_told(
        "operate.state", lambda told: said in [alarm["text"] for alarm in told["alarms"]]
    )


def test_a_page_that_is_gone_stops_and_releases(server, holding, vehicle):
    number = held(holding)
    move(holding, number, 30.0)
    holding.socket.close()
    until(lambda: vehicle.last == 0.0)
    until(lambda: vehicle.status == "STANDBY" and vehicle.controller is None)
    until(lambda: nobody_commands(server))


def test_a_page_that_does_not_renew_commands_no_more(server, holding, vehicle):
    fields = {"PropulsiveLinearEffortX": 20.0}
    holding.ask("send", component=VEHICLE, message="SetWrenchEffort", fields=fields)
    until(lambda: vehicle.status == "STANDBY" and vehicle.controller is None)
    with pytest.raises(RefusedError, match="nobody commands"):
        holding.ask("renew")
    with server.page() as page:
        texts = [alarm["text"] for alarm in page.project["state"]["alarms"]]
    assert "it commanded, and said nothing for 2 s" in texts


@pytest.mark.slow
def test_a_page_that_renews_goes_on(holding, vehicle):
    end = time.monotonic() + 1.5 * LEASE
    while time.monotonic() < end:
        holding.ask("renew")
        time.sleep(LEASE / 8)
    assert vehicle.status == "READY"


def test_a_stick_without_a_declared_stop_is_refused_with_the_reason(holding):
    with pytest.raises(RefusedError, match="no stop of SetAccelerationLimit"):
        holding.ask("stick.begin", component=VEHICLE, message="SetAccelerationLimit")
    commands = {
        command["name"]: command
        for command in holding.ask("messages", component=VEHICLE)["commands"]
    }
    assert commands["SetWrenchEffort"]["stick"]["timeout"] == TIMEOUT
    assert "no stop of" in commands["Standby"]["stick"]["refusal"]


def test_an_alarm_is_silenced_with_a_reason_that_stays(holding):
    move(holding, held(holding), 30.0)
    told = holding.await_told("operate.state", lambda told: told["alarms"])
    number = next(alarm["number"] for alarm in told["alarms"])
    with pytest.raises(RefusedError, match="say why"):
        holding.ask("silence", numbers=[number], reason=" ")
    holding.ask("silence", numbers=[number], reason="a test")
    texts = [entry["text"] for entry in holding.ask("journal")["entries"]]
    assert any("because 'a test'" in text for text in texts)


def driving(page: Page, server: Server, vehicle: Vehicle) -> None:
    """Has the vehicle follow a stick."""
    page.ask("claim", right=server.right, name="")
    take(page)
    page.ask("resume", component=VEHICLE)
    move(page, held(page), 30.0)
    until(lambda: vehicle.last == 30.0)


def end(server: Server, number: int) -> None:
    server.process.send_signal(number)
    assert server.process.wait(LONGEST) == 0


def test_a_studio_that_ends_stops_and_releases(folder, built, port, vehicle):
    options = ("--stop-all", "standby", "--lease", "30", "--stop", STOP, "--jaus-port", str(port))
    with operating(folder, built, *options) as server, server.page() as page:
        driving(page, server, vehicle)
        end(server, signal.SIGTERM)
    assert vehicle.last == 0.0
    assert (vehicle.status, vehicle.controller) == ("STANDBY", None)


# ---- what a person has said at the start ---------------------------------------------------------


def test_an_emergency_stops_what_is_not_controlled_until_it_is_cleared_and_what_is_at_the_end(
    folder, built, port, vehicle
):
    options = ("--stop-all", "emergency", "--lease", "30", "--stop", STOP, "--jaus-port", str(port))
    with operating(folder, built, *options) as server, server.page() as page:
        page.ask("claim", right=server.right, name="")
        stopped = page.ask("stop", components=[VEHICLE])["stopped"]
        assert stopped == [{"component": VEHICLE, "outcome": "EMERGENCY", "confirmed": True}]
        assert vehicle.status == "EMERGENCY"
        page.ask("clear", component=VEHICLE)
        assert vehicle.status != "EMERGENCY"
        driving(page, server, vehicle)
        end(server, signal.SIGHUP)
    assert vehicle.last == 0.0
    assert (vehicle.status, vehicle.controller) == ("EMERGENCY", None)


def test_a_stop_that_nobody_acknowledges_is_sent_again(tmp_path, port):
    address, sent = JausAddress(100, 1, 77), set()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as deaf:
        deaf.bind(("127.0.0.1", 0))
        deaf.settimeout(0)
        peer = f"{address}=127.0.0.1:{deaf.getsockname()[1]}"
        network = make_network(None, "127.0.0.1", port, DEFAULT_GROUP, (peer,))
        unit = OperatorUnit(read(tmp_path), network, Powers("emergency", 60.0), lambda *_: None)
        unit.system.start()
        try:
            [stopped] = unit.stop_all("page", [address])
            assert stopped["outcome"] == "its state is not told"
            assert not stopped["confirmed"]
        finally:
            unit.system.stop()
        with suppress(BlockingIOError):
            while datagram := deaf.recv(2000):
                if SetEmergency(emergency_code=1).encode() in datagram:
                    sent.add(datagram)  # repetitions are the same
    assert len(sent) > TRIES


def test_a_terminal_that_takes_nothing_does_not_hold_up_the_stop(folder, built, port, vehicle):
    options = ("--stop-all", "standby", "--lease", "60", "--jaus-port", str(port))
    with operating(folder, built, *options) as server, server.page() as page:
        page.ask("claim", right=server.right, name="anna")
        take(page)
        page.ask("resume", component=VEHICLE)
        assert vehicle.status == "READY"
        assert server.process.stderr is not None
        room = fcntl.fcntl(server.process.stderr, fcntl.F_SETPIPE_SZ, 4096)
        with server.page() as other:
            for _ in range(room // 50):  # each is noted
                with pytest.raises(RefusedError):
                    other.ask("claim", right="wrong", name="")
            assert page.ask("stop")["stopped"] == [
                {"component": VEHICLE, "outcome": "STANDBY", "confirmed": True}
            ]
    assert vehicle.status == "STANDBY"


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--stop-all", "standby"), "belong together"),
        (("--lease", "2"), "belong together"),
        (("--stop", STOP), "--stop is for --stop-all"),
        (("--stop-all", "standby", "--lease", "2", "--stop", "SetWrenchEffort 1 X=0"), "--stop:"),
    ],
)
def test_half_of_a_decision_is_none(folder, built, options, said):
    process = begun(folder, built, *options, verb="operate")
    _, told = process.communicate(timeout=LONGEST)
    assert process.returncode == 2
    assert said in told


def test_a_model_that_cannot_be_read_is_told_at_the_start(folder, built):
    """Its stops are those of the start, so it must be there."""
    model = folder / "rover.ros2jaus"
    model.write_text("system rover {", encoding="utf-8")
    process = begun(model, built, "--stop-all", "standby", "--lease", "2", verb="operate")
    _, told = process.communicate(timeout=LONGEST)
    assert process.returncode == 2
    assert "rover.ros2jaus:1:" in told


# ---- others --------------------------------------------------------------------------------------


class Asking(JausComponent):
    """Another operator unit, which asks for control."""

    def __init__(self, transport: Transport) -> None:
        services = (ServiceIdentity("urn:jaus:jss:iop:HandoffController", 1, 1),)
        settings = ComponentSettings(register_services=False)
        address = JausAddress(60, 1, 1)
        super().__init__(transport, address, name="other", services=services, settings=settings)
        self.answers: list[HandoffAnswer] = []

    def ask_for(self, target: str) -> None:
        self.request_handoff(
            JausAddress.parse(target),
            authority=210,
            explanation="my shift begins",
            on_answer=self.answers.append,
        )


@pytest.fixture
def handing_over(port: int) -> Iterator[tuple[JausComponent, Asking]]:
    """A component that lets its controller hand it over, and who wants it."""
    with running_transport(TransportSettings(port=port)) as transport:
        names = ("Transport", "Events", "AccessControl", "Management", "Liveness", "Discovery")
        services = (
            *(ServiceIdentity(CORE + name, 1, 1) for name in names),
            ServiceIdentity("urn:jaus:jss:iop:EnhancedAccessControl", 1, 1),
        )
        target = JausComponent(transport, JausAddress.parse(SHARED), name="t", services=services)
        other = Asking(transport)
        target.start()
        other.start()
        yield target, other
        other.stop()
        target.stop()


SHARED = "100.1.20"


@pytest.mark.parametrize(("decision", "answer"), [("deny", "DENIED"), ("grant", "GRANTED")])
def test_a_request_for_control_waits_for_a_person(
    server, commanding, handing_over, decision, answer
):
    target, other = handing_over
    take(commanding, SHARED)
    other.ask_for(SHARED)
    told = commanding.await_told("operate.state", lambda told: told["requests"])
    [request] = told["requests"]
    assert (request["client"], request["explanation"]) == ("60.1.1", "my shift begins")
    with server.page() as looking:
        asked = {"component": SHARED, "number": request["number"], "decision": decision}
        with pytest.raises(RefusedError) as refused:
            looking.ask("decide", **asked)
        assert refused.value.code == UNAUTHORIZED
        looking.ask("claim", right=server.right, name="")
        with pytest.raises(RefusedError, match="anna"):
            looking.ask("decide", **asked)
    assert HandoffAnswer.GRANTED not in other.answers
    commanding.ask("decide", **asked)
    until(lambda: other.answers and other.answers[-1].name == answer)
    if decision == "grant":
        until(lambda: nobody_commands(server))
    else:
        assert str(target.controller).startswith("65000.")


@pytest.mark.needs("capture")
def test_a_recording_has_what_was_commanded(holding, port, tmp_path):
    path, log = tmp_path / "run.mcap", tmp_path / "run.log"
    line = [*warm.command(), "record", "--output", str(path), "--port", str(port)]
    with log.open("w") as stream:
        process = subprocess.Popen(line, stderr=stream)
    try:
        while "record" not in log.read_text(encoding="utf-8"):
            holding.ask("renew")
            time.sleep(LEASE / 10)
        fields = {"PropulsiveLinearEffortX": 12.0}
        holding.ask("send", component=VEHICLE, message="SetWrenchEffort", fields=fields)
    finally:
        process.send_signal(signal.SIGTERM)
        process.wait(timeout=LONGEST)
    topics = {channel.topic for _, channel, _ in McapRecording(str(path)).messages()}
    own = holding.project["state"]["own"]
    assert f"/jaus/{own}/SetWrenchEffort" in topics


def test_nobody_takes_control_while_what_a_lost_page_commanded_is_stopped(
    tmp_path, port, vehicle, monkeypatch
):
    network = make_network(None, "127.0.0.1", port, DEFAULT_GROUP, ())
    unit = OperatorUnit(read(tmp_path), network, Powers("standby", 60.0), lambda *_: None)
    address, refused = JausAddress.parse(VEHICLE), []
    assert vehicle.efforts == []

    def take(page: int) -> bool:
        try:
            unit.take(page, f"page {page}", address, 205)
        except (Refused, NoAnswer):
            return False
        return True

    def stop_all(name: str, _targets: object) -> list[dict[str, str]]:
        with pytest.raises(Refused, match="is being stopped; try again") as caught:
            unit.take(2, "ben", address, 205)
        refused.append(caught.value)
        return stopped(name, ())

    unit.system.start()
    try:
        until(lambda: take(1))
        stopped = unit.stop_all
        monkeypatch.setattr(unit, "stop_all", stop_all)
        unit.leave(1)
        assert len(refused) == 1
        monkeypatch.undo()
        until(lambda: take(2))
        assert [str(hold.target) for hold in unit.system.operator.holds] == [VEHICLE]
    finally:
        unit.system.stop()
