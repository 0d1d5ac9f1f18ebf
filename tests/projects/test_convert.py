"""`jausml convert` in a project: what becomes XMI leads Eclipse to the copies that lie there."""

import re
from pathlib import Path

import pytest

IDS = r' xmi:id="\w+"'


@pytest.fixture
def text_of_xmi(rover):
    """Makes a project whose XMI model became text; returns both."""
    words = "new bridge face odom:nav_msgs/Odometry:local_pose cmd:geometry_msgs/Twist --yes"
    convert = ("convert", "models/rover.xmi", "models/rover.ros2jaus")
    model = rover("xmi", tuple(words.split()), convert)
    return model, model.with_suffix(".ros2jaus")


def test_xmi_that_became_text_is_the_same_when_it_comes_back(text_of_xmi, jausml):
    model, text = text_of_xmi
    again = model.with_name("again.xmi")
    jausml("convert", text, again)
    before, after = (re.sub(IDS, "", path.read_text("utf-8")) for path in (model, again))
    assert after == before


@pytest.mark.slow
def test_ready_maps_of_text_become_copies_that_eclipse_reads(rover, jausml):
    model = rover("text")
    words = "new bridge face odom:nav_msgs/Odometry:local_pose_enu cmd:geometry_msgs/Twist --yes"
    jausml(*words.split())
    xmi = model.with_suffix(".xmi")
    done = jausml("convert", model, xmi)
    assert "Eclipse cannot read" not in done.output
    assert "models/mappings/local_pose_sensor.xmi: written" in done.output
    written = xmi.read_text("utf-8")
    assert 'xsi:schemaLocation="' in written
    assert '<map href="mappings/local_pose_sensor.xmi#local_pose_enu"/>' in written
    assert "http://www.jausml.org/library" not in written
    model.unlink()
    jausml("validate", "models")
    jausml("convert", xmi, xmi.with_name("b.xmi"))
    assert xmi.with_name("b.xmi").read_text("utf-8") == written


def test_comments_of_xmi_that_stay_behind_are_counted(rover, jausml):
    model = rover("xmi")
    model.write_text(model.read_text("utf-8") + "<!-- mine -->\n", encoding="utf-8")
    done = jausml("convert", model, "models/a.ros2jaus")
    assert "1 comment stays behind" in done.output


def test_a_file_that_cannot_be_read_where_it_goes_is_told(text_of_xmi, jausml, tmp_path):
    model, _ = text_of_xmi
    (tmp_path / "other" / ".git").mkdir(parents=True)
    done = jausml("convert", model, tmp_path / "other" / "a.ros2jaus")
    assert f"lies outside of {tmp_path / 'other'}" in done.output


TOPICS = ["fix:sensor_msgs/NavSatFix", "imu:sensor_msgs/Imu", "cmd_vel:geometry_msgs/Twist"]


@pytest.mark.slow
def test_joins_go_where_their_maps_go(tmp_path, jausml, monkeypatch):
    """Of a map that joins two topics: both ways, and back again."""
    made = ("init", "p", "--notation", "text", "--from", "topics", *TOPICS, "--yes")
    monkeypatch.chdir(tmp_path)
    jausml(*made)
    monkeypatch.chdir(tmp_path / "p")
    [joined] = Path("models").glob("p.*")
    jausml("validate", joined, "--strict")
    endings = [".xmi", ".ros2jaus"] * 2
    names = [f"{number}{ending}" for number, ending in enumerate(endings)]
    source = joined
    for target in (joined.with_name(name) for name in names):
        jausml("convert", source, target)
        jausml("validate", target, "--strict")
        source = target
    assert "jausml.org/library/mappings" not in joined.with_name(names[0]).read_text("utf-8")


@pytest.mark.slow
def test_what_would_be_broken_is_not_written(jausml, tmp_path, monkeypatch):
    """A copy of ready maps that somebody changed lacks what the model refers to."""
    monkeypatch.chdir(tmp_path)
    made = ("init", "p", "--notation", "text", "--from", "topics", *TOPICS, "--yes")
    jausml(*made)
    model, target = Path("p/models/p.ros2jaus"), Path("p/models/p.xmi")
    jausml("convert", model, target)
    copy = target.parent / "mappings" / "global_pose_sensor.xmi"
    words = re.sub('(<joins [^>]*name=")', r"\1other_", copy.read_text("utf-8"))
    copy.write_text(words, encoding="utf-8")
    before = target.read_bytes()
    done = jausml("convert", model, target, "--force", status=1)
    assert "nothing written" in done.stderr
    assert f"{target}:" in done.stderr
    assert target.read_bytes() == before


ODOM = ("new", "bridge", "ears", "odom:nav_msgs/Odometry:local_pose")
POINT = "pose.pose.position"
MISSPELT = f"mine {{ JAUS ReportLocalPose ROS nav_msgs/Odometry ROS->JAUS ( {POINT}.q -> X ) }}"


def test_copies_without_a_folder_to_write_into_leave_the_file_unwritten(rover, jausml):
    model = rover("text", ODOM)
    model.with_name("mappings").touch()
    done = jausml("convert", model, "models/a.xmi", status=2)
    assert "cannot write" in done.stderr, done.output
    assert not Path("models/a.xmi").exists()


def test_an_error_of_the_model_hides_no_other_one_of_its_rule(rover, jausml):
    model = rover("text", ODOM)
    text = model.read_text("utf-8").replace("connection odom", f"{MISSPELT} connection odom")
    model.write_text(text, encoding="utf-8")
    jausml("convert", model, "models/a.xmi")
    copy = Path("models/mappings/local_pose_sensor.xmi")
    copy.write_text(copy.read_text("utf-8").replace(f"{POINT}.x", f"{POINT}.q"), encoding="utf-8")
    done = jausml("convert", model, "models/b.xmi", status=1)
    assert not Path("models/b.xmi").exists(), done.output
    assert f"{copy}:" in done.stderr
    assert "JML411" in done.stderr
