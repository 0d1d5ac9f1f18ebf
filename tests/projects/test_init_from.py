"""`jausml init --from topics|jsidl`: projects that begin with what is there."""

from pathlib import Path

import emf_check
import pytest
from profiles import decided
from sweeps import sweep

WINCH = Path(__file__).parents[1] / "importers" / "winch"
TOPICS = ("--from", "topics", "cmd_vel:geometry_msgs/Twist", "scan:sensor_msgs/LaserScan", "--yes")
JSIDL = ("--from", "jsidl", WINCH)


@pytest.mark.parametrize(("notation", "origin"), [("xmi", TOPICS), ("text", JSIDL)])
def test_it_validates_and_generates(tmp_path, monkeypatch, jausml, notation, origin):
    jausml("init", tmp_path / "rover", "--notation", notation, *origin)
    monkeypatch.chdir(tmp_path / "rover")
    jausml("validate", "models")
    model = "models/rover.xmi" if notation == "xmi" else "models/rover.ros2jaus"
    jausml("generate", model, "-o", "src")


def test_a_robot_for_the_judge_leaves_safety_to_a_person(tmp_path, monkeypatch, jausml):
    done = jausml("init", tmp_path / "rover", "--from", "igvc")
    monkeypatch.chdir(tmp_path / "rover")
    model = Path("models/rover.ros2jaus")
    done = jausml("validate", "models", status=1)
    assert done.output.count("error") == done.output.count("error: JML498 open in 'waypoints'") + 1
    assert "say what stops a drive" in done.output
    assert "say who may command" in done.output
    jausml("generate", model, "-o", "src", status=1)
    jausml("format", "--check", "models")

    lines = model.read_text(encoding="utf-8").splitlines(keepends=True)
    model.write_text(
        "".join(line for line in lines if "openDecisions" not in line), encoding="utf-8"
    )
    done = jausml("validate", "models", "--strict")


@pytest.mark.parametrize(
    ("profile", "codes", "asked"),
    sweep(
        [
            ("iop-manipulator", ["JML498"] * 4 + ["JML451"], "which joints there are"),
            ("iop-ugv", ["JML498"] * 3 + ["JML451"], "after how much silence the vehicle stops"),
            ("iop-payload", ["JML498"] * 3, "after how much silence the unit stops"),
            ("iop-operator", ["JML498"] * 3, "which authority the unit has over others"),
        ],
        every=4,
    ),
)
def test_a_profile_of_iop_leaves_safety_to_a_person(
    tmp_path, monkeypatch, jausml, profile, codes, asked
):
    jausml("init", tmp_path / "robot", "--from", profile)
    monkeypatch.chdir(tmp_path / "robot")
    model = Path("models/robot.ros2jaus")
    jausml("format", "--check", "models")
    done = jausml("validate", "models", status=1)
    errors = [line for line in done.output.splitlines() if ": error: " in line]
    assert [error.split(": error: ")[1][:6] for error in errors] == codes
    assert f"say {asked}" in done.output
    jausml("generate", model, "-o", "src", status=1)

    model.write_text(decided(profile, model.read_text(encoding="utf-8")), encoding="utf-8")
    jausml("validate", "models", "--strict")
    done = jausml("generate", model, "-o", "src")


@pytest.mark.needs("emf")
def test_eclipse_opens_services_without_a_word(tmp_path, jausml):
    jausml("init", tmp_path / "rover", *JSIDL)
    done = emf_check.ask("models/rover.xmi", cwd=tmp_path / "rover")
    assert (done.returncode, done.stdout) == (0, "")


@pytest.mark.parametrize(
    ("options", "status", "told"),
    [
        (("--from", "topics"), 2, "needs SOURCEs, such as odom:nav_msgs/Odometry"),
        (("--from", "igvc", "--notation", "xmi"), 2, "leave out --notation"),
        (("--from", "igvc", "a:geometry_msgs/Twist"), 2, "--from igvc takes no SOURCE"),
        (("a:geometry_msgs/Twist",), 2, "takes no SOURCE; did you mean --from topics?"),
        (("--from", "topics", "a:std_msgs/String"), 2, "no ready map carries std_msgs/String"),
        (("--from", "jsidl", WINCH / "Winch.jsidl"), 1, "nothing written"),
        (("--from", "jsidl", "missing.jsidl"), 2, "missing.jsidl"),
        (("--copies", "odom:nav_msgs/Odometry"), 2, "Error: --copies takes no SOURCE\n"),
        (("--copies", "--yes"), 2, "--yes: not with --copies"),
    ],
)
def test_what_cannot_be_begun_writes_nothing(tmp_path, jausml, options, status, told):
    assert told in jausml("init", tmp_path / "rover", *options, status=status).output
    assert not (tmp_path / "rover").exists()


def test_it_overwrites_nothing(tmp_path, jausml):
    jausml("init", tmp_path / "rover", "--from", "empty")
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    for origin in (TOPICS, JSIDL):
        done = jausml("init", tmp_path / "rover", *origin, status=2)
        assert "is there already; nothing was written" in done.output
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before
