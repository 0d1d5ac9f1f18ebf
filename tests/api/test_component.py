"""Components without a model, which speak with each other over real sockets."""

from __future__ import annotations

import asyncio
import threading
import time

import pytest
from ports import free_port

import jausml

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
    assert any(each.startswith("urn:jaus:jss:core:AccessControl/") for each in services)


def test_reports_come_at_a_rate(operator):
    with operator.subscribe(VEHICLE, "VelocityState", rate=50) as reports:
        found = [reports.next(timeout=10) for _ in range(3)]
    assert {(each.name, each.sender) for each in found} == {("ReportVelocityState", VEHICLE)}
    assert all(each.sender == VEHICLE for each in reports)  # which ends: it is closed


def test_reports_come_at_changes(operator, vehicle):
    with operator.subscribe(VEHICLE, "VelocityState") as reports:
        assert reports.next(timeout=10).fields["Velocity_X"] == pytest.approx(1.5, abs=1e-3)
        vehicle.speed = -2.0
        vehicle.changed()
        assert reports.next(timeout=10).fields["Velocity_X"] == pytest.approx(-2.0, abs=1e-3)


def test_an_iteration_ends_with_its_subscription(operator):
    reports = operator.subscribe(VEHICLE, "VelocityState", rate=100)
    taken = []

    def take():
        taken.extend(reports)

    taking = threading.Thread(target=take)
    taking.start()
    while not taken:
        taking.join(0.01)
    reports.close()
    taking.join(10)
    assert not taking.is_alive()


def test_commands_are_obeyed_under_control_alone(operator, vehicle):
    effort = {"PropulsiveLinearEffortX": 50.0}
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
