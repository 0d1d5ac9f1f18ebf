"""Stops are those that a person has declared, and nothing is made up where nobody has."""

from pathlib import Path

import pytest

from jausml.cli.shared import options
from jausml.language.project import read_project
from jausml.live.messages import MessageError, load_catalogue
from jausml.live.operating.reading import stops_of
from jausml.live.operating.stops import STOP_KINDS, Stops, parse_stop
from jausml.live.peers.query_client import Refused

MODELS = Path(__file__).parents[2] / "models"
CATVEHICLE = MODELS / "catvehicle" / "catvehicle.xmi"


@pytest.fixture(scope="module")
def set_wrench():
    return load_catalogue().message("SetWrenchEffort")


@pytest.fixture(scope="module")
def set_velocity():
    return load_catalogue().message("SetVelocityCommand")


def of_model(path):
    return Stops(stops_of(read_project([path]).model), ())


def test_what_the_command_line_offers_is_what_there_is():
    assert STOP_KINDS == options.STOP_WORDS


def test_the_stop_of_a_connection_is_that_of_its_receiver(set_wrench):
    stops = of_model(CATVEHICLE)
    stop = stops.of("100.1.1", set_wrench)
    assert stop.timeout == 0.5
    # The brake is what the map fills in, without a source.
    efforts = {"PropulsiveLinearEffortX": 0, "ResistiveLinearEffortX": 0}
    assert set_wrench.shortened(stop.fields) == efforts
    assert stop.source == "connection bridge.speed_command"
    for other in ("100.1.2", "100.1.3"):
        with pytest.raises(Refused, match="no stop of SetWrenchEffort"):
            stops.of(other, set_wrench)


def test_a_bridge_that_takes_commands_has_the_stop_of_its_map(set_velocity):
    stops = of_model(MODELS / "examples" / "simulator" / "simulator.ros2jaus")
    stop = stops.of("100.1.30", set_velocity)
    assert stop.timeout == 0.5
    fields = set_velocity.shortened(set_velocity.decode(set_velocity.encode(stop.fields)))
    assert fields.pop("CommandType") == 0
    assert set(fields) == {
        "Velocity_X", "Velocity_Y", "Velocity_Z", "RollRate", "PitchRate", "YawRate"
    }  # fmt: skip
    assert all(abs(field) < 0.01 for field in fields.values())


@pytest.mark.parametrize("timeout", ["", "silenceTimeout: 0.0"])
def test_without_a_time_out_there_is_no_stop(tmp_path, set_velocity, timeout):
    path = MODELS / "examples" / "simulator" / "simulator.ros2jaus"
    text = path.read_text(encoding="utf-8")
    assert text.count("silenceTimeout: 0.5") == 1
    edited = tmp_path / path.name
    edited.write_text(text.replace("silenceTimeout: 0.5", timeout), encoding="utf-8")
    with pytest.raises(Refused, match="declares no silenceTimeout"):
        of_model(edited).of("100.1.30", set_velocity)


def test_a_command_that_holds_has_none(tmp_path, set_velocity):
    path = MODELS / "examples" / "simulator" / "simulator.ros2jaus"
    held = 'onSilence: hold\n            holdReason: "it is towed and cannot move"'
    edited = tmp_path / path.name
    text = path.read_text(encoding="utf-8").replace("silenceTimeout: 0.5", held)
    edited.write_text(text, encoding="utf-8")
    with pytest.raises(Refused, match="holds the last command"):
        of_model(edited).of("100.1.30", set_velocity)


def test_a_stop_of_the_command_line_comes_first(set_wrench):
    stop = parse_stop("SetWrenchEffort 0.3 PropulsiveLinearEffortX=0", load_catalogue())
    stops = Stops(stops_of(read_project([CATVEHICLE]).model), [stop])
    assert stops.of("100.1.1", set_wrench).timeout == 0.3
    assert stops.of("7.7.7", set_wrench).source == "the command line"


@pytest.mark.parametrize(
    "text",
    [
        "",
        "SetWrenchEffort",
        "SetWrenchEffort soon PropulsiveLinearEffortX=0",
        "SetWrenchEffort nan PropulsiveLinearEffortX=0",
        "SetWrenchEffort 0 PropulsiveLinearEffortX=0",
        "SetWrenchEffort 1e9 PropulsiveLinearEffortX=0",
        "SetWrenchEffort 1 PropulsiveLinearEffortX=200",
        "SetWrenchEffort 1 Other=0",
        "Nothing 1 X=0",
        "SetVelocityCommand 1 Velocity_X=0",
    ],
)
def test_what_is_no_stop_is_refused(text):
    with pytest.raises((ValueError, MessageError)):
        parse_stop(text, load_catalogue())
