"""`jausml merge` and `jausml diff` as drivers of a real git, configured as the how-to says."""

import os
import re
import shutil
import sys
from pathlib import Path

import pytest
import warm
from merging_support import MESSAGE, NODE, PACKAGE, PLANT
from scripts import ran

from jausml.language.model import LIBRARY_URI, read_models

ROOT = Path(__file__).resolve().parents[2]
MINIMAL = (ROOT / "models" / "minimal" / "minimal.xmi").read_text(encoding="utf-8")
MINIMAL = MINIMAL.replace("../library/", LIBRARY_URI)
HOW_TO = (ROOT / "docs" / "how-to" / "ci.md").read_text(encoding="utf-8")
HOSTS = '  <hosts name="{}" interface="10.0.0.{}"/>\n</system:System>'
RATE = 'rate="10.0"'


class Repository:
    """A repository whose git runs the programs of this installation."""

    def __init__(self, folder):
        self.folder = folder
        programs = (str(warm.programs()), str(Path(sys.executable).parent), os.environ["PATH"])
        self.environment = {
            **os.environ,
            "PATH": os.pathsep.join(programs),
            "HOME": str(folder),
            "GIT_CONFIG_NOSYSTEM": "1",
            **{
                f"GIT_{who}_{what}": "x"
                for who in ("AUTHOR", "COMMITTER")
                for what in ("NAME", "EMAIL")
            },
        }

    def run(self, *command, status=0):
        done = ran(command, cwd=self.folder, env=self.environment, timeout=120)
        assert done.returncode == status, done.stdout + done.stderr
        return done.stdout + done.stderr

    def git(self, *arguments, status=0):
        return self.run("git", *arguments, status=status)

    def commit(self, branch, text):
        """Commits a text of the model on a branch of its own."""
        self.git("checkout", "-q", "-b", branch, "main")
        self.model.write_text(text, encoding="utf-8")
        self.git("commit", "-q", "-a", "-m", branch)

    @property
    def model(self):
        return self.folder / "models" / "robot.xmi"


@pytest.fixture
def repository(tmp_path):
    """A repository with a model, and with the drivers that the how-to tells."""
    made = Repository(tmp_path)
    made.git("init", "-q", "-b", "main")
    attributes, commands = (
        re.search(rf"^```{kind}\n(.*?)^```$", HOW_TO, re.MULTILINE | re.DOTALL)[1]
        for kind in ("gitattributes", "bash")
    )
    (tmp_path / ".gitattributes").write_text(attributes)
    made.run("bash", "-eu", "-c", commands)
    made.model.parent.mkdir()
    made.model.write_text(MINIMAL, encoding="utf-8")
    made.git("add", ".")
    made.git("commit", "-q", "-m", "base")
    return made


def test_what_lines_cannot_merge_elements_can(repository):
    """Both sides add at the same place, and change the same line."""
    end = "</system:System>"
    ours = MINIMAL.replace(end, HOSTS.format("left", 1)).replace(RATE, 'rate="25.0"')
    theirs = MINIMAL.replace(end, HOSTS.format("right", 2)).replace("Ten times", "Many times")
    repository.commit("ours", ours)
    repository.commit("theirs", theirs)
    repository.git("checkout", "-q", "ours")
    repository.git("merge", "-q", "--no-edit", "theirs")
    text = repository.model.read_text(encoding="utf-8")
    for part in ('name="left"', 'name="right"', 'rate="25.0"', "Many times a second."):
        assert part in text
    assert "no problems" in repository.run("jausml", "validate", "models")
    told = repository.git("log", "-1", "-p", "--ext-diff", "--format=", "theirs")
    assert "+ host minimal/right: added" in told


def test_a_conflict_is_told_with_its_place_and_leaves_a_model(repository):
    ours = MINIMAL.replace(RATE, 'rate="25.0"')
    repository.commit("ours", ours)
    repository.commit("theirs", MINIMAL.replace(RATE, 'rate="50.0"'))
    repository.git("checkout", "-q", "ours")
    told = repository.git("merge", "--no-edit", "theirs", status=1)
    line = next(n for n, text_line in enumerate(ours.splitlines(), 1) if "rate=" in text_line)
    assert f"models/robot.xmi:{line}:" in told
    assert "error: JML811 rate of connection 'velocity' was 10: ours is 25, theirs 50" in told
    assert "UU models/robot.xmi" in repository.git("status", "--short")
    assert repository.model.read_text(encoding="utf-8") == ours
    diff = repository.git("diff", "--ext-diff", "main", "ours")
    assert "~ connection minimal/sensor_bridge/velocity: rate 10 -> 25 Hz" in diff


@pytest.mark.slow
def test_text_is_merged_by_elements_too(repository):
    text = repository.folder / "models" / "robot.ros2jaus"
    repository.run("jausml", "convert", str(repository.model), str(text))
    base = text.read_text(encoding="utf-8")
    repository.git("rm", "-q", str(repository.model))
    repository.git("add", ".")
    repository.git("commit", "-q", "-m", "text")
    for branch, new in (("ours", "rate: 25"), ("theirs", "rate: 10  decimation: 2")):
        repository.git("checkout", "-q", "-b", branch, "main")
        assert "rate: 10" in base
        text.write_text(base.replace("rate: 10", new), encoding="utf-8")
        repository.git("commit", "-q", "-a", "-m", branch)
    repository.git("checkout", "-q", "ours")
    repository.git("merge", "-q", "--no-edit", "theirs")
    merged = text.read_text(encoding="utf-8")
    assert "rate: 25" in merged
    assert "decimation: 2" in merged


@pytest.mark.slow
def test_a_text_that_is_no_model_is_merged_as_lines_and_its_conflict_is_one_error(repository):
    text = repository.folder / "models" / "robot.ros2jaus"
    text.write_text("component a { address: 1.1.1 }\n", encoding="utf-8")
    repository.git("add", ".")
    repository.git("commit", "-q", "-m", "text")
    for branch in ("ours", "theirs"):
        repository.git("checkout", "-q", "-b", branch, "main")
        text.write_text(f"component {branch} {{ address }}\n", encoding="utf-8")
        repository.git("commit", "-q", "-a", "-m", branch)
    repository.git("checkout", "-q", "ours")
    assert "JML815" in repository.git("merge", "--no-edit", "theirs", status=1)
    told = repository.run("jausml", "validate", str(text), status=1)
    assert "robot.ros2jaus:1:1: error: JML009 an unmerged conflict stands in lines 1-5" in told
    assert told.endswith("1 error in 1 file\n")


def test_a_file_that_is_no_model_is_merged_as_lines(repository):
    repository.commit("ours", MINIMAL.replace("<system:", "<sistem:"))
    repository.commit("theirs", MINIMAL.replace(RATE, 'rate="50.0"'))
    repository.git("checkout", "-q", "ours")
    told = repository.git("merge", "--no-edit", "theirs", status=1)
    assert "models/robot.xmi:1:1: error: JML815 merged as lines: our side: line 2: JML" in told
    text = repository.model.read_text(encoding="utf-8")
    assert "<sistem:" in text
    assert 'rate="50.0"' in text


def test_a_file_that_comes_is_told_as_such(repository):
    (repository.folder / "models" / "other.xmi").write_text(MINIMAL, encoding="utf-8")
    repository.git("add", ".")
    assert "+ system minimal: added" in repository.git("diff", "--cached", "--ext-diff")


@pytest.mark.slow
def test_what_theirs_refers_to_in_a_file_of_its_own_comes_with_it(repository):
    """git merges file by file, and the maps that `jausml new bridge` writes are not there yet."""
    repository.git("checkout", "-q", "-b", "theirs", "main")
    model = str(repository.model)
    for specification in (
        "scan:sensor_msgs/LaserScan:laser_scan",
        "odom:nav_msgs/Odometry:local_pose",
    ):
        repository.run(
            "jausml", "new", "bridge", specification.partition(":")[0], specification, "-m", model
        )
    repository.git("add", ".")
    repository.git("commit", "-q", "-m", "theirs")
    repository.git("checkout", "-q", "-b", "ours", "main")
    repository.run(
        "jausml", "new", "bridge", "fix", "fix:sensor_msgs/NavSatFix", "--yes", "-m", model
    )
    repository.git("add", ".")
    repository.git("commit", "-q", "-m", "ours")
    repository.git("merge", "-q", "--no-edit", "theirs")
    text = repository.model.read_text(encoding="utf-8")
    for reference in ("range_sensor.xmi#laser_scan", "local_pose_sensor.xmi#local_pose"):
        assert f'<map href="mappings/{reference}"/>' in text
    told = repository.run("jausml", "validate", "models", status=1)
    assert set(re.findall(r"error: (JML\d+)", told)) == {"JML302"}, told  # both took a free address


@pytest.mark.slow
def test_a_model_that_moved_is_merged_with_what_changed_in_its_former_place(repository):
    deeper = MINIMAL.replace(LIBRARY_URI, "../../library/")
    repository.model.write_text(MINIMAL.replace(LIBRARY_URI, "../library/"), encoding="utf-8")
    shutil.copytree(ROOT / "models" / "library", repository.folder / "library")
    repository.git("add", ".")
    repository.git("commit", "-q", "-m", "with a library")
    repository.commit("changed", repository.model.read_text("utf-8").replace(RATE, 'rate="25.0"'))
    repository.git("checkout", "-q", "-b", "moved", "main")
    (repository.folder / "models" / "deeper").mkdir()
    repository.git("mv", "models/robot.xmi", "models/deeper/robot.xmi")
    moved = repository.folder / "models" / "deeper" / "robot.xmi"
    moved.write_text(deeper, encoding="utf-8")
    repository.git("commit", "-q", "-a", "-m", "moved")
    repository.git("merge", "-q", "--no-edit", "changed")
    assert moved.read_text("utf-8") == deeper.replace(RATE, 'rate="25.0"')
    repository.git("checkout", "-q", "changed")
    repository.git("merge", "-q", "--no-edit", "moved~1")
    assert "no problems" in repository.run("jausml", "validate", "models")


@pytest.mark.slow
def test_references_by_position_follow_what_both_sides_did_to_another_file(repository):
    """git tells its drivers the other commit, so that the other files of their side can be read."""
    alarm, depth, last = (MESSAGE.format(name) for name in ("Alarm", "Depth", "Last"))
    package, plant = (repository.folder / "models" / file for file in ("d_msgs.xmi", "plant.xmi"))

    def commit(branch, messages, *nodes):
        if branch != "main":
            repository.git("checkout", "-q", "-b", branch, "main")
        package.write_text(PACKAGE.format(messages))
        plant.write_text(PLANT.format("".join(NODE.format(*node) for node in nodes)))
        repository.git("add", ".")
        repository.git("commit", "-q", "-m", branch)

    commit("main", alarm, ("a", "1.0", 0))
    commit("adds", depth + alarm, ("a", "1.0", 1), ("b", "1.0", 0))
    commit("alters", alarm + last, ("a", "5.0", 0), ("c", "2.0", 1))
    repository.git("merge", "-q", "--no-edit", "adds")
    model = read_models([plant]).model
    used = {node.name: node.publishers[0].type.name for node in model.root.nodes}
    assert used == {"a": "Alarm", "b": "Depth", "c": "Last"}
    assert model.root.nodes[0].frequency == 5


@pytest.mark.slow
def test_the_files_of_a_diff_are_named(repository):
    documented = MINIMAL.replace("Ten times", "Often")
    repository.commit("documented", documented)
    same = "no differences in meaning; --no-ext-diff shows layout, comments, ids and documentation"
    assert repository.git("diff", "main") == f"models/robot.xmi\n{same}\n"
    (repository.folder / "models" / "deeper").mkdir()
    repository.git("mv", "models/robot.xmi", "models/deeper/rover.xmi")
    told = repository.git("diff", "-M", "main")
    assert told == f"models/robot.xmi -> models/deeper/rover.xmi\n{same}\n"
