"""`jausml upgrade`: models of older versions become models of the present one."""

from __future__ import annotations

import shutil
from pathlib import Path

import emf_check
import pytest
from needs import EMF

from jausml.authoring.projects.upgrading.project import carry_out, upgrade_of
from jausml.authoring.projects.upgrading.steps import Renamed, Step, UpgradeError, steps_from
from jausml.authoring.projects.upgrading.text import upgraded_text
from jausml.authoring.projects.upgrading.xmi import upgraded_xmi
from jausml.language.metamodel import load_metamodels

GOLDEN = Path(__file__).parent / "golden_1_0"
OLDER = Step(
    "bridge",
    (0, 9),
    (1, 0),
    (
        Renamed("bridge.Connection", "quietSeconds", "silenceTimeout"),
        Renamed("bridge.Bridge", "crossings", "bridgeConnections"),
        Renamed("ros.QoSProfile", "queue", "depth"),
    ),
)
"""A version that never was: three features of 1.0 had other names in it."""

NEW = """\
<?xml version="1.0" encoding="UTF-8"?>
<!-- Mine: depth queue crossings. -->
<bridge:Bridge xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:bridge="http://www.jausml.org/bridge/1.0" name='b' address="1.1.1"
    queue="not one of ours">
  <bridgeConnections name="depth"  silenceTimeout = '0.5'>
    <topics name="queue"><qos depth="3"/></topics>
  </bridgeConnections>
  <bridgeConnections name="empty"/>
  <connections message="//@bridgeConnections.0/@topics.0"/>
</bridge:Bridge>
"""
OLD = (
    NEW.replace("bridgeConnections", "crossings")
    .replace("silenceTimeout", "quietSeconds")
    .replace("<qos depth", "<qos queue")
    .replace("bridge/1.0", "bridge/0.9")
)
NEW_TEXT = """\
// Mine: queue.
bridge front {
    address: 1.1.1
    connection a { silenceTimeout: 0.5  topic queue { qos: { depth: 3 } } }
    velocity { JAUS ReportVelocityState ROS nav_msgs/Odometry JAUS->ROS ( queue -> depth ) }
}
"""
OLD_TEXT = NEW_TEXT.replace("silenceTimeout", "quietSeconds").replace("{ depth:", "{ queue:")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "iso-8859-1"])
def test_names_and_namespaces_of_xmi_change_and_nothing_else(encoding):
    def coded(text):
        declared = text.replace("UTF-8", encoding.removesuffix("-sig"))
        return declared.replace("Mine", "Größe").replace("\n", "\r\n").encode(encoding)

    made = upgraded_xmi(coded(OLD), "b.xmi", load_metamodels(), [OLDER])
    assert made == coded(NEW)
    assert upgraded_xmi(made, "b.xmi", load_metamodels(), [OLDER]) == made


@pytest.mark.parametrize("start", ["", "\ufeff"])
def test_names_of_text_change_and_nothing_else(start):
    old, new = (f"{start}{each}".encode() for each in (OLD_TEXT, NEW_TEXT))
    assert upgraded_text(old, "b.ros2jaus", load_metamodels(), [OLDER]) == new
    assert upgraded_text(new, "b.ros2jaus", load_metamodels(), [OLDER]) == new


def test_steps_are_taken_one_after_the_other():
    first, second = Step("ros", (0, 8), (0, 9)), Step("ros", (0, 9), (1, 0))
    assert steps_from("ros", (0, 8), (1, 0), [OLDER, first, second]) == [first, second]
    with pytest.raises(UpgradeError, match="nothing is known of it"):
        steps_from("ros", (0, 7), (1, 0), [first, second])
    with pytest.raises(UpgradeError, match="a later jausml reads it"):
        steps_from("ros", (1, 1), (1, 0), [first, second])


def test_the_golden_project_of_1_0_is_understood(tmp_path, monkeypatch, jausml):
    project = tmp_path / "golden"
    shutil.copytree(GOLDEN, project)
    (project / ".git").mkdir()
    monkeypatch.chdir(project)
    done = jausml("upgrade")
    assert done.exit_code == 0, done.output
    done = jausml("validate", "models", "--strict")
    assert done.exit_code == 0, done.output
    for model in ("rover.xmi", "boat.ros2jaus"):
        done = jausml("generate", f"models/{model}", "-o", f"src/{model}")
        assert done.exit_code == 0, done.output


def test_a_project_of_an_older_version_is_upgraded_as_a_whole(tmp_path):
    older = tmp_path / "older"
    shutil.copytree(GOLDEN, older)
    shutil.copytree(GOLDEN, tmp_path / "present")
    for path in sorted((older / "models").rglob("*.*")):
        text = path.read_text("utf-8").replace("bridge/1.0", "bridge/0.9")
        text = text.replace("bridgeConnections", "crossings").replace(" depth=", " queue=")
        path.write_text(text.replace("depth: ", "queue: "), "utf-8")
    upgrade = upgrade_of(older, [OLDER])
    assert len(upgrade.files) == len([*(older / "models").rglob("*.*")])
    carry_out(upgrade)
    for path in sorted((tmp_path / "present" / "models").rglob("*.*")):
        made = older / path.relative_to(tmp_path / "present")
        assert made.read_bytes() == path.read_bytes(), path
    assert upgrade_of(older, [OLDER]).files == {}


def test_what_cannot_be_upgraded_writes_nothing(tmp_path, jausml):
    shutil.copytree(GOLDEN, tmp_path / "golden")
    model = tmp_path / "golden" / "models" / "rover.xmi"
    for old, new, told in (
        ("system/1.0", "system/2.7", "models/rover.xmi:2: http://www.jausml.org/system/2.7 is"),
        ("system/1.0", "system/2.7", "a later jausml reads it; nothing written"),
        ("system/1.0", "system/0.1", "nothing is known of it; nothing written"),
        ("</system:System>", "", "models/rover.xmi:"),
    ):
        text = (GOLDEN / "models" / "rover.xmi").read_text("utf-8").replace(old, new)
        model.write_text(text, "utf-8")
        done = jausml("upgrade", tmp_path / "golden")
        assert done.exit_code == 1
        assert told in done.output
        assert model.read_text("utf-8") == text


def test_a_folder_without_models_is_not_up_to_date(tmp_path, jausml):
    done = jausml("upgrade", "--check", tmp_path)
    assert (done.exit_code, f"{tmp_path} holds no models" in done.output) == (2, True)


def test_copies_are_made_anew_unless_somebody_changed_them(tmp_path, jausml):
    folder = tmp_path / "rover"
    assert jausml("init", folder).exit_code == 0
    assert "present version" in jausml("upgrade", folder).output
    (folder / "metamodels" / "ros.ecore").unlink()
    old, mine = folder / "library" / "ros" / "std_msgs.xmi", folder / "metamodels" / "jaus.ecore"
    present = old.read_bytes()
    sums = folder / "library" / "SHA256SUMS"
    _as_of_an_older_tool(old, sums)
    mine.write_bytes(mine.read_bytes() + b"<!-- mine -->")
    done = jausml("upgrade", folder, "--check")
    assert (done.exit_code, old.read_bytes() == present) == (1, False)
    done = jausml("upgrade", folder)
    assert done.exit_code == 0, done.output
    assert "metamodels/jaus.ecore stays: it was changed here" in done.output
    assert "metamodels/ros.ecore upgraded" in done.output
    assert old.read_bytes() == present
    assert mine.read_bytes().endswith(b"<!-- mine -->")
    assert jausml("upgrade", folder, "--check").exit_code == 0


def _as_of_an_older_tool(copy, sums):
    """Changes a copy together with what is said of it, as an older tool would have made both."""
    import hashlib

    before = hashlib.sha256(copy.read_bytes()).hexdigest()
    copy.write_bytes(copy.read_bytes().replace(b"</", b"\n</", 1))
    after = hashlib.sha256(copy.read_bytes()).hexdigest()
    sums.write_text(sums.read_text("utf-8").replace(before, after), "utf-8")


@EMF
def test_eclipse_opens_a_project_after_an_upgrade(tmp_path, jausml):
    folder = tmp_path / "rover"
    assert jausml("init", folder).exit_code == 0
    model = folder / "models" / "rover.xmi"
    present = model.read_bytes()
    model.write_bytes(
        present.replace(b"bridge/1.0", b"bridge/0.9").replace(b"bridgeConnections", b"crossings")
    )
    carry_out(upgrade_of(folder, [OLDER]))
    assert model.read_bytes() == present
    done = emf_check.ask("models/rover.xmi", cwd=folder)
    assert (done.returncode, done.stdout) == (0, "")


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("a.xmi", bytes(3)),
        ("a.xmi", OLD[: len(OLD) // 2].encode()),
        ("a.xmi", NEW[: len(NEW) // 2].encode()),
        ("a.ros2jaus", bytes(3)),
        ("a.ros2jaus", NEW_TEXT[: len(NEW_TEXT) // 2].encode()),
        ("a.ros2jaus", b"\xff"),
    ],
)
def test_a_damaged_model_is_not_called_present(tmp_path, name, data):
    (tmp_path / name).write_bytes(data)
    with pytest.raises(UpgradeError, match=name):
        upgrade_of(tmp_path)
    assert (tmp_path / name).read_bytes() == data
