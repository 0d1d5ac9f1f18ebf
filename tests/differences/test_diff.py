"""`jausml diff`: what changed, in the words of the models, and whom it breaks."""

import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from click.testing import CliRunner

from jausml.cli import main
from jausml.cli.shared.revisions import check_out
from jausml.language.model import LIBRARY_URI

ROOT = Path(__file__).resolve().parents[2]
CATVEHICLE = (ROOT / "models" / "catvehicle" / "catvehicle.xmi").read_text(encoding="utf-8")
CATVEHICLE = CATVEHICLE.replace("../library/", LIBRARY_URI)
WINCH = (ROOT / "models" / "examples" / "winch" / "service.xmi").read_text(encoding="utf-8")
WINCH = WINCH.replace("../../library/", LIBRARY_URI)
MAP = """
local_pose {
    JAUS mobility.LocalPoseSensor.ReportLocalPose
    ROS nav_msgs.Odometry
    JAUS->ROS (
        X -> pose.pose.position.x
        Y -> pose.pose.position.y : negate
    )
}
"""


INTERFACES = """<?xml version="1.0" encoding="UTF-8"?>
<ros:InterfacePackage xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xmlns:ros="http://www.jausml.org/ros/1.0" name="d_msgs">
  <messages name="Dot">
    <fields xsi:type="ros:PrimitiveField" name="x" type="float64"/>
    <fields xsi:type="ros:PrimitiveField" name="y" type="float64"/>
  </messages>
</ros:InterfacePackage>
"""


def compared(*words, status=0):
    """Runs `jausml diff`, which ends with a status."""
    done = CliRunner().invoke(main, ["diff", *map(str, words)])
    assert done.exit_code == status, done.output
    return done


def written(folder, **texts):
    """Writes models of some texts; returns their files."""
    for name, text in texts.items():
        (folder / f"{name}.xmi").write_text(text, encoding="utf-8")
    return [folder / f"{name}.xmi" for name in texts]


@pytest.fixture
def diff(tmp_path, monkeypatch):
    """Compares two texts of a model; returns the changes."""
    monkeypatch.chdir(tmp_path)

    def run(old, new, suffix=".xmi"):
        files = []
        for name, text in (("old", old), ("new", new)):
            (tmp_path / name).mkdir(exist_ok=True)
            files.append(tmp_path / name / f"model{suffix}")
            files[-1].write_text(text, encoding="utf-8")
        return json.loads(compared("--format", "json", *files).stdout)["changes"]

    return run


def replaced(text, old, new):
    assert old in text
    return text.replace(old, new)


def test_the_same_in_another_layout(diff):
    other = CATVEHICLE.replace('" name=', '"\n      name=').replace(
        "  <components", "\t<components"
    )
    other = replaced(other, "The car: takes", "The vehicle: takes")
    assert diff(CATVEHICLE, other) == []


def test_text_and_xmi_are_compared_as_models():
    xmi = ROOT / "models" / "catvehicle" / "catvehicle.xmi"
    text = ROOT / "models" / "examples" / "catvehicle" / "catvehicle.ros2jaus"
    done = compared("--fail-on", "any", xmi, text)
    assert done.output == "no differences\n"


@pytest.mark.parametrize(
    ("old", "new", "path", "text", "breaks"),
    [
        (
            'provider="vehicle" rate="10.0"',
            'provider="vehicle" rate="25.0"',
            "catvehicle/operator_control_unit/vehicle_pose",
            "rate 10 -> 25 Hz",
            [],
        ),
        (
            '<provides href="http://www.jausml.org/library/jaus/mobility.xmi#VelocityStateSensor"/>',
            "",
            "catvehicle/vehicle",
            "no longer provides VelocityStateSensor 1.0",
            ["peers"],
        ),
        ('address="100.1.1"', 'address="100.1.9"', None, "address 100.1.1 -> 100.1.9", ["peers"]),
        (
            'name="velocity_controller"',
            'name="speed_keeper"',
            "catvehicle/speed_keeper",
            "renamed from velocity_controller",
            ["code"],
        ),
        (
            'topic="dead_reckoning">\n      <type href="http://www.jausml.org/library/ros/nav_msgs.xmi#Odometry"/>\n'
            '      <qos depth="5"/>\n    </publishers>',
            'topic="reckoned">\n      <type href="http://www.jausml.org/library/ros/nav_msgs.xmi#Odometry"/>\n'
            '      <qos depth="5"/>\n    </publishers>',
            "catvehicle/steering_controller/dead_reckoning",
            "topic dead_reckoning -> reckoned",
            ["peers"],
        ),
        (
            '<topics name="pose">\n        <qos reliability="best_effort" depth="5"/>',
            '<topics name="pose">',
            "catvehicle/bridge/pose/pose/qos",
            "removed",
            ["peers"],
        ),
        (
            '<topics name="cruise_speed">\n        <qos depth="1"/>',
            '<topics name="cruise_speed">',
            "catvehicle/bridge/cruise_speed/cruise_speed/qos",
            "removed",
            [],
        ),
        (
            'Float64"/>\n      <toRos xsi:type="bridge:FieldAssignment" target="data" source="Prop',
            'Float32"/>\n      <toRos xsi:type="bridge:FieldAssignment" target="data" source="Prop',
            "catvehicle/bridge/tyre_angle",
            "type Float64 -> Float32",
            ["peers"],
        ),
    ],
)
def test_a_change_of_a_system(diff, old, new, path, text, breaks):
    changes = diff(CATVEHICLE, replaced(CATVEHICLE, old, new))
    found = [change for change in changes if path in (None, change["path"])]
    assert [change["text"].partition(", which")[0] for change in found] == [text]
    assert found[0]["breaks"] == breaks
    assert len(changes) == 1 or path is None or "provides" in text


def test_who_uses_what_is_gone_is_named(diff):
    provided = '<provides href="http://www.jausml.org/library/jaus/mobility.xmi#LocalPoseSensor"/>'
    changes = diff(CATVEHICLE, CATVEHICLE.replace(provided, "", 1))
    assert changes[0]["text"].endswith("1.0, which operator_control_unit and bridge use")


def test_the_way_back_has_no_less(diff):
    other = replaced(CATVEHICLE, 'name="logger"', 'name="recorder"')
    other = replaced(other, 'rate="10.0"', 'rate="12.5"')
    there, back = diff(CATVEHICLE, other), diff(other, CATVEHICLE)
    assert [(change["old"], change["new"]) for change in there] == [
        (change["new"], change["old"]) for change in back
    ]
    assert {change["text"] for change in back} >= {"renamed from recorder", "rate 12.5 -> 10 Hz"}


def test_what_is_less_than_half_the_same_is_another_element(diff):
    begin = CATVEHICLE.index('<nodes name="velocity_controller"')
    end = CATVEHICLE.index("</nodes>", begin)
    subscription = re.search(r'<subscriptions name="odometry".*?</subscriptions>', CATVEHICLE, re.S)
    other = f'<nodes name="logger">{subscription[0]}<dependencies>catvehicle</dependencies>'
    changes = diff(CATVEHICLE, CATVEHICLE[:begin] + other + CATVEHICLE[end:])
    became = {change["path"].rpartition("/")[2]: change["kind"] for change in changes}
    assert became["velocity_controller"] == "removed"
    assert became["logger"] == "added"


def with_hosts(*hosts):
    lines = (f'  <hosts name="{name}" {rest}/>\n' for name, rest in hosts)
    return replaced(CATVEHICLE, "</system:System>", f"{''.join(lines)}</system:System>")


def test_an_id_says_more_than_a_name(diff):
    one, other = 'xmi:id="h1" interface="10.0.0.1"', 'xmi:id="h2" interface="10.0.0.2"'
    changes = diff(with_hosts(("a", one), ("b", other)), with_hosts(("b", one), ("a", other)))
    assert {change["text"] for change in changes} == {"renamed from a", "renamed from b"}


def test_any_number_of_elements_is_found_again_by_all_that_they_say(diff):
    hosts = [(n, f'interface="10.0.0.{n}"') for n in range(1, 62)]
    old, new = (with_hosts(*((f"{name}{n}", rest) for n, rest in hosts)) for name in "ab")
    assert {change["kind"] for change in diff(old, new)} == {"renamed"}


def test_added_is_removed_the_other_way_round(diff):
    host = '  <hosts name="left" interface="10.0.0.1"/>\n</system:System>'
    other = replaced(CATVEHICLE, "</system:System>", host)
    assert [(e["kind"], e["element"], e["path"]) for e in diff(CATVEHICLE, other)] == [
        ("added", "host", "catvehicle/left")
    ]
    assert [change["kind"] for change in diff(other, CATVEHICLE)] == ["removed"]
    other = replaced(
        CATVEHICLE, '<topics name="pose">', '<topics name="place"/><topics name="pose">'
    )
    assert [(e["kind"], e["breaks"]) for e in diff(CATVEHICLE, other)] == [("added", [])]
    assert [(e["kind"], e["breaks"]) for e in diff(other, CATVEHICLE)] == [("removed", ["peers"])]


@pytest.mark.parametrize(
    ("old", "new", "text", "breaks"),
    [
        ('code="0xD101"', 'code="0xD111"', "code 0xD101 -> 0xD111", ["peers"]),
        ('0xD101" isCommand="true"', '0xD101"', "is command true -> false", ["peers"]),
        ('lower="-2.0" upper="2.0"/>', 'lower="-4.0" upper="2.0"/>', "lower -2 -> -4", ["peers"]),
        (
            'upper="20000.0"',
            'upper="20000.0000001"',
            "upper 20000 -> 20000.0000001",
            ["peers"],
        ),
        ('name="RopeLength"', 'name="Length"', "renamed from RopeLength", ["code"]),
        ('name="PAYING_IN" value="3"', 'name="PAYING_IN" value="7"', "value 3 -> 7", ["peers"]),
    ],
)
def test_a_change_of_a_message(diff, old, new, text, breaks):
    other = WINCH.replace(old, new, 1)
    assert other != WINCH
    changes = diff(WINCH, other)
    assert [change["text"] for change in changes] == [text]
    assert changes[0]["breaks"] == breaks


def test_files_of_one_name_that_lie_outside(tmp_path):
    states = [tmp_path / name / "models" / "plant.xmi" for name in ("old", "new")]
    for state in states:
        for folder in ("a", "b", "models"):
            (state.parents[1] / folder).mkdir(parents=True)
        (state.parents[1] / ".project").touch()
        ends = "".join(
            f'<nodes name="{folder}"><publishers name="t" topic="{folder}">'
            f'<type href="../{folder}/msgs.xmi#//@messages.0"/></publishers></nodes>'
            for folder in "ab"
        )
        head = INTERFACES.partition("  <messages")[0]
        head = head.replace("ros:InterfacePackage", "system:System").replace("ros", "system")
        state.write_text(f"{head}{ends}</system:System>", encoding="utf-8")
        for folder in "ab":
            file = state.parents[1] / folder / "msgs.xmi"
            file.write_text(INTERFACES.replace("d_msgs", f"{folder}_msgs"), encoding="utf-8")
    for folder in "ab":
        file = states[1].parents[1] / folder / "msgs.xmi"
        file.write_text(file.read_text().replace('name="x"', 'name="x" units="m"', 1))
    assert compared(*states).output.count("units nothing -> m") == 2


def test_names_that_code_has(diff):
    (renamed,) = diff(INTERFACES, replaced(INTERFACES, '"d_msgs"', '"e_msgs"'))
    assert renamed["breaks"] == ["peers", "code"]
    library = ROOT / "models" / "library" / "jaus" / "environment-sensing.xmi"
    sensing = library.read_text(encoding="utf-8")
    name = re.search(r'<formats name="(\w+)"', sensing)[0]
    (renamed,) = diff(sensing, sensing.replace(name, f'{name[:-1]}Q"', 1))
    assert renamed["breaks"] == ["code"]


def test_a_field_less_and_fields_in_another_order(diff):
    lines = WINCH.splitlines(keepends=True)
    start = next(i for i, line in enumerate(lines) if 'name="RopeLength"' in line)
    length, speed = lines[start : start + 3], lines[start + 3 : start + 6]
    swapped = [*lines[:start], *speed, *length, *lines[start + 6 :]]
    (order,) = diff(WINCH, "".join(swapped))
    assert order["kind"] == "ordered"
    assert order["new"].startswith("Activity, RopeSpeed, RopeLength")
    assert order["breaks"] == ["peers"]
    (removed,) = diff(WINCH, "".join([*lines[:start], *lines[start + 3 :]]))
    assert removed["kind"] == "removed"
    assert removed["path"].endswith("/WinchStateRec/RopeLength")
    assert removed["breaks"] == ["peers", "code"]


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        (
            "Y -> pose.pose.position.y : negate",
            "Y -> pose.pose.position.y",
            "sign of pose.pose.position.y changed: Y -> pose.pose.position.y : negate"
            " => Y -> pose.pose.position.y",
        ),
        (
            "X -> pose.pose.position.x",
            "Z -> pose.pose.position.x",
            "X -> pose.pose.position.x => Z -> pose.pose.position.x",
        ),
        (
            "X -> pose.pose.position.x",
            "X -> pose.pose.position.x { whenAbsent: dropMessage }",
            "X -> pose.pose.position.x: other options",
        ),
        (
            "X -> pose.pose.position.x\n",
            "X -> pose.pose.position.x\n        Z -> pose.pose.position.z\n",
            "added: Z -> pose.pose.position.z",
        ),
    ],
)
def test_a_change_of_a_map(diff, old, new, text):
    changes = diff(MAP, replaced(MAP, old, new), ".ros2jaus")
    assert [change["text"] for change in changes] == [text]
    assert changes[0]["newPlace"]["line"] > 5


@pytest.mark.parametrize(
    ("old", "new"), [("linear(2, 1)", "linear(1, 2)"), ("negate, scale(2)", "scale(2), negate")]
)
def test_conversions_and_their_arguments_in_another_order(diff, old, new):
    before = replaced(MAP, "position.x", f"position.x : {old}")
    (change,) = diff(before, replaced(before, old, new), ".ros2jaus")
    x = "X -> pose.pose.position.x"
    assert change["text"] == f"{x} : {old} => {x} : {new}"


def test_names_of_elements_in_another_order(diff):
    arm = ROOT / "models" / "library" / "mappings" / "joint_positions.ros2jaus"
    text = arm.read_text(encoding="utf-8")
    swapped = text.replace("joint_1, joint_2", "joint_2, joint_1", 1)
    (change,) = diff(text, swapped, ".ros2jaus")
    assert change["text"].endswith(": other options")


@pytest.mark.parametrize(
    ("text", "pattern", "breaks"),
    [
        (INTERFACES, '<fields [^>]* name="[xy]"[^>]*/>', ["peers"]),
        (WINCH, r"<transitions (?:(?!</?transitions).)*?(?:/>|</transitions>)", []),
    ],
)
def test_parts_whose_order_means_something(diff, text, pattern, breaks):
    first, second = list(re.finditer(pattern, text, re.DOTALL))[:2]
    swapped = "".join((second[0], text[first.end() : second.start()], first[0]))
    (change,) = diff(text, text[: first.start()] + swapped + text[second.end() :])
    assert (change["kind"], change["breaks"]) == ("ordered", breaks)


def test_a_reference_to_a_renamed_element_is_no_change(diff):
    other = CATVEHICLE.replace('xmi:id="vehicle" name="vehicle"', 'xmi:id="vehicle" name="car"')
    changes = diff(CATVEHICLE, other)
    assert [change["text"] for change in changes] == ["renamed from vehicle"]


def test_text_for_people_and_exit_status(tmp_path):
    old, new = written(
        tmp_path, old=CATVEHICLE, new=replaced(CATVEHICLE, 'address="100.1.1"', 'address="100.1.9"')
    )
    done = compared(old, new)
    line = "~ component catvehicle/vehicle: address 100.1.1 -> 100.1.9  [breaks peers]"
    assert done.output == f"{line}\n1 change, 1 breaks peers\n"
    compared(old, new, "--fail-on", "breaking", status=1)
    compared("--fail-on", "any", old, old)


def test_a_broken_model_is_told_and_compared_as_far_as_it_can_be_read(tmp_path):
    old, new = written(
        tmp_path, old=CATVEHICLE, new=replaced(CATVEHICLE, "mobility.xmi#Prim", "mobility.xmi#Crim")
    )
    done = compared(old, new)
    assert "new.xmi has errors; what can be read was compared" in done.stderr
    assert "has no element 'CrimitiveDriver'" in done.stderr
    assert "which bridge uses; now provides CrimitiveDriver (not found)" in done.stdout


def test_a_reference_that_leads_nowhere_says_what_it_said(tmp_path):
    """A state without its library, as of another folder, is compared by what it names."""
    text = CATVEHICLE.replace(LIBRARY_URI, "../nowhere/")
    moved = replaced(text, 'address="100.1.1"', 'address="100.1.9"')
    old, new = written(tmp_path, old=CATVEHICLE, new=moved)
    for one, other in ((old, new), (new, old)):
        done = compared(one, other)
        assert done.stdout.endswith("\n1 change, 1 breaks peers\n"), done.stdout
        assert "JML2" in done.stderr
    done = compared("--fail-on", "any", new, new)
    assert done.stdout == "no differences\n"


@pytest.mark.parametrize("is_new", [True, False])
def test_of_a_file_that_is_no_xml_nothing_is_said(tmp_path, is_new):
    good, bad = written(tmp_path, good=CATVEHICLE, bad=CATVEHICLE.replace("</nodes>", "</nods>", 1))
    states = (good, bad) if is_new else (bad, good)
    done = compared(*states)
    assert done.stdout == "nothing was compared\n"
    assert "JML004 not well-formed XML" in done.stderr


@pytest.mark.parametrize("fail_on", ["breaking", "any"])
def test_a_state_that_cannot_be_read_is_no_state_without_changes(tmp_path, fail_on):
    good, bad = written(tmp_path, good=CATVEHICLE, bad=CATVEHICLE[:500])
    words = [good, bad, "--format", "json"]
    done = compared(*words, "--fail-on", fail_on, status=2)
    assert f"{bad} cannot be read" in done.stderr
    assert json.loads(done.stdout) == {"changes": [], "unread": [str(bad)]}
    compared(*words)


@pytest.mark.parametrize(("kind", "is_new"), [("added", True), ("removed", False)])
def test_a_file_that_does_not_exist_needs_no_name(tmp_path, kind, is_new):
    model = tmp_path / "model.xmi"
    model.write_text(CATVEHICLE, encoding="utf-8")
    states = (os.devnull, model) if is_new else (model, os.devnull)
    words = [*states, "--format", "json", "--fail-on", "any"]
    done = compared(*words, status=1)
    assert done.stderr == ""
    (change,) = json.loads(done.stdout)["changes"]
    assert (change["kind"], change["element"]) == (kind, "system")


@pytest.fixture
def repository(tmp_path, monkeypatch):
    """A repository with a model in two files and one commit, and the folder of the models."""
    top = tmp_path / "robot"
    models = top / "models"
    models.mkdir(parents=True)
    (models / "winch.xmi").write_text(WINCH, encoding="utf-8")
    (models / "car.xmi").write_text(CATVEHICLE, encoding="utf-8")
    monkeypatch.chdir(models)
    for words in (["init", "-q"], ["add", "-A"], ["commit", "-q", "-m", "first"]):
        git(*words, cwd=top)
    return models


def git(*words, cwd, text=""):
    """Returns what git says, given a text."""
    identity = ["-c", "user.name=t", "-c", "user.email=t@localhost"]
    command = ["git", *identity, *words]
    done = subprocess.run(
        command, cwd=cwd, input=text, text=True, stdout=subprocess.PIPE, check=True
    )
    return done.stdout.strip()


@pytest.mark.parametrize("old", ["HEAD:./winch.xmi", "HEAD:models/winch.xmi"])
def test_revisions_of_git(repository, old):
    new = WINCH.replace('code="0xD101"', 'code="0xD111"')
    (repository / "winch.xmi").write_text(new, encoding="utf-8")
    done = compared(old, "winch.xmi")
    assert "code 0xD101 -> 0xD111  [breaks peers]" in done.output, done.output


def test_folders_of_models(repository):
    (repository / "winch.xmi").unlink()
    text = (repository / "car.xmi").read_text(encoding="utf-8")
    (repository / "car.xmi").write_text(text.replace('rate="10.0"', 'rate="9.0"', 1), "utf-8")
    done = compared("HEAD:models", ".")
    assert "rate 10 -> 9 Hz" in done.output
    assert "- service set examples: removed" in done.output
    assert done.output.endswith("2 changes\n")


@pytest.mark.parametrize(
    ("old", "words"),
    [
        ("nothing:models", "git knows no revision 'nothing'"),
        ("--all:models", "No such option"),
        ("HEAD:nowhere", "HEAD has no model at nowhere"),
        ("nowhere.xmi", "nowhere.xmi"),
        ("HEAD:{models}/winch.xmi", "the path is not one of the repository"),
        ("HEAD:models/../../robot/models/winch.xmi", "the path is not one of the repository"),
        ("HEAD:./../../winch.xmi", "the path is not one of the repository"),
    ],
)
def test_what_is_not_there(repository, old, words):
    old = old.format(models=repository)
    done = compared(old, "winch.xmi", status=2)
    assert words in done.output


def test_links_of_a_revision_are_no_models(repository):
    (repository / "link.xmi").symlink_to("winch.xmi")
    git("add", "-A", cwd=repository)
    git("commit", "-q", "-m", "link", cwd=repository)
    done = compared("HEAD:models", ".")
    assert done.output == "no differences\n"


def test_a_tree_that_leads_out_writes_nothing_there(repository, tmp_path):
    """git itself makes no such tree, but takes one from elsewhere."""
    models = git("rev-parse", "HEAD:models", cwd=repository)
    names = "".join(f"040000 tree {models}\t{name}\n" for name in ("..", "models"))
    tree = git("mktree", cwd=repository, text=names)
    revision = git("commit-tree", "-m", "hostile", tree, cwd=repository)
    folder = tmp_path / "out" / "of" / "it"
    folder.mkdir(parents=True)
    assert check_out(f"{revision}:models", folder) == folder / "models"
    written = {path.relative_to(folder.parent.parent) for path in folder.parent.rglob("*.xmi")}
    assert written == {Path(f"of/it/models/{name}.xmi") for name in ("car", "winch")}


class TestAs:
    """States that stand for those of a file, as git calls the command."""

    @pytest.fixture(autouse=True)
    def model(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        (tmp_path / "winch.xmi").write_text(WINCH, encoding="utf-8")

    @pytest.mark.parametrize(
        ("states", "sign", "kind"),
        [(("/dev/null", "winch.xmi"), "+", "added"), (("winch.xmi", "/dev/null"), "-", "removed")],
    )
    def test_a_file_that_does_not_exist(self, tmp_path, states, sign, kind):
        words = ["--as", "winch.xmi", "--fail-on", "any", *states]
        done = compared(*words, status=1)
        assert done.output == f"winch.xmi\n{sign} service set examples: {kind}\n1 change\n"
        done = compared(*words, "--format", "json", "-o", "out.json", status=1)
        assert done.output == ""
        (change,) = json.loads((tmp_path / "out.json").read_text(encoding="utf-8"))["changes"]
        assert (change["kind"], change["path"]) == (kind, "examples")

    @pytest.mark.parametrize(
        ("words", "fault"),
        [
            (["--as", "winch.xmi", "/dev/null", "/dev/null"], "only one of the states"),
            (["--as", "winch.xmi", ".", "winch.xmi"], "--as compares states of a file, no folders"),
            (["--new-as", "winch.xmi", "winch.xmi", "winch.xmi"], "--new-as goes with --as"),
        ],
    )
    def test_what_makes_no_sense(self, tmp_path, words, fault):
        (tmp_path / "other.xmi").write_text(WINCH, encoding="utf-8")
        done = compared(*words, status=2)
        assert fault in done.output


@pytest.mark.usefixtures("repository")
def test_code_is_compared_without_a_second_check_out(tmp_path, monkeypatch):
    """A git before the real one counts: listing a tree is what checks a revision out."""
    calls, folder = tmp_path / "calls", tmp_path / "bin"
    folder.mkdir()
    (folder / "git").write_text(
        f'#!/bin/sh\necho "$1" >> {calls}\nexec {shutil.which("git")} "$@"\n'
    )
    (folder / "git").chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}:{os.environ['PATH']}")
    code = tmp_path / "code"
    code.mkdir()
    words = ["--code", code, "HEAD:./car.xmi", "car.xmi"]
    done = compared(*words)
    assert done.output == "no differences\n"
    assert calls.read_text().split().count("ls-tree") == 1


def test_outside_of_a_repository(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path.parent))
    done = compared("HEAD:a.xmi", "b.xmi", status=2)
    assert "git: fatal: not a git repository" in done.output


def test_open_decisions_are_told_by_their_texts(diff):
    one = '    openDecisions: { text: "whose axes are these?" }\n'
    two = '    openDecisions: { text: "is it latched?" }\n'
    old = replaced(MAP, "    JAUS mob", f"{one}{two}    JAUS mob")
    new = replaced(old.replace(one, ""), 'latched?"', 'latched?" blocking: false')
    texts = sorted(change["text"] for change in diff(old, new, ".ros2jaus"))
    assert texts == ["blocking true -> false", "removed: whose axes are these?"]
