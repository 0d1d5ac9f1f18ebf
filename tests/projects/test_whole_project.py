"""Verbs know the whole project: what stands in its other files is named like what stands in one."""

import json
from pathlib import Path

import pytest
from sweeps import sweep

from jausml import decode, encode
from jausml.live.messages import UnknownMessageError

TANK = "uint8 SEALED=0\nuint8 FLOODING=1\nuint8 state\nfloat32 level # [%]\n"
SERVICE = """import `jaus.core-1.1`
service_set own { service Tanks {
    urn: "urn:example:rover:Tanks"  inherits: Events
    inputs: new message_def QueryTanks { code: 0xD201 }
    outputs: new message_def ReportTanks { code: 0xD401 record TanksRec {
        fixed_field Level { type: uint16  units: "percent"  scale: { lower: 0  upper: 100 } }
        fixed_field State {
            values: { enumerated_value sealed { value: 0 } enumerated_value flooding { value: 1 } }
        }
    } }
} }
"""
MANIFEST = '<package format="3"><name>{}</name><version>1.0.0</version></package>\n'
WINCH = Path(__file__).resolve().parents[1] / "importers" / "winch"


FILES = (
    ("src/abyss_msgs/msg/Tank.msg", TANK),
    ("src/abyss_msgs/package.xml", MANIFEST.format("abyss_msgs")),
    ("models/tanks.ros2jaus", SERVICE),
)
ABYSS = (
    ("import", "ros", "src/abyss_msgs", "-o", "models/"),
    ("new", "bridge", "main", "odom:nav_msgs/Odometry", "--yes"),
)
TANKS = (
    ("new", "map", "tanks", "ReportTanks", "abyss_msgs/Tank", "--yes"),
    ("new", "connection", "tank:abyss_msgs/Tank", "--yes"),
)


@pytest.fixture(params=sweep(["text", "xmi"], every=2, rest=0))
def notation(request):
    return request.param


@pytest.fixture
def abyss(notation, rover):
    """A project with a bridge and an own package of messages, imported into its models."""
    return rover(notation, *ABYSS, files=FILES)


@pytest.fixture
def tanks(notation, rover):
    """The project with a map of its own and a topic that it carries."""
    return rover(notation, *ABYSS, *TANKS, files=FILES)


def test_a_type_of_an_imported_package_needs_no_import_by_hand(tanks, jausml):
    text = tanks.read_text("utf-8")
    way = 'import "abyss_msgs.xmi"' if tanks.suffix == ".ros2jaus" else 'href="abyss_msgs.xmi#'
    assert way in text
    done = jausml("validate")
    assert "error" not in done.output


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("ReportTanks", "abyss_msgs/Tnak"), "did you mean 'abyss_msgs/Tank'?"),
        (("ReportTanks", "other_msgs/Tank"), "'jausml import ros other_msgs' brings that package"),
        (("ReportTanksx", "abyss_msgs/Tank"), "did you mean 'ReportTanks'?"),
    ],
)
def test_what_is_not_found_names_what_is_near_and_what_helps(abyss, refused, words, told):
    refused(told, abyss, "new", "map", "tanks", *words)


@pytest.mark.parametrize("origin", ["new", "jsidl"])
def test_services_of_other_files_are_found(rover, jausml, origin):
    model = rover("text")
    if origin == "new":
        made = ("new", "service", "Winch", "-m", "models/winch.ros2jaus")
    else:
        made = ("import", "jsidl", WINCH, "-o", "models/winch.xmi")
    jausml(*made)
    jausml("new", "component", "deck", "--provides", "Winch")
    assert 'import "winch.' in model.read_text("utf-8")
    jausml("validate")


def test_the_map_of_another_file_carries_a_topic(tanks, jausml):
    other = f"models/second{tanks.suffix}"
    words = f"new bridge second tank:abyss_msgs/Tank --yes -m {other}".split()
    done = jausml(*words)
    assert "tanks: reported as ReportTanks" in done.output
    done = jausml("validate", other)


def test_verbs_take_the_only_system_of_the_project(tanks, jausml, monkeypatch):
    monkeypatch.chdir(tanks.parent)
    done = jausml("generate", "-o", "../src", "-q")
    assert list((tanks.parents[1] / "src").glob("*/package.xml"))
    jausml("diagram", "-o", "../system.mmd")
    jausml("report", "-o", "../report.txt")
    other = tanks.with_name(f"second{tanks.suffix}")
    jausml("new", "bridge", "b", "odom:nav_msgs/Odometry", "--yes", "-m", other)
    done = jausml("generate", "-o", "../src", "-q", status=2)
    assert "several models" in done.output
    assert other.name in done.output


def test_outside_of_a_project_a_model_has_to_be_named(tmp_path, jausml, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for verb, missing in (("generate", "MODEL"), ("validate", "PATH")):
        done = jausml(verb, status=2)
        assert f"Missing argument '{missing}'" in done.output
        assert "jausml init DIR" in done.output


MESSAGE = json.dumps({"message": "ReportTanks", "fields": {"Level": 50, "State": 1}})


@pytest.mark.slow
def test_messages_of_the_project_are_known_in_it(tanks, jausml, tmp_path, monkeypatch):
    done = jausml("encode", MESSAGE)
    payload = done.stdout.strip()
    done = jausml("decode", payload)
    assert json.loads(done.stdout)["message"] == "ReportTanks"
    assert "ReportTanks" in jausml("show", "message", "ReportTanks").output
    assert "ReportTanks" in jausml("list", "messages").output
    assert "abyss_msgs/Tank" in jausml("list", "maps").output
    assert "urn:example:rover:Tanks" in jausml("list", "services").output
    done = jausml("encode", '{"message": "ReportTankz"}', status=1)
    assert "did you mean ReportTanks?" in done.output
    monkeypatch.chdir(tmp_path)
    done = jausml("encode", MESSAGE, status=1)
    assert "known in their project, elsewhere by --model FILE" in done.output
    done = jausml("encode", MESSAGE, "--model", tanks)
    assert done.stdout.strip() == payload


def test_the_python_interface_knows_them_too(tanks, jausml, tmp_path, monkeypatch):
    payload = encode("ReportTanks", {"Level": 50, "State": 1})
    assert payload.hex() == jausml("encode", MESSAGE).stdout.strip()
    assert decode(payload).entry.name == "ReportTanks"
    monkeypatch.chdir(tmp_path)
    with pytest.raises(UnknownMessageError):
        encode("ReportTanks")
    assert encode("ReportTanks", {"Level": 50, "State": 1}, models=str(tanks)) == payload


@pytest.mark.slow
def test_a_broken_model_beside_it_hides_no_other_messages(tanks, jausml):
    broken = tanks.with_name("broken.ros2jaus")
    broken.write_text("service Broken {{{\n", encoding="utf-8")
    done = jausml("encode", MESSAGE)
    assert f"the messages of {broken} are left out" in done.stderr
    jausml("validate", status=1)


@pytest.mark.slow
@pytest.mark.usefixtures("tanks")
def test_an_own_package_is_looked_for_on_this_machine(jausml):
    done = jausml("doctor", "--format", "json", status=1)
    found = {check["name"]: check for check in json.loads(done.stdout)["checks"]}
    assert found["abyss_msgs"]["verdict"] == "error"
    assert "colcon build" in found["abyss_msgs"]["cure"]
    assert "apt" not in found["abyss_msgs"]["cure"]
    assert "nav_msgs" in found


def test_the_deployment_says_what_the_workspace_does_not_have(tanks, jausml):
    jausml("generate", "-o", "src", "-q", "--target", "deployment", status=1)
    host = {
        ".xmi": '<hosts name="onboard" interface="10.0.0.1"/>\n</system:System>',
        ".ros2jaus": '    host onboard { interface: "10.0.0.1" }\n}',
    }[tanks.suffix]
    text = tanks.read_text("utf-8").rstrip()
    end = "</system:System>" if tanks.suffix == ".xmi" else "}"
    tanks.write_text(f"{text.removesuffix(end)}{host}\n", encoding="utf-8")
    jausml("generate", "-o", "src", "-q", "--target", "deployment")
    folder = tanks.parents[1] / "src" / "rover_deployment"
    assert "- `abyss_msgs`: a package of messages" in (folder / "README.md").read_text("utf-8")
    assert "# abyss_msgs is not generated" in (folder / "Containerfile").read_text("utf-8")


def test_a_text_without_a_system_says_what_it_lacks_for_a_service(rover, jausml):
    model = rover("text")
    model.write_text("bridge b { address: 100.1.1 }\n", encoding="utf-8")
    done = jausml("new", "service", "Tanks", status=2)
    assert "put system rover { ... } around what it has" in done.output
