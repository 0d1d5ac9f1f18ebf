"""Components without a model, which speak with each other over real sockets."""

import asyncio
import errno
import socket
import threading
import time

import pytest
from ports import free_port

import jausml
from jausml.live.api.aio import AsyncSubscription
from jausml.live.api.messages import Subscription

pytestmark = pytest.mark.ports

VEHICLE, OPERATOR = "100.1.1", "200.1.1"


@pytest.fixture
def port():
    return free_port()


@pytest.fixture
def vehicle(port):
    """A vehicle that drives as fast as its last command says."""
    with jausml.Component(
        VEHICLE, provides=["VelocityStateSensor", "PrimitiveDriver"], port=port
    ) as made:
        made.speed = 1.5
        made.commands = []
        made.changed = made.answer("VelocityState", lambda: {"Velocity_X": made.speed})
        made.obey("SetWrenchEffort", made.commands.append)
        yield made


@pytest.fixture
def operator(port, vehicle):
    assert vehicle.address == VEHICLE
    with jausml.Component(OPERATOR, port=port) as made:
        yield made


def test_a_question_is_answered(operator):
    report = operator.query(VEHICLE, "VelocityState")
    assert report == {"Velocity_X": pytest.approx(1.5, abs=1e-3)}


def test_services_are_found(operator):
    services = operator.discover(1.0)[VEHICLE]
    assert "urn:jaus:jss:mobility:PrimitiveDriver/1.0" in services
    assert any(service.startswith("urn:jaus:jss:core:AccessControl/") for service in services)


def test_reports_come_at_a_rate(operator):
    with operator.subscribe(VEHICLE, "VelocityState", rate=50) as reports:
        found = [reports.next(timeout=10) for _ in range(3)]
    assert {(report.name, report.sender) for report in found} == {("ReportVelocityState", VEHICLE)}
    assert all(report.sender == VEHICLE for report in reports)  # which ends: it is closed


def test_reports_come_at_changes(operator, vehicle):
    with operator.subscribe(VEHICLE, "VelocityState") as reports:
        assert reports.next(timeout=10).fields["Velocity_X"] == pytest.approx(1.5, abs=1e-3)
        vehicle.speed = -2.0
        vehicle.changed()
        assert reports.next(timeout=10).fields["Velocity_X"] == pytest.approx(-2.0, abs=1e-3)


@pytest.mark.parametrize("is_stopped", [False, True])
def test_an_iteration_ends_with_its_subscription_or_component(operator, is_stopped):
    reports = operator.subscribe(VEHICLE, "VelocityState", rate=100)
    taken = []

    def take():
        taken.extend(reports)

    taking = threading.Thread(target=take, daemon=True)
    taking.start()
    while not taken:
        taking.join(0.01)
    (operator.stop if is_stopped else reports.close)()
    taking.join(10)
    assert not taking.is_alive()


def test_an_iteration_of_asyncio_ends_with_its_component(port, vehicle):
    assert vehicle.address == VEHICLE

    async def drive():
        operator = jausml.AsyncComponent(OPERATOR, port=port)
        await operator.start()
        reports = await operator.subscribe(VEHICLE, "VelocityState", rate=100)

        async def take():
            return [report async for report in reports]

        taking = asyncio.ensure_future(take())
        await operator.stop()
        await asyncio.wait_for(taking, 10)

    asyncio.run(drive())


def test_a_closed_subscription_says_so_each_time():
    reports = Subscription()
    reports.close()
    for _ in range(2):
        with pytest.raises(TimeoutError, match="closed"):
            reports.next(timeout=0.1)

    async def take():
        reports = AsyncSubscription()
        await reports.close()
        for _ in range(2):
            with pytest.raises(EOFError):
                await asyncio.wait_for(reports.next(), 10)

    asyncio.run(take())


def test_commands_are_obeyed_under_control_alone(operator, vehicle):
    effort = {"PropulsiveLinearEffortX": 50.0}
    with pytest.raises(jausml.Refused, match="SetWrenchEffort from its controller alone"):
        operator.command(VEHICLE, "SetWrenchEffort", effort)
    assert vehicle.commands == []
    with operator.control(VEHICLE):
        operator.command(VEHICLE, "SetWrenchEffort", effort)
        end = time.monotonic() + 30
        # It is obeyed on a thread of its own: an answer says nothing of that.
        while not vehicle.commands and time.monotonic() < end:
            operator.query(VEHICLE, "Status")
        (command,) = vehicle.commands
    assert command.sender == OPERATOR
    assert command.fields == {"PropulsiveLinearEffortX": pytest.approx(50, abs=0.01)}


def test_control_is_refused_to_a_lesser_authority(operator, port):
    with (
        operator.control(VEHICLE, authority=200),
        jausml.Component("201.1.1", port=port) as other,
        pytest.raises(jausml.Refused, match=r"200\.1\.1 controls it"),
        other.control(VEHICLE, authority=100),
    ):
        pytest.fail("control was given")


def test_nobody_answers(port):
    with (
        jausml.Component(OPERATOR, port=port, timeout=0.3) as alone,
        pytest.raises(jausml.NoAnswer, match="nothing"),
    ):
        alone.query("100.1.1", "VelocityState")


@pytest.mark.parametrize(
    ("name", "fields", "words"),
    [
        ("SetWrenchEfort", {}, "SetWrenchEffort"),
        ("SetWrenchEffort", {"PropulsiveLinearEffortX": 500.0}, "500"),
        ("SetWrenchEffort", {"Thrust": 1.0}, "Thrust"),
    ],
)
def test_what_cannot_be_sent_is_told(operator, name, fields, words):
    with pytest.raises(jausml.MessageError, match=words):
        operator.command(VEHICLE, name, fields)


def test_what_cannot_be_made(port):
    with pytest.raises(ValueError, match="does not name one component"):
        jausml.Component("1.1.255")
    with pytest.raises(jausml.MessageError, match="no service 'Wings'"):
        jausml.Component(VEHICLE, provides=["Wings"])
    with pytest.raises(RuntimeError, match="not started"):
        jausml.Component(VEHICLE, port=port).query(OPERATOR, "Status")


def test_a_free_id_is_taken(port):
    with jausml.Component(port=port) as one, jausml.Component(port=port) as other:
        assert one.address.startswith("65000.")
        assert one.address != other.address


@pytest.mark.usefixtures("vehicle")
def test_asyncio(port):
    async def drive():
        async with jausml.AsyncComponent(OPERATOR, port=port) as operator:
            speed, services = await asyncio.gather(
                operator.query(VEHICLE, "VelocityState"), operator.discover(0.6)
            )
            assert VEHICLE in services
            async with operator.control(VEHICLE):
                await operator.command(VEHICLE, "SetWrenchEffort", {"PropulsiveLinearEffortX": 1.0})
            found = [speed["Velocity_X"]]
            async with await operator.subscribe(VEHICLE, "VelocityState", rate=50) as reports:
                async for report in reports:
                    found.append(report.fields["Velocity_X"])
                    if len(found) == 4:
                        break
            return found

    assert asyncio.run(asyncio.wait_for(drive(), 30)) == pytest.approx([1.5] * 4, abs=1e-3)


@pytest.mark.usefixtures("vehicle")
def test_who_is_cancelled_has_nothing(port):
    """A thread that asks cannot be cancelled: what it is given later is given back."""

    async def inside(block):
        async with block:
            await asyncio.sleep(60)

    async def cancelled(block, seconds):
        task = asyncio.ensure_future(inside(block))
        await asyncio.sleep(seconds)
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task

    async def drive():
        async with jausml.AsyncComponent(OPERATOR, port=port) as operator:
            # Before its thread begins, while it asks, and when it has got all.
            for number in range(12):
                await cancelled(operator.control(VEHICLE), number / 2000)
                controller = await operator.query(VEHICLE, "Control")
                assert controller["SubsystemID"] == 0
                block = operator.subscribe(VEHICLE, "VelocityState", rate=50)
                await cancelled(block, number / 2000)
                events = await operator.query(VEHICLE, "Events")
                assert events["EventList"] == []

    asyncio.run(asyncio.wait_for(drive(), 60))


# ---- mistakes -----------------------------------------------------------------------------------


def wait_for(condition):
    end = time.monotonic() + 30
    while not (found := condition()):
        assert time.monotonic() < end, "it did not happen"
        time.sleep(0.01)
    return found


def test_a_refused_event_says_why_at_once(operator):
    with pytest.raises(jausml.Refused, match="refuses events of ReportGlobalPose: no report"):
        operator.subscribe(VEHICLE, "GlobalPose")


@pytest.mark.parametrize("name", ["ReportVelocityState", "2404", "4404", "0x4404", 0x2404, 0x4404])
def test_a_message_goes_by_all_its_names(operator, name):
    assert operator.query(VEHICLE, name) == {"Velocity_X": pytest.approx(1.5, abs=1e-3)}


def test_a_function_that_is_handed_over_cannot_wait(operator):
    """It would wait for what its own thread takes."""
    raised = []

    def ask_back(_report):
        for call in (
            lambda: operator.query(VEHICLE, "Status"),
            lambda: operator.subscribe(VEHICLE, "Status"),
            lambda: operator.discover(0.1),
            lambda: operator.control(VEHICLE).__enter__(),
        ):
            try:
                call()
            except RuntimeError as error:
                raised.append(str(error))

    cancel = operator.watch(VEHICLE, "VelocityState", 50, ask_back)
    wait_for(lambda: len(raised) >= 4)
    cancel()
    assert all("another thread" in message for message in raised)
    assert operator.query(VEHICLE, "VelocityState")


def test_who_asks_itself_is_told(operator):
    with pytest.raises(ValueError, match=r"200\.1\.1 is this component itself"):
        operator.query(OPERATOR, "Status")


def test_answers_can_be_set_before_the_start(port):
    vehicle = jausml.Component(VEHICLE, provides="VelocityStateSensor", port=port)
    changed = vehicle.answer("VelocityState", lambda: {"Velocity_X": 2.0})
    changed()  # of no effect yet
    with jausml.Component(OPERATOR, port=port) as operator:
        for _ in range(2):  # also after a second start
            with vehicle:
                changed()
                found = operator.query(VEHICLE, "VelocityState")
                assert found == {"Velocity_X": pytest.approx(2, abs=1e-3)}
    with pytest.raises(ValueError, match="answered already"):
        vehicle.answer("VelocityState", dict)


def test_what_answers_and_obeys_is_checked():
    vehicle = jausml.Component(VEHICLE, provides=["VelocityStateSensor"])

    async def give():
        return {}

    with pytest.raises(ValueError, match="QueryVelocityState is a query"):
        vehicle.obey("QueryVelocityState", print)
    with pytest.raises(TypeError, match="a function"):
        vehicle.answer("VelocityState", {"Velocity_X": 1.0})
    with pytest.raises(TypeError, match="async"):
        vehicle.answer("VelocityState", give)
    with pytest.raises(TypeError, match="a function"):
        vehicle.obey("SetWrenchEffort", None)
    with pytest.raises(jausml.MessageError, match="SetWrenchEffort"):
        vehicle.obey("SetWrenchEfort", print)


def test_an_answer_that_is_no_object_is_named(vehicle, operator, caplog):
    vehicle.answer("WrenchEffort", lambda: 5)
    other = jausml.Component("201.1.1", port=operator._network.settings.port, timeout=0.3)
    with other, pytest.raises(jausml.NoAnswer):
        other.query(VEHICLE, "WrenchEffort")
    assert "the answer to QueryWrenchEffort is 5" in caplog.text


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"address": 0x640101}, "JAUS id"),
        ({"address": (100, 1, 1)}, "JAUS id"),
        ({"peers": {"100.1.9": "127.0.0.1"}}, r"100\.1\.9.*host and port"),
        ({"timeout": 0}, "timeout"),
        ({"interface": "rover0"}, "'rover0' is no IPv4 address"),
        ({"multicast_group": "all"}, "'all' is no IPv4 address"),
    ],
)
def test_an_argument_that_means_nothing_is_named(arguments, words):
    with pytest.raises(ValueError, match=words):
        jausml.Component(**arguments)


def test_a_port_that_is_taken_is_told_in_words_of_python(port):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("0.0.0.0", port))  # noqa: S104 - as node managers do
        with pytest.raises(OSError, match="port=") as caught:
            jausml.Component(OPERATOR, port=port).start()
    assert "--" not in str(caught.value)
    assert caught.value.errno == errno.EADDRINUSE


@pytest.mark.usefixtures("vehicle")
def test_asyncio_over_cells_of_a_notebook(port):
    """Without blocks: what one cell starts the next one uses."""

    async def cells():
        taken = asyncio.Queue()

        async def take(command):
            await taken.put(command.fields)

        operator = jausml.AsyncComponent(OPERATOR, provides=["PrimitiveDriver"], port=port)
        operator.obey("SetWrenchEffort", take)
        await operator.start()
        async with operator.subscribe(VEHICLE, "VelocityState", rate=50) as reports:
            assert (await reports.next()).sender == VEHICLE
        async with jausml.AsyncComponent("201.1.1", port=port) as other, other.control(OPERATOR):
            await other.command(OPERATOR, "SetWrenchEffort", {"PropulsiveLinearEffortX": 1.0})
            assert list(await taken.get()) == ["PropulsiveLinearEffortX"]
        await operator.stop()
        with pytest.raises(RuntimeError, match="not started"):
            await operator.query(VEHICLE, "Status")

    asyncio.run(asyncio.wait_for(cells(), 60))


def test_a_component_shows_who_it_is(vehicle):
    assert repr(vehicle) == "<Component 100.1.1, runs>"
    assert repr(jausml.Component("1.1.1")) == "<Component 1.1.1, stopped>"


def test_who_loses_control_is_told_at_the_next_command(operator, port):
    effort = {"PropulsiveLinearEffortX": 1.0}

    def refusal():
        try:
            operator.command(VEHICLE, "SetWrenchEffort", effort)
        except jausml.Refused as error:
            return str(error)
        return ""

    with operator.control(VEHICLE, authority=100):
        assert refusal() == ""
        with jausml.Component("201.1.1", port=port) as other, other.control(VEHICLE, authority=200):
            assert wait_for(refusal).startswith("100.1.1 ")


def test_reports_that_stay_away_are_logged(vehicle, port, caplog):
    with (
        jausml.Component("201.1.1", port=port, timeout=0.3) as operator,
        operator.subscribe(VEHICLE, "VelocityState", rate=50) as reports,
    ):
        assert reports.next(timeout=30).sender == VEHICLE
        vehicle.stop()
        wait_for(lambda: "no ReportVelocityState of 100.1.1 for 0.3 s" in caplog.text)
