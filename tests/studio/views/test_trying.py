"""Trying values by the generated code of maps, in a real process."""

import json
import re
import sys
import tempfile
from contextlib import closing
from pathlib import Path

import pytest
from scope_support import CAR, MODELS, SHIPPED, scope_of
from sweeps import sweep

import jausml
from jausml.authoring.proposals.elements import AnswerError, Scope
from jausml.authoring.studio.views import jaus_values, trial_worker, trying
from jausml.authoring.studio.views.trying import Trials, inputs
from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.model import read_models
from jausml.language.text.notation import NOTATIONS
from jausml.live.workers.bootstrap import load_runtime
from jausml.live.workers.worker import BridgeCode

RULES = Path(__file__).resolve().parents[2] / "cases" / "rules"
BUSY = 60.0
"""Seconds that a process may take on a busy machine."""


@pytest.fixture(scope="module")
def trials():
    with closing(Trials(BUSY)) as made:
        yield made


def map_of(scope, name):
    found = [e for e in scope.model.instances(bridge.AttributeMap) if e.name == name]
    return found[0]


def run(trials, name, values, *, to_ros, file=CAR):
    scope = scope_of(file)
    return trials.run(scope, map_of(scope, name), values, to_ros=to_ros)


def shown(tried):
    assert not tried.error
    return {value.path: value.value for value in tried.values}


def number(text):
    """The number of a value of JAUS, which has its unit behind it."""
    return float(text.split()[0])


def test_the_inputs_are_the_members_that_assignments_read():
    found = {
        member.path: member
        for member in inputs(map_of(scope_of(CAR), "velocity_state"), to_ros=True)
    }
    assert list(found) == ["TimeStamp", "Velocity_X", "Velocity_Y", "YawRate"]
    assert found["TimeStamp"].type == "time"
    assert (found["YawRate"].type, found["YawRate"].unit) == ("number", "radian per second")
    back = [member.path for member in inputs(map_of(scope_of(CAR), "dead_reckoning"), to_ros=False)]
    assert "pose.pose.orientation.w" in back


def test_what_the_inputs_begin_with_can_be_tried_where_a_map_counts_elements(trials):
    ranges = MODELS / "library" / "mappings" / "range_sensor.ros2jaus"
    scan = map_of(scope_of(ranges), "laser_scan")
    values = {member.path: member.default for member in inputs(scan, to_ros=True)}
    assert not run(trials, "laser_scan", values, to_ros=True, file=ranges).error


def test_values_become_those_of_ros_with_units_and_bytes(trials):
    found = run(trials, "velocity_state", {"Velocity_X": "1.5", "YawRate": "0.25"}, to_ros=True)
    values = shown(found)
    assert float(values["twist.twist.linear.x"]) == pytest.approx(1.5, abs=1e-3)
    assert float(values["twist.twist.angular.z"]) == pytest.approx(-0.25, abs=2e-3)
    assert values["header.frame_id"] == "odom"
    units = {value.path: value.unit for value in found.values}
    assert units["twist.twist.linear.x"] == "m/s"
    assert bytes.fromhex(found.bytes)[:4] == b"\0\1\0\0"  # little-endian CDR


@pytest.mark.parametrize(
    ("moment", "stamp"),
    [
        ("2026-05-17T12:30:15.250", "day 17 12:30:15.250"),
        ("1969-12-31T23:59:59.250", "day 31 23:59:59.250"),
    ],
)
def test_values_become_those_of_jaus_with_code_and_time(trials, moment, stamp):
    given = {"pose.pose.position.x": "4", "pose.pose.orientation.w": "1", "header.stamp": moment}
    found = run(trials, "dead_reckoning", given, to_ros=False)
    values = shown(found)
    assert number(values["X"]) == pytest.approx(4, abs=1e-3)
    assert values["TimeStamp"] == stamp
    assert bytes.fromhex(found.bytes)[:2] == b"\x03\x44"


def test_a_time_of_another_zone_is_told_in_that_of_the_world():
    at = jaus_values.moment("2026-05-18T00:30+02:00")
    assert (at.day, at.hour) == (17, 22)
    with pytest.raises(AnswerError, match="is no time"):
        jaus_values.moment("0001-01-01T00:30+02:00")


def test_what_does_not_fit_is_told(trials):
    clamped = run(trials, "steering_command", {"data": "12"}, to_ros=False)
    assert number(shown(clamped)["PropulsiveRotationalEffortZ"]) == pytest.approx(-100)
    assert clamped.notes == ("PropulsiveRotationalEffortZ: clamp",)
    absent = run(trials, "velocity_state", {"YawRate": "1"}, to_ros=True)
    assert absent.error == "without Velocity_X the message is dropped"
    beyond = run(trials, "velocity_state", {"Velocity_X": "999"}, to_ros=True)
    assert "outside -327.68" in beyond.error
    text = run(trials, "velocity_state", {"Velocity_X": "fast"}, to_ros=True)
    assert "'fast' is no number" in text.error
    text = run(trials, "steering_command", {"data": "fast"}, to_ros=False)
    assert "'fast' is no double" in text.error
    unknown = run(trials, "steering_command", {"date": "1"}, to_ros=False)
    assert "no field date" in unknown.error


def test_the_process_stays_until_the_code_changes():
    scope = scope_of(CAR)
    used = map_of(scope, "steering_command")
    with closing(Trials(BUSY)) as trials:
        assert not trials.run(scope, used, {"data": "0"}, to_ros=False).error
        [first] = trials._processes.values()
        assert not trials.run(scope, used, {"data": "0.1"}, to_ros=False).error
        assert list(trials._processes.values()) == [first]
        # The same code of another reading: nothing is started.
        first.made_of = None
        assert not trials.run(scope, used, {"data": "0.1"}, to_ros=False).error
        assert list(trials._processes.values()) == [first]
        first._process.kill()
        first._process.wait()
        assert not trials.run(scope, used, {"data": "0.1"}, to_ros=False).error
        assert list(trials._processes.values()) != [first]


ROBOT = """
import mappings.primitive_driver

system alone {
    bridge robot {
        address: 100.1.10
        provides: PrimitiveDriver
        controlTimeout: 2
        connection drive {
            map: wrench_effort
            direction: jausToRos
            exchange: message
            silenceTimeout: 0.5
            topic cmd_vel
        }
        quantity max_speed { value: 4.0  units: "m/s" }
    }
}
"""


def test_a_map_is_tried_as_its_bridge_has_it(trials, tmp_path):
    """Its bridge has another maximum than the map, and then a third one for the same map."""
    for maximum, speed in (("4.0", 2.0), ("3.0", 1.5)):
        file = tmp_path / f"{maximum}.ros2jaus"
        file.write_text(ROBOT.replace("4.0", maximum), encoding="utf-8")
        effort = {"PropulsiveLinearEffortX": "50"}
        values = shown(run(trials, "wrench_effort", effort, to_ros=True, file=file))
        assert float(values["linear.x"]) == pytest.approx(speed, abs=0.001)


def test_a_translation_that_takes_too_long_is_ended():
    scope = scope_of(CAR)
    with closing(Trials(0.0)) as trials:
        found = trials.run(scope, map_of(scope, "steering_command"), {}, to_ros=False)
        assert found.error == "the translation took longer than 0 s"
        [process] = trials._processes.values()
        process._process.wait(BUSY)
        assert not process.is_alive


def test_elements_of_lists_and_joins_have_values(trials):
    file = "library/mappings/joint_positions.ros2jaus"
    names = [e.path for e in inputs(map_of(scope_of(file), "joint_positions"), to_ros=True)]
    assert "JointPositionList[0].JointPosition.radian" in names
    given = {"JointPositionList[0].JointPosition.radian": "0.5"}
    found = run(trials, "joint_positions", given, to_ros=True, file=file)
    assert float(shown(found)["position"]) == pytest.approx(0.5, abs=1e-3)


@pytest.mark.parametrize("join", ["ownImu", "source"])
def test_a_join_may_have_a_name_that_is_none_of_a_parameter(trials, tmp_path, join):
    text = (MODELS / "library" / "mappings" / "global_pose_sensor.ros2jaus").read_text("utf-8")
    file = tmp_path / "joined.ros2jaus"
    file.write_text(text.replace("join imu ", f"join {join} ").replace("imu.", f"{join}."), "utf-8")
    scope = Scope(read_models([file], notations=NOTATIONS).model, tmp_path)
    given = {"status.status": "0", "latitude": "48", "longitude": "11"}
    given |= {f"{join}.orientation.z": "1", f"{join}.orientation.w": "0"}
    found = shown(trials.run(scope, map_of(scope, "global_pose"), given, to_ros=False))
    assert number(found["Latitude"]) == pytest.approx(48, abs=1e-6)
    assert number(found["Yaw"]) == pytest.approx(-1.5708, abs=1e-3)  # of the joined one


@pytest.mark.parametrize(
    ("case", "name", "to_ros"),
    [("JML414-features", "velocity", True), ("JML441-expressions", "speed", False)],
)
def test_a_map_with_errors_is_not_tried(trials, case, name, to_ros):
    path = RULES / case / "bad.xmi"
    scope = Scope(read_models([path]).model, path.parent)
    found = trials.run(scope, map_of(scope, name), {}, to_ros=to_ros)
    assert found.error == f"'{name}' cannot be tried before its errors are fixed"


class InThisProcess:
    """A translation in the process of the tests: a process for each of a hundred is dear."""

    is_alive = True

    def __init__(
        self, code: BridgeCode, parameters: dict[str, str], made_of: bridge.AttributeMap
    ) -> None:
        self.code, self.parameters, self.made_of = code, parameters, made_of
        self._folder = tempfile.TemporaryDirectory()
        workspace = Path(self._folder.name)
        for path, text in code.files.items():
            (workspace / path).parent.mkdir(parents=True, exist_ok=True)
            (workspace / path).write_text(text, encoding="utf-8")
        self._packages = {package.name: str(package) for package in workspace.iterdir()}
        sys.path[:0] = self._packages.values()
        self._translation = trial_worker.Translation()

    def ask(self, request: object, _: float) -> object:
        answer = self._translation.answer(json.loads(json.dumps(request)))
        return json.loads(json.dumps(answer))

    def close(self) -> None:
        for name in [
            module for module in sys.modules if module.partition(".")[0] in self._packages
        ]:
            del sys.modules[name]
        sys.path[:] = [path for path in sys.path if path not in self._packages.values()]
        self._folder.cleanup()


@pytest.fixture(scope="module")
def _runtime_of_generated_code():
    before = {name for name in sys.modules if name.partition(".")[0] == "jausml_runtime"}
    if not before:
        load_runtime(Path(jausml.__file__).parent / "runtime")
    yield
    for name in [module for module in sys.modules if module.partition(".")[0] == "jausml_runtime"]:
        if name not in before:
            del sys.modules[name]


@pytest.mark.usefixtures("_runtime_of_generated_code")
@pytest.mark.parametrize(
    "name", sweep((shipped for shipped in SHIPPED if "mappings" in shipped), every=14, rest=10)
)
def test_every_ready_map_can_be_tried(name, monkeypatch):
    monkeypatch.setattr(trying, "_Process", InThisProcess)
    monkeypatch.setattr(trying, "_MOST_PROCESSES", 1)  # all have packages of the same names
    scope = scope_of(name)
    with closing(Trials(BUSY)) as trials:
        for used in scope.model.instances(bridge.AttributeMap):
            for to_ros, assignments in ((True, used.toRos), (False, used.toJaus)):
                if not assignments or scope.model.document_of(used) is not scope.model.documents[0]:
                    continue
                given = {member.path: member.default for member in inputs(used, to_ros=to_ros)}
                found = trials.run(scope, used, given, to_ros=to_ros)
                assert found.bytes or found.error, used.name
                for word in ("Traceback", "Error(", "has no attribute", "failed", "no field"):
                    assert word not in found.error, (used.name, found.error)


@pytest.mark.parametrize("name", ["byte", "shortInteger", "integer"])
def test_a_value_of_an_alternative_is_sent_as_that(name):
    model = scope_of(CAR).library
    message = next(e for e in model.instances(jaus.MessageDef) if e.name == "ReportAnalogAction")
    data = jaus_values.payload(message, {f"Longitudinal.{name}": "100"})
    index = ["byte", "shortInteger", "integer"].index(name)
    # Code, presence vector, reference, then the index of the alternative, and its value.
    assert data[5:6] == bytes([index])
    assert int.from_bytes(data[6 : 6 + 2**index], "little") == 100


@pytest.mark.parametrize(
    ("name", "path"),
    [
        ("ReportAnalogAction", "Longitudinal.7"),
        ("ReportAnalogAction", "Longitudinal.byte.more"),
        ("ReportVelocityState", "Velocity_X.more"),
        ("ReportVelocityState", "TimeStamp.Day.more"),
    ],
)
def test_a_member_that_is_not_there_is_refused(name, path):
    messages = scope_of(CAR).library.instances(jaus.MessageDef)
    message = next(message for message in messages if message.name == name)
    with pytest.raises(AnswerError, match=f"there is no member {re.escape(path)}"):
        jaus_values.payload(message, {path: "3"})
