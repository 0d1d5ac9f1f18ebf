"""What is told again because nothing has changed is what would be found anew."""

from __future__ import annotations

import itertools
import os
import shutil
import subprocess
import sys
from datetime import date, timedelta
from pathlib import Path

import pytest
from sweeps import sweep

from jausml.cli.shared.options import REPORT_FORMATS
from jausml.language.model import answers, cache
from jausml.language.model.inputs import read_input
from jausml.language.validation import engine

MODELS = Path(__file__).parents[2] / "models"
WARNING = "robot.ros2jaus"
TEXT = """\
system robot {
  bridge front {
    address: 100.1.2
    provides: VelocityStateSensor
    connection speed { map: velocity_state  direction: rosToJaus  topic odom }
  }
}
"""
BROKEN = {
    "syntax": TEXT.replace("address:", "address"),
    "name": TEXT.replace("map: velocity_state", "map: velocity_stat"),
    "empty": "",
    "rule": TEXT.replace("100.1.2", "100.1.255"),
    "no text": "\udcff",
}


@pytest.fixture(autouse=True)
def folders(tmp_path, monkeypatch):
    """The cache, the key and the current folder of this test alone."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    Path(WARNING).write_text(f"import mappings.velocity_state_sensor\n\n{TEXT}", encoding="utf-8")
    return tmp_path


@pytest.fixture
def judged(monkeypatch):
    """A list with an item for each time that models were judged."""
    seen = []
    check = engine.check_project

    def noted(*arguments, **options):
        seen.append(arguments)
        return check(*arguments, **options)

    monkeypatch.setattr(engine, "check_project", noted)
    return seen


@pytest.fixture
def asked(jausml, judged):
    """Asks for something; returns what was told, and whether it was found out for that."""

    def ask(*arguments):
        judged.clear()
        result = jausml(*arguments)
        return (result.exit_code, result.stdout_bytes, result.stderr_bytes), bool(judged)

    return ask


def told_twice(asked, *arguments):
    """Asks three times, the third time anew; returns whether the second needed no look."""
    first, was_new = asked(*arguments)
    second, is_new = asked(*arguments)
    anew, _ = asked(*arguments, "--no-cache")
    assert first == second == anew
    return was_new and not is_new


@pytest.mark.parametrize("output_format", sweep(REPORT_FORMATS, every=5))
def test_findings_of_examples_are_told_again_in_each_format(output_format, asked):
    assert told_twice(asked, "validate", MODELS / "examples", "--format", output_format)


@pytest.mark.parametrize(
    ("text", "output_format"), sweep(itertools.product(BROKEN, REPORT_FORMATS), every=12)
)
def test_faults_are_told_again_in_each_format(text, output_format, asked):
    Path("bad.ros2jaus").write_bytes(BROKEN[text].encode("utf-8", "surrogateescape"))
    Path("bad.xmi").write_text("<a><b></a>", encoding="utf-8")

    assert told_twice(asked, "validate", ".", "--strict", "--format", output_format)


def test_the_report_is_written_again_where_it_is_asked_for(asked):
    assert told_twice(asked, "validate", WARNING, "--output", "report.txt")
    expected = Path("report.txt").read_bytes()
    Path("report.txt").unlink()
    assert not asked("validate", WARNING, "--output", "report.txt")[1]
    assert Path("report.txt").read_bytes() == expected


def write(path, text=""):
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    Path(path).write_text(text, encoding="utf-8")


LOST = """\
<?xml version="1.0" encoding="UTF-8"?>
<system:System xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xmlns:system="http://www.jausml.org/system/1.0" xmlns:jaus="http://www.jausml.org/jaus/1.0"
    name="s">
  <components xsi:type="jaus:Component" name="c" subsystemId="1" nodeId="1" componentId="2">
    <provides href="{href}"/>
  </components>
</system:System>
"""
SERVICE = MODELS / "library" / "jaus" / "core-1.1.xmi"
CHANGES = {
    "the model itself": lambda: write(WARNING, f"{Path(WARNING).read_text('utf-8')}\n"),
    "a new model in the folder": lambda: write("sub/other.ros2jaus", TEXT),
    "a model that goes": lambda: Path("second.ros2jaus").unlink(),
    "a lost file that comes": lambda: shutil.copy(SERVICE, "gone.xmi"),
    "a checkout that changes the root": lambda: Path(".git").mkdir(),
    "a project that changes the root": lambda: write(".project", "<projectDescription/>"),
    "a copy of the library": lambda: shutil.copy(SERVICE, "lib/jaus/core-1.1.xmi"),
    "a link that leads elsewhere": lambda: (
        Path("link.xmi").unlink(),
        Path("link.xmi").symlink_to("second.xmi"),
    ),
    "a model that nobody may read": lambda: (
        Path("second.ros2jaus").unlink(),
        Path("second.ros2jaus").mkdir(),
    ),
}


@pytest.mark.parametrize("change", sweep(CHANGES, every=6))
def test_what_changes_on_the_disk_is_looked_at_anew(change, asked):
    write("second.ros2jaus", TEXT.replace("robot", "second").replace("100.1.2", "100.1.3"))
    write("lost.xmi", LOST.format(href="gone.xmi#//@serviceSets.0/@services.0"))
    write("out.xmi", LOST.format(href="../up.xmi#//@serviceSets.0/@services.0"))
    write("first.xmi", LOST.format(href="http://www.jausml.org/library/jaus/core-1.1.xmi#/"))
    write("second.xmi", LOST.format(href="gone.xmi#/"))
    Path("link.xmi").symlink_to("first.xmi")
    write("lib/jaus/core-1.1.xmi", SERVICE.read_text("utf-8").replace("Transport", "Other", 1))
    assert told_twice(asked, "validate", ".")

    CHANGES[change]()

    expected, is_new = asked("validate", ".")
    assert is_new
    assert asked("validate", ".", "--no-cache")[0] == expected
    assert told_twice(asked, "validate", ".") is False
    assert asked("validate", ".") == (expected, False)


def test_a_file_that_is_looked_for_outside_of_projects(asked):
    """References to Eclipse projects beside that of the model."""
    write("robot/.project", "<projectDescription><name>robot</name></projectDescription>")
    write("robot/robot.xmi", LOST.format(href="platform:/resource/shared/s.xmi#/"))
    first, _ = asked("validate", "robot/robot.xmi")
    write("shared/.project", "<projectDescription><name>shared</name></projectDescription>")
    second, is_new = asked("validate", "robot/robot.xmi")
    assert is_new
    shutil.copy(SERVICE, "shared/s.xmi")
    third, is_new = asked("validate", "robot/robot.xmi")
    assert is_new
    write("shared/.project", "<projectDescription><name>others</name></projectDescription>")
    assert asked("validate", "robot/robot.xmi") == (first, True)
    assert len({first, second, third}) == 3


def test_the_day_counts(asked, monkeypatch):
    day = date.today()
    told = [asked("validate", WARNING)]

    class Later(date):
        @classmethod
        def today(cls):
            return day + timedelta(1)

    monkeypatch.setattr(answers, "date", Later)
    told += [asked("validate", WARNING), asked("validate", WARNING)]
    assert [is_new for _, is_new in told] == [True, True, False]


def test_an_installation_of_ros_counts(asked, monkeypatch, folders):
    """That of another variable, and of other contents; what is not there is looked for too."""
    write(
        WARNING,
        "speed {\n  JAUS ReportVelocityState\n  ROS nav_msgs/Odometry\n"
        "  JAUS->ROS ( Velocity_X -> twist.twist.linear.x )\n}\n",
    )
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(folders / "ros"))
    definition = folders / "ros" / "share" / "nav_msgs" / "msg" / "Odometry.msg"

    def is_new():
        return asked("validate", WARNING)[1]

    assert (is_new(), is_new()) == (True, False)
    write(definition, "float64 nothing\n")
    assert (is_new(), is_new()) == (True, False)
    write(definition, "float64 anything\n")
    assert (is_new(), is_new()) == (True, False)
    definition.unlink()
    assert (is_new(), is_new()) == (True, False)
    monkeypatch.setenv("AMENT_PREFIX_PATH", "")
    assert (is_new(), is_new()) == (True, False)


def test_options_and_the_folder_count(asked, monkeypatch):
    def is_new(*options):
        return asked("validate", WARNING, *options)[1]

    for options in (
        (),
        ("--format", "json"),
        ("--format", "sarif", "--help-uri", "https://example.org"),
        ("--allow-outside",),
        ("--project-root", ".."),
        ("--project", "a=."),
    ):
        assert (is_new(*options), is_new(*options)) == (True, False), options
    # These change nothing of what is found.
    assert not is_new("--strict")
    assert not is_new("--quiet")
    monkeypatch.setenv("JAUSML_MAX_FILE_MIB", "1")
    assert is_new()
    shutil.copytree(".", "../there")
    monkeypatch.chdir("../there")
    assert is_new()


def test_a_baseline_counts(asked, jausml):
    write(WARNING, TEXT.replace("map: velocity_state", "map: unknown"))
    known = ("validate", WARNING, "--baseline", "known.json")
    assert jausml(*known, "--write-baseline").exit_code == 0
    assert told_twice(asked, *known)
    assert asked(*known)[0][0] == 0
    Path("known.json").write_text('{"version": 1, "findings": []}', encoding="utf-8")
    assert asked(*known)[1]
    assert asked(*known, "--write-baseline")[1]


def test_the_program_counts(asked, monkeypatch):
    monkeypatch.setattr(answers, "tool", cache.tool.__wrapped__)  # each run is a process
    assert (asked("validate", WARNING)[1], asked("validate", WARNING)[1]) == (True, False)
    rule, read = Path(engine.__file__), Path.read_bytes
    monkeypatch.setattr(Path, "read_bytes", lambda path: read(path) + b"\n" * (path == rule))
    assert (asked("validate", WARNING)[1], asked("validate", WARNING)[1]) == (True, False)


def test_what_changes_while_it_is_looked_at_is_not_kept(asked, monkeypatch, jausml):
    check = engine.check_project

    def changing(*arguments, **options):
        report = check(*arguments, **options)
        write(WARNING, f"// {Path(WARNING).read_text('utf-8')}")
        read_input(WARNING)
        return report

    with monkeypatch.context() as patched:
        patched.setattr(engine, "check_project", changing)
        jausml("validate", WARNING)
    assert asked("validate", WARNING)[1]
    # The digest is that of the bytes that were judged, not of what stands there afterwards.
    with monkeypatch.context() as patched:
        patched.setattr(
            engine,
            "check_project",
            lambda *arguments, **options: (check(*arguments, **options), write(WARNING, TEXT))[0],
        )
        jausml("validate", ".", "--strict")
    assert asked("validate", ".")[1]


def the_file(folders):
    (found,) = (folders / "cache" / "jausml").glob("answer-*")
    return found


@pytest.mark.skipif(os.name != "posix", reason="permissions are those of POSIX")
def test_what_others_may_have_written_is_not_believed(asked, folders):
    asked("validate", WARNING)
    file = the_file(folders)
    for path, mode in ((file, 0o620), (file, 0o602), (file.parent, 0o770), (file.parent, 0o707)):
        before = path.stat().st_mode
        path.chmod(mode)
        assert cache.kept(file.name, "") is None
        assert asked("validate", WARNING)[1], (path, oct(mode))
        path.chmod(before)
        assert not asked("validate", WARNING)[1]


def test_what_is_no_such_answer_is_not_believed(asked, folders):
    asked("validate", WARNING)
    file = the_file(folders)
    data = file.read_bytes()
    for wrong in (b"", data[:40], data[:-1] + bytes([data[-1] ^ 1]), bytes(40), data + b"\0"):
        file.write_bytes(wrong)
        assert asked("validate", WARNING)[1]
    # That of another question, in its place.
    asked("validate", ".", "--allow-outside")
    other = next(each for each in file.parent.glob("answer-*") if each != file)
    shutil.copy(other, file)
    assert asked("validate", WARNING)[1]


def test_too_large_an_answer_is_not_believed(asked, folders, monkeypatch):
    asked("validate", WARNING)
    monkeypatch.setattr(cache, "read_unnoted", lambda path: read_input(path)[: 1 << 20])
    file = the_file(folders)
    with file.open("ab") as stream:
        stream.truncate(65 << 20)
    assert asked("validate", WARNING)[1]


@pytest.mark.slow
def test_two_at_once_leave_one_whole_answer(folders):
    command = [sys.executable, "-m", "jausml", "validate", WARNING]
    both = [subprocess.Popen(command, stderr=subprocess.PIPE) for _ in range(2)]
    told = {each.communicate()[1] for each in both}
    again = subprocess.run(command, capture_output=True, check=True)
    assert told == {again.stderr}
    assert [each.name for each in the_file(folders).parent.iterdir()] == [the_file(folders).name]


def test_an_answer_needs_nothing_that_judges():
    script = (
        "import sys; from jausml.cli import main;"
        "main(['validate', sys.argv[1]], standalone_mode=False);"
        "print(*(each for each in ('pyecore', 'lxml', 'lark') if each in sys.modules))"
    )
    command = [sys.executable, "-c", script, WARNING]
    loaded = [
        subprocess.run(command, capture_output=True, check=True, text=True).stdout.split()
        for _ in range(2)
    ]
    assert loaded == [["pyecore", "lxml", "lark"], []]


# ------------------------------------------------------------------------------------ generate


OUT = Path("ws")
GENERATE = ("generate", WARNING, "-o", str(OUT))


def tree(folder):
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def generated_file():
    return next(each for each in sorted(OUT.rglob("*.py")) if "jausml_runtime" not in each.parts)


def test_what_a_second_run_would_tell_is_told(asked):
    (status, out, _), is_new = asked(*GENERATE)
    before = tree(OUT)
    assert (status, is_new) == (0, True)
    assert b"create" in out
    again, is_new = asked(*GENERATE)
    assert not is_new
    assert b"create" not in again[1]
    assert asked(*GENERATE, "--no-cache") == (again, True)
    assert asked(*GENERATE) == (again, False)
    assert tree(OUT) == before


def test_warnings_are_told_again(asked):
    own = "speed {\n  JAUS ReportVelocityState\n  ROS nav_msgs/Odometry\n"
    own += "  JAUS->ROS ( Velocity_X -> twist.twist.linear.x )\n}\n"
    other = TEXT.replace("velocity_state", "speed").replace("rosToJaus", "jausToRos")
    other = other.replace("provides:", "uses:").replace("topic odom", "topic odom  peers: sensor")
    sensor = "component sensor { address: 100.1.3  provides: VelocityStateSensor }\n}\n"
    write(WARNING, own + other.rstrip().removesuffix("}") + sensor)
    first, _ = asked(*GENERATE)
    again, is_new = asked(*GENERATE)
    assert not is_new
    assert b": warning: JML460" in first[2]
    assert b": warning: JML460" in again[2]
    assert again == asked(*GENERATE, "--no-cache")[0]


CHANGED = {
    "a generated file that is edited": lambda: generated_file().write_text("# by hand\n"),
    "a generated file that is gone": lambda: generated_file().unlink(),
    "a link instead of a file": lambda: (
        generated_file().rename("moved.py"),
        generated_file().parent.joinpath("link.py").symlink_to("moved.py"),
    ),
    "a file of a user": lambda: write(generated_file().parent / "own.py", "import wrong\n"),
    "a file of a user elsewhere": lambda: write(OUT / "mine" / "own.py", "from json import no\n"),
    "the manifest": (OUT / ".jausml" / "manifest.json").unlink,
    "the folder": lambda: shutil.rmtree(OUT),
    "the model": lambda: write(WARNING, TEXT.replace("front", "rear")),
}


@pytest.mark.parametrize("change", sweep(CHANGED, every=6))
def test_what_changes_in_a_workspace_is_generated_anew(change, asked):
    asked(*GENERATE)
    assert not asked(*GENERATE)[1]
    CHANGED[change]()
    assert asked(*GENERATE)[1]


@pytest.mark.slow
def test_what_is_not_the_usual_run_is_never_an_answer(asked):
    asked(*GENERATE)
    for options in (
        ("--check",),
        ("--check", "--format", "json"),
        ("--diff",),
        ("--dry-run",),
        ("--fix",),
        ("--force",),
        ("--strict",),
        ("--target", "messages"),
        ("--frequency", "5"),
    ):
        assert asked(*GENERATE, *options)[1], options
    assert asked("--verbose", *GENERATE)[1]
    # These left the workspace in another state.
    asked(*GENERATE)
    assert not asked(*GENERATE)[1]


def test_with_targets_of_others_nothing_is_known(asked, monkeypatch):
    import importlib.metadata as metadata

    found = metadata.entry_points
    other = metadata.EntryPoint("other", "elsewhere.target:TARGET", "jausml.targets")
    asked(*GENERATE)
    assert not asked(*GENERATE)[1]
    monkeypatch.setattr(metadata, "entry_points", lambda **which: [*found(**which), other])
    from jausml.generation import target

    assert target.entry_points is not metadata.entry_points
    assert asked(*GENERATE)[1]
