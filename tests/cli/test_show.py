"""`jausml show` and `jausml list maps`."""

import json
import re
from pathlib import Path

import pytest
from sweeps import sweep

from jausml.live.messages import load_catalogue
from jausml.live.messages.text import example, rows, sample

TEXT_MODEL = """
/** Pays rope out. */
winch {
    JAUS SetWinch (
        uint16 length { units: "cm"  documentation: "Rope that is out." }
        bool brake { optional: true }
    ) { code: 0xD111  isCommand: true }
    ROS std_msgs/UInt16
    ROS->JAUS ( data -> length )
    quantity longest { value: 90  units: "m" }
}
"""

TYPE = """
rope {
    JAUS ReportRope ( float32 Length ) { code: 0xD112 }
    ROS rope_msgs/Rope ( float32 length { markers: { meaning: none  condition: "value < 0" } } )
    ROS->JAUS ( length -> Length )
}
"""


pytestmark = pytest.mark.usefixtures("here")


@pytest.fixture
def acme(tmp_path):
    (tmp_path / "acme.ros2jaus").write_text(TEXT_MODEL)
    return ("--model", "acme.ros2jaus")


@pytest.fixture(scope="session")
def catalogue():
    return load_catalogue()


def test_a_message_has_a_line_for_each_field(jausml):
    result = jausml("show", "message", "SetVelocityCommand")
    assert result.exit_code == 0, result.stderr
    head, *lines = result.stdout.splitlines()
    assert head == "SetVelocityCommand 0x0415 (command)"
    assert lines[0] == "  of urn:jaus:jss:mobility:VelocityStateDriver/1.0"
    text = re.sub(" +", " ", result.stdout)
    assert "\n VelocityCommandRec record with presence uint8\n" in text
    assert "\n CommandType uint8 0 'Set current command'\n 1 'Set maximum allowed values'\n" in text
    assert "\n YawRate scaled uint16 optional -32.768 .. 32.767, step 0.001 radian per sec" in text


def test_the_example_of_a_message_can_be_encoded(jausml):
    shown = jausml("show", "message", "SetVelocityCommand")
    line = re.search("jausml encode: +(.*)", shown.stdout)[1]
    assert json.loads(line)["fields"]["VelocityCommandRec"]["CommandType"] == "Set current command"
    assert jausml("encode", text=line).exit_code == 0


def test_a_message_in_json(jausml):
    result = jausml(
        "show", "message", "ReportStatus", "--service", "Management/1.1", "--format", "json"
    )
    content = json.loads(result.stdout)
    assert (
        content.items() >= {"message": "ReportStatus", "code": "0x4002", "command": False}.items()
    )
    (status,) = (field for field in content["fields"] if field["path"] == "ReportStatusRec.Status")
    assert (status["type"], status["presence"]) == ("uint8", "always")
    assert status["names"]["5"] == "EMERGENCY"
    assert jausml("encode", text=json.dumps(content["example"])).exit_code == 0


def test_an_example_takes_no_value_that_is_reserved(catalogue):
    fields = example(catalogue.message("QueryIdentification", "Discovery/1.1"))
    assert fields == {"QueryIdentificationRec": {"QueryType": "System Identification"}}


def test_all_meanings_of_a_code_are_shown(jausml):
    result = jausml("show", "message", "F932")
    assert "RNDetailedMeasurement 0xF932" in result.stdout
    assert "\n\nCBDetailedMeasurement 0xF932" in result.stdout


def test_examples_and_samples_of_all_messages_are_legal(catalogue):
    for entry in catalogue.messages:
        assert entry.decode(entry.encode(example(entry))) is not None
        assert entry.encode(sample(entry.record)) is not None
        paths = [row.path for row in rows(entry)]
        assert len(paths) >= len(entry.record.members)


def test_kinds_of_fields_that_the_library_has_not(jausml):
    model = Path(__file__).parents[1] / "generators" / "every_kind.xmi"
    result = jausml("show", "message", "Kinds", "--model", model)
    assert result.exit_code == 0, result.stderr
    text = re.sub(" +", " ", result.stdout)
    for line in ("Matrix array of 2 x 2", "Gap uint8 0, 4 .. 7\n 0 'off'", "Choice variant"):
        assert line in text


def test_a_message_of_an_own_model_in_text(jausml, acme):
    result = jausml("show", "message", "SetWinch", *acme)
    text = re.sub(" +", " ", result.stdout)
    assert "SetWinch 0xD111 (command)" in text
    assert "length uint16 cm\n Rope that is out.\n" in text
    assert "brake uint8 optional 0 'FALSE'\n 1 'TRUE'\n" in text


def test_a_service_names_what_it_inherits_takes_and_sends(jausml):
    result = jausml("show", "service", "VelocityStateDriver")
    assert result.stdout.splitlines()[:3] == [
        "VelocityStateDriver 1.0 (mobility)",
        "  urn:jaus:jss:mobility:VelocityStateDriver",
        "  inherits Management 1.0, which inherits AccessControl 1.0, which inherits Events 1.0, "
        "which inherits Transport 1.0",
    ]
    assert "  takes  0x0415  SetVelocityCommand (command)\n" in result.stdout
    assert "  sends  0x4415  ReportVelocityCommand\n" in result.stdout


def test_versions_of_a_service_in_json(jausml):
    result = jausml("show", "service", "Management", "--format", "json")
    found = [json.loads(line) for line in result.stdout.splitlines()]
    assert [service["version"] for service in found] == ["1.0", "1.1"]
    assert {"message": "Resume", "code": "0x0004", "command": True} in found[0]["inputs"]


def test_a_ros_type_says_by_which_values_its_fields_have_none(jausml):
    result = jausml("show", "type", "sensor_msgs/msg/NavSatFix")
    assert result.exit_code == 0, result.stderr
    text = re.sub(" +", " ", result.stdout)
    assert text.startswith("sensor_msgs/NavSatFix\n")
    assert "\n status sensor_msgs/NavSatStatus\n" in text
    assert re.search(r"\n altitude float64 m\n unknown if value != value, written NaN \(", text)
    assert re.search(r"\n latitude float64 degree\n unknown if status.status < 0 \(NavSat", text)
    shown = json.loads(jausml("show", "type", "nav_msgs/Odometry", "--format", "json").stdout)
    (orientation,) = (f for f in shown["fields"] if f["path"] == "pose.pose.orientation")
    assert orientation["type"] == "geometry_msgs/Quaternion"
    assert orientation["markers"][0].startswith("unknown if orientation.x == 0 and ")


def test_a_ros_type_of_an_own_model(jausml, tmp_path):
    (tmp_path / "own.ros2jaus").write_text(TYPE)
    result = jausml("show", "type", "rope_msgs/Rope", "--model", "own.ros2jaus")
    assert re.sub(" +", " ", result.stdout).endswith("length float32 none if value < 0\n")


def test_a_map_tells_its_quantities_and_how_to_import_it(jausml, tmp_path):
    result = jausml("show", "map", "wrench_effort")
    assert result.stdout.startswith("wrench_effort: SetWrenchEffort (PrimitiveDriver) and geom")
    for line in (
        "  directions: JAUS->ROS, ROS->JAUS\n",
        "  quantity max_speed: 2 m/s, which a bridge may override\n",
        "in text:  import mappings.primitive_driver\n          map: wrench_effort\n",
    ):
        assert line in result.stdout
    convert = re.search("jausml (convert .*)", result.stdout)[1].split()
    assert jausml(*convert).exit_code == 0
    assert 'xmi:id="wrench_effort"' in (tmp_path / "primitive_driver.xmi").read_text()


def test_a_map_tells_its_joins_in_json(jausml):
    result = jausml("show", "map", "global_pose", "--format", "json")
    content = json.loads(result.stdout)
    assert content["type"] == "sensor_msgs/NavSatFix"
    (join,) = content["joins"]
    assert (join["name"], join["type"]) == ("imu", "sensor_msgs/Imu")


def test_an_own_map_beside_the_ready_ones(jausml, acme):
    result = jausml("show", "map", "winch", *acme)
    assert "  Pays rope out.\n\n  directions: ROS->JAUS\n" in result.stdout
    assert "  file: acme.ros2jaus:3\n" in result.stdout
    listed = jausml("list", "maps", "--jaus", "SetWinch", *acme).stdout.splitlines()
    assert [line.split()[:4] for line in listed[1:]] == [
        ["winch", "SetWinch", "std_msgs/UInt16", "ROS->JAUS"]
    ]


@pytest.mark.parametrize("name", ["nav_msgs/Odometry", "nav_msgs/msg/Odometry", "Odometry"])
def test_maps_of_a_ros_type(name, jausml):
    lines = jausml("list", "maps", "--ros", name).stdout.splitlines()
    words = {line.split()[0] for line in lines[1:]}
    assert words == {"local_pose", "local_pose_enu", "odometry", "velocity_state"}


def test_maps_of_a_joined_type_and_a_message_in_json(jausml):
    result = jausml(
        *("list", "maps", "--ros", "sensor_msgs/Imu", "--jaus", "ReportGlobalPose"),
        *("--format", "json"),
    )
    found = [json.loads(line) for line in result.stdout.splitlines()]
    assert "global_pose" in {listed_map["map"] for listed_map in found}


def test_maps_of_a_joined_report(jausml):
    result = jausml("list", "maps", "--jaus", "ReportVelocityState", "--format", "json")
    found = {entry["map"]: entry for entry in map(json.loads, result.stdout.splitlines())}
    (join,) = found["odometry"]["reportJoins"]
    assert (join["name"], join["message"]) == ("velocity", "ReportVelocityState")
    shown = jausml("show", "map", "odometry").stdout
    assert "  join velocity: ReportVelocityState, fresh for 0.5 s, then dropMessage\n" in shown


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (("show", "message", "SetVelocityComand"), "did you mean SetVelocityCommand"),
        (("show", "message", "ReportStatus", "--service", "Nowhere"), "no service 'Nowhere'"),
        (("show", "service", "Managment"), "did you mean Management"),
        (("show", "type", "nav_msgs/Odometri"), "did you mean nav_msgs/Odometry?"),
        (("show", "nav_msgs/Odometry"), "jausml show type nav_msgs/Odometry"),
        (("show", "map", "velocty_command"), "did you mean velocity_command"),
        (("show", "map", "qqqqqqqq"), "`jausml list maps` lists them"),
        (("list", "maps", "--ros", "nav_msgs/Odometri"), "did you mean nav_msgs/Odometry?"),
        (("list", "maps", "--jaus", "SetWrenchEfort"), "did you mean SetWrenchEffort"),
    ],
)
def test_what_is_unknown_is_told_with_what_is_similar(words, error, refused):
    refused(error, *words)


@pytest.mark.slow
def test_a_model_with_errors_shows_none(jausml, tmp_path):
    (tmp_path / "bad.ros2jaus").write_text("map {")
    for words in (("show", "map", "x"), ("show", "message", "x"), ("list", "maps")):
        result = jausml(*words, "--model", "bad.ros2jaus")
        assert result.exit_code == 1
        assert "bad.ros2jaus:1:" in result.stderr


@pytest.mark.parametrize(
    ("words", "parts", "shown"),
    # To list all reads all ready maps, twice where a model is broken.
    sweep(
        [
            (("show", "map", "odometry"), "maps", "odometry"),
            (("list", "maps"), "maps", "mappings.odometry"),
            (("show", "type", "std_msgs/String"), "types", "std_msgs/String\n"),
        ],
        every=lambda case: case[0][0] == "show",
    ),
)
def test_all_but_a_broken_model_of_the_project_is_shown(jausml, monkeypatch, words, parts, shown):
    made = jausml("init", "lot", "--from", "empty", "--notation", "text", "-q")
    assert made.output == ""
    monkeypatch.chdir("lot")
    Path("models/bad.ros2jaus").write_text("bridge b { adress: 1.1.1 }")
    result = jausml(*words)
    assert result.exit_code == 0, result.stderr
    assert f"the {parts} of models/bad.ros2jaus are left out: " in result.stderr
    assert "models/bad.ros2jaus:1:12: " in result.stderr
    assert shown in result.stdout


@pytest.mark.parametrize("words", [("map", "velocity"), ("type", "geometry_msgs/TwistStamped")])
def test_models_refer_to_what_lies_beside_them(jausml, tmp_path, monkeypatch, words):
    assert jausml("init", "lot", "-q").output == ""
    monkeypatch.chdir(tmp_path / "lot")
    Path(".project").unlink()  # such as in a copy
    result = jausml("show", *words, "--model", "models")
    assert (result.exit_code, result.stderr) == (0, "")
