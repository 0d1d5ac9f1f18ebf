"""`jausml import ros`: what it writes, what it says, and what it leaves alone."""

import json
import sys

import pytest
from scripts import succeeded

WINCH = "# A winch.\n\nstd_msgs/Header header\nfloat64 speed # Of the rope [m/s].\nuint8 IDLE=0\n"


@pytest.fixture
def folder(here, monkeypatch):
    """A current folder with a package in source form, and one that is installed."""
    monkeypatch.setenv("AMENT_PREFIX_PATH", "prefix")
    definitions = {
        "src/winch_msgs/msg/Winch.msg": WINCH,
        "src/winch_msgs/srv/Pull.srv": "float64 length\n---\nbool success\n",
        "prefix/share/rope_msgs/msg/Rope.msg": "float64 length\n",
        "prefix/share/ship_msgs/msg/Ship.msg": "rope_msgs/Rope[] ropes\n",
    }
    for name, text in definitions.items():
        (here / name).parent.mkdir(parents=True, exist_ok=True)
        (here / name).write_text(text, encoding="utf-8")
    return here


def test_a_folder_becomes_a_model_that_is_valid(jausml, folder):
    done = jausml("import", "ros", "src")
    assert (done.exit_code, done.stdout) == (0, "")
    assert done.stderr == ("winch_msgs.xmi: 1 package, 1 message, 1 service, 0 actions, written\n")
    assert jausml("validate", "winch_msgs.xmi").exit_code == 0
    written = (folder / "winch_msgs.xmi").read_text(encoding="utf-8")
    assert 'documentation="A winch."' in written
    assert 'units="m/s"' in written
    assert "unchanged" in jausml("import", "ros", "src").stderr


def test_an_installed_package_brings_along_what_it_needs(jausml, folder):
    done = jausml("import", "ros", "ship_msgs", "-o", "models/")
    assert done.exit_code == 0
    assert "JML662" in done.stdout
    names = sorted(path.name for path in (folder / "models").iterdir())
    assert names == ["rope_msgs.xmi", "ship_msgs.xmi"]
    assert '"rope_msgs.xmi#Rope"' in (folder / "models" / "ship_msgs.xmi").read_text()
    assert jausml("validate", "models").exit_code == 0


@pytest.mark.usefixtures("folder")
def test_several_packages_become_one_document(jausml):
    done = jausml("import", "ros", "ship_msgs", "src/winch_msgs", "-o", "all.xmi", "-q")
    assert (done.exit_code, done.stderr) == (0, "")
    assert jausml("validate", "all.xmi").exit_code == 0


def test_comments_may_be_left_out(jausml, folder):
    assert jausml("import", "ros", "src", "--without-comments").exit_code == 0
    written = (folder / "winch_msgs.xmi").read_text(encoding="utf-8")
    assert "documentation" not in written
    assert "units" not in written


def test_errors_leave_the_output_alone(jausml, folder):
    (folder / "winch_msgs.xmi").write_text("precious", encoding="utf-8")
    path = folder / "src/winch_msgs/msg/Winch.msg"
    path.write_text("float63 x\nuint8 A=300\n", encoding="utf-8")
    done = jausml("import", "ros", "src", "--force")
    assert done.exit_code == 1
    lines = done.stdout.splitlines()
    place = "src/winch_msgs/msg/Winch.msg"
    assert lines[0].startswith(f"{place}:1:1: error: JML644 'float63' is no type")
    assert "did you mean 'float64'?" in lines[0]
    assert lines[1].startswith(f"{place}:2:9: error: JML646")
    assert "nothing written" in done.stderr
    assert (folder / "winch_msgs.xmi").read_text() == "precious"


def test_a_file_that_differs_is_overwritten_by_force_alone(jausml, refused, folder):
    (folder / "winch_msgs.xmi").write_text("precious", encoding="utf-8")
    refused("--force", "import", "ros", "src")
    assert jausml("import", "ros", "src", "--force").exit_code == 0
    assert (folder / "winch_msgs.xmi").read_text().startswith("<?xml")


def test_a_definition_is_never_overwritten(jausml, folder):
    path = "src/winch_msgs/msg/Winch.msg"
    assert jausml("import", "ros", "src", "-o", path, "--force").exit_code == 2
    assert (folder / path).read_text(encoding="utf-8") == WINCH


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["rope_msg"], "did you mean 'rope_msgs'?"),
        (["missing/Winch.msg"], "No such file"),
        (["prefix/share/rope_msgs/msg"], None),
        (["nothing"], "no package 'nothing' is installed"),
        (["bad\x00name"], "no package"),
        (["prefix"], None),
        (["empty"], "no .msg or .srv or .action or .idl files in empty"),
    ],
)
def test_what_is_not_there(jausml, folder, words, said):
    (folder / "empty").mkdir()
    done = jausml("import", "ros", *words, "-o", "out.xmi")
    assert done.exit_code == (2 if said else 0)
    assert (said or "written") in done.stderr


def test_another_share_folder_goes_first(jausml, folder):
    path = folder / "other/rope_msgs/msg/Rope.msg"
    path.parent.mkdir(parents=True)
    path.write_text("float32 weight\n", encoding="utf-8")
    assert jausml("import", "ros", "rope_msgs", "--share", "other").exit_code == 0
    assert 'name="weight"' in (folder / "rope_msgs.xmi").read_text()


def test_findings_as_json(jausml, folder):
    (folder / "src/winch_msgs/msg/Winch.msg").write_text("float63 x\n", encoding="utf-8")
    done = jausml("import", "ros", "src", "--format", "json", "-q")
    assert done.exit_code == 1
    (finding,) = json.loads(done.stdout)["diagnostics"]
    assert finding["rule"] == "JML644"


def test_rules_are_listed_and_explained(jausml):
    listed = jausml("rules").stdout
    for rule in ("JML641", "JML650", "JML662", "JML409"):
        assert rule in listed
    assert "three hyphens" in jausml("explain", "JML649").stdout


def test_ros_itself_is_not_needed(folder):
    """Reads definitions where nothing of ROS can be imported."""
    program = (
        "import sys\n"
        "for name in ('rclpy', 'ament_index_python', 'rosidl_parser', 'rosidl_adapter'):\n"
        "    sys.modules[name] = None\n"
        "from jausml.cli import main\n"
        "main(['import', 'ros', 'ship_msgs', '-o', 'ship.xmi'])\n"
    )
    succeeded([sys.executable, "-c", program])
    assert (folder / "ship.xmi").is_file()
