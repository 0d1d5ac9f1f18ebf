"""A bridge of all maps of a text, by options of the command line."""

import pytest
from click.testing import CliRunner
from test_figure_5 import FIGURE_5

from jausml.cli import main
from jausml.language.metamodel.classes import bridge
from jausml.language.model import read_models
from jausml.language.text.notation import Ros2Jaus
from jausml.language.text.reading.bridge_of_maps import BridgeOfMaps
from jausml.language.validation.engine import check

LIBRARY = """\
speed {
    JAUS ReportVelocityState
    ROS std_msgs/Float64
    JAUS->ROS ( Velocity_X -> data )
}
effort {
    JAUS SetWrenchEffort
    ROS std_msgs/Float64
    stopRos: {}
    JAUS->ROS ( PropulsiveLinearEffortX -> data )
}
pull {
    JAUS SetWrenchEffort
    ROS std_msgs/Float64
    stopJaus: { values: { target: PropulsiveLinearEffortX  value: 0 } }
    ROS->JAUS ( data -> PropulsiveLinearEffortX )
}
"""


@pytest.fixture
def read(texts):
    def read_maps(text: str, name: str = "maps.ros2jaus"):
        path = texts.write(name, text)
        asked = BridgeOfMaps(path.resolve(), "100.1.20", 20.0)
        return read_models([path], project_root=texts.folder, notations=(Ros2Jaus(asked),))

    return read_maps


def connections(result):
    """Returns what each connection is: direction, exchange, whom it searches, its topic."""
    [found] = result.model.instances(bridge.Bridge)
    return found, {
        connection.name: (
            connection.direction.name,
            connection.exchange.name,
            [] if connection.search is None else [one.name for one in connection.search.services],
            [topic.name for topic in connection.topics],
        )
        for connection in found.bridgeConnections
    }


def test_figure_5_runs_as_printed(read):
    result = read(FIGURE_5)
    assert not check(result).has_errors
    found, ways = connections(result)
    assert (found.name, found.address, found.frequency) == ("maps_bridge", "100.1.20", 20.0)
    assert [provide.name for provide in found.provides] == ["Discovery", "Maps"]
    assert ways == {
        "WinchState_from_jaus": (
            "jausToRos", "periodicEvent", ["Maps"], ["WinchState/from_jaus"],
        ),
        "WinchState_to_jaus": ("rosToJaus", "periodicEvent", [], ["WinchState/to_jaus"]),
    }  # fmt: skip


def test_messages_of_the_library_go_the_way_of_their_services(read):
    result = read(LIBRARY)
    report = check(result)
    assert not report.has_errors, report.diagnostics
    found, ways = connections(result)
    assert ways == {
        "speed": ("jausToRos", "periodicEvent", ["VelocityStateSensor"], ["speed"]),
        "effort": ("jausToRos", "message", [], ["effort"]),
        "pull": ("rosToJaus", "message", ["PrimitiveDriver"], ["pull"]),
    }
    assert [provide.name for provide in found.provides] == ["Discovery", "PrimitiveDriver"]
    assert [service.name for service in found.uses] == ["VelocityStateSensor", "PrimitiveDriver"]


def test_findings_stand_at_the_maps(read):
    [finding] = [
        diagnostic
        for diagnostic in check(read(FIGURE_5)).diagnostics
        if diagnostic.rule == "JML455"
    ]
    assert finding.location.line == FIGURE_5.split("\n").index(
        "  JAUS WinchStatus ( uint16 length  Position here  Codes codes )"
    ) + 1  # fmt: skip


def test_a_file_with_a_system_has_its_own_bridge(read):
    result = read(f"component vehicle {{ address: 100.1.1 }}\n{LIBRARY}")
    assert [diagnostic.rule for diagnostic in result.diagnostics] == ["JML716"]
    assert result.model.instances(bridge.Bridge) == []


def test_maps_of_imported_files_have_no_bridge(read, texts):
    texts.write("other.ros2jaus", LIBRARY)
    result = read(f'import "other.ros2jaus"\n{FIGURE_5}')
    assert [element.name for element in result.model.instances(bridge.Bridge)] == ["maps_bridge"]


def run(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def test_tools_take_the_options(texts):
    maps = texts.write("maps.ros2jaus", FIGURE_5)
    options = ("--bridge-address", "100.1.20", "--frequency", "20")
    assert run("validate", maps, *options).exit_code == 0
    for name in ("bridge.xmi", "bridge.ros2jaus"):
        assert run("convert", maps, texts.folder / name, *options).exit_code == 0
        result = texts.read(name)
        assert not result.has_errors
        assert connections(result)[1].keys() == {"WinchState_from_jaus", "WinchState_to_jaus"}


@pytest.mark.parametrize(
    ("file", "options", "said"),
    [
        ("maps.ros2jaus", ("--bridge-address", "100.1"), "JAUS id such as 100.1.20"),
        ("maps.xmi", ("--bridge-address", "100.1.20"), "takes the maps of a .ros2jaus file"),
    ],
)
def test_wrong_options_are_refused(texts, file, options, said):
    path = texts.write(file, FIGURE_5)
    result = run("validate", path, *options)
    assert result.exit_code == 2
    assert said in result.output
