"""`jausml init`: a project that validates, generates and opens in Eclipse as it is."""

import hashlib
import re
import shutil
import subprocess
import sys
from pathlib import Path

import emf_check
import pytest
import yaml
from lxml import etree
from sweeps import sweep

from jausml.authoring.editing.project import Project
from jausml.authoring.projects.creating import renewed
from jausml.language.metamodel.classes import jaus
from jausml.language.model import read_models
from jausml.language.text.notation import NOTATIONS


@pytest.fixture
def project(tmp_path, jausml):
    """Makes a project with options; returns its folder."""

    def make(*options, name="rover"):
        folder = tmp_path / name
        jausml("init", folder, *options)
        return folder

    return make


@pytest.mark.parametrize("notation", ["xmi", "text"])
@pytest.mark.parametrize(
    ("origin", "name"), [("example", "rover"), ("example", "sensor"), ("empty", "rover")]
)
def test_it_validates_also_under_the_name_of_an_element(project, notation, origin, name, jausml):
    folder = project("--notation", notation, "--from", origin, name=name)
    done = jausml("validate", folder / "models", "--strict")
    assert done.output == "no problems in 1 file\n"


@pytest.mark.parametrize("notation", sweep(["text", "xmi"], every=2, rest=0))
def test_it_generates_and_its_ci_is_content(project, notation, monkeypatch, jausml):
    folder = project("--notation", notation)
    monkeypatch.chdir(folder)
    model = f"models/rover.{'xmi' if notation == 'xmi' else 'ros2jaus'}"
    jausml("generate", model, "-o", "src")
    jobs = yaml.safe_load(Path(".github/workflows/models.yml").read_text(encoding="utf-8"))["jobs"]
    commands = [step.get("run", "") for step in jobs["check"]["steps"]]
    own = [command.split()[1:] for command in commands if command.startswith("jausml ")]
    assert [command_line[0] for command_line in own] == ["validate", "validate", "generate"]
    assert any(command.startswith("pip install wheels/jausml-") for command in commands)
    for command_line in own:
        jausml(*command_line)
    hooks = yaml.safe_load(Path(".pre-commit-config.yaml").read_text(encoding="utf-8"))
    for hook in hooks["repos"][0]["hooks"]:
        if re.search(hook["files"], model):
            jausml(*hook["entry"].split()[1:], model)


@pytest.mark.slow
def test_the_commands_that_it_names_work(project):
    folder = project()
    readme = (folder / "README.md").read_text(encoding="utf-8")
    commands = [line.split() for line in readme.splitlines() if line.startswith("    jausml ")]
    assert [command_line[1] for command_line in commands] == ["validate", "generate", "run"]
    for command_line in commands[:2]:
        command = [sys.executable, "-m", "jausml", *command_line[1:]]
        subprocess.run(command, cwd=folder, check=True, capture_output=True)


def test_copies_of_the_library_are_the_library_until_they_are_edited(project):
    folder = project()
    path = folder / "models" / "rover.xmi"
    model = read_models([path]).model
    (service, *_) = (
        service for service in model.instances(jaus.Service) if service.name == "Management"
    )
    assert model.is_library(service)
    own = [document.path for document in model.documents if not document.is_library]
    assert own == [path.resolve()]
    assert [file.path for file in Project(folder).files] == ["models/rover.xmi"]
    copy = folder / "library" / "jaus" / "mobility.xmi"
    copy.write_text(copy.read_text("utf-8").replace('code="0x', 'code="0X', 1), "utf-8")
    documents = read_models([path]).model.documents
    assert copy.resolve() in {document.path for document in documents if not document.is_library}


@pytest.mark.needs("emf")
def test_eclipse_opens_it_without_a_word(project):
    folder = project()
    done = emf_check.ask("models/rover.xmi", cwd=folder)
    assert (done.returncode, done.stdout) == (0, "")
    assert etree.parse(folder / ".project").findtext("name") == "rover"


def test_again_is_nothing_and_own_files_stay(project, jausml):
    folder = project()
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    done = jausml("init", folder)
    assert done.output.splitlines()[0] == f"0 files in {folder}; next:"
    (folder / "README.md").write_text("mine", encoding="utf-8")
    (folder / ".gitignore").unlink()
    done = jausml("init", folder, status=2)
    assert "README.md is there already; nothing was written" in done.output
    assert not (folder / ".gitignore").exists()
    for key in before.keys() - {folder / "README.md", folder / ".gitignore"}:
        assert key.read_bytes() == before[key]


@pytest.mark.parametrize(
    ("folder", "options", "name"),
    [("My Rover-2", (), "my_rover_2"), ("---", ("--name", "rover"), "rover")],
)
def test_the_name(project, folder, options, name):
    made = project(*options, name=folder)
    assert (made / "models" / f"{name}.xmi").is_file()


def test_a_keyword_of_the_notation_is_a_name(project):
    path = project("--from", "fleet", name="table") / "models" / "table.ros2jaus"
    read = read_models([path], notations=NOTATIONS)
    assert not read.diagnostics
    assert read.model.documents[0].roots[0].name == "table"


@pytest.mark.parametrize(
    ("folder", "options", "words"),
    [
        ("42", (), "makes no name of a system"),
        ("rover", ("--name", "../rover"), "is no name of a system"),
        ("rover", ("--name", 'a"b'), "is no name of a system"),
        ("rover", ("--name", "übergroß"), "'übergroß' is no name of a system"),
        ("rover/file/below", (), "cannot be written"),
    ],
)
def test_what_cannot_be_made(tmp_path, folder, options, words, jausml):
    (tmp_path / "rover").mkdir()
    (tmp_path / "rover" / "file").touch()
    done = jausml("init", tmp_path / folder, *options, status=2)
    assert words in done.output


def test_what_comes_next_can_be_pasted(tmp_path, monkeypatch, jausml):
    monkeypatch.chdir(tmp_path)
    assert "\n  cd 'my rover'\n" in jausml("init", "my rover").output
    assert "\n  cd ./-x\n" in jausml("init", "--name", "x", "--", "-x").output
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    assert "cd " not in jausml("init", ".").output


@pytest.mark.parametrize("arguments", [("con",), ("there", "--name", "con")])
def test_a_device_of_windows_is_no_name(tmp_path, monkeypatch, arguments, jausml):
    monkeypatch.chdir(tmp_path)
    done = jausml("init", *arguments, status=2)
    assert "'con' is a device name on Windows" in done.output
    assert list(tmp_path.iterdir()) == []


def test_copies_are_renewed_unless_somebody_changed_them(project, jausml):
    folder = project()
    assert "0 copies" in jausml("init", folder, "--copies").output
    (folder / "metamodels" / "ros.ecore").unlink()
    old, mine = folder / "library" / "ros" / "std_msgs.xmi", folder / "metamodels" / "jaus.ecore"
    present = old.read_bytes()
    _as_of_an_older_tool(old, folder / "library" / "SHA256SUMS")
    mine.write_bytes(mine.read_bytes() + b"<!-- mine -->")
    done = jausml("init", folder, "--copies")
    assert "metamodels/jaus.ecore stays: it was changed here" in done.output
    assert (folder / "metamodels" / "ros.ecore").is_file()
    assert old.read_bytes() == present
    assert mine.read_bytes().endswith(b"<!-- mine -->")
    assert "0 copies" in jausml("init", folder, "--copies").output


def test_a_copy_that_somebody_changed_keeps_no_other_from_being_renewed_again(tmp_path):
    for text in (b"1", b"2", b"3"):
        wanted, kept = renewed(tmp_path, {"mine": b"ours", "other": text})
        for path, data in wanted.items():
            (tmp_path / path).write_bytes(data)
        assert (tmp_path / "other").read_bytes() == text
        assert kept == ([] if text == b"1" else ["mine"])
        (tmp_path / "mine").write_bytes(b"mine")


def _as_of_an_older_tool(copy, sums):
    """Changes a copy together with what is said of it, as an older tool would have made both."""
    before = hashlib.sha256(copy.read_bytes()).hexdigest()
    copy.write_bytes(copy.read_bytes().replace(b"</", b"\n</", 1))
    after = hashlib.sha256(copy.read_bytes()).hexdigest()
    sums.write_text(sums.read_text("utf-8").replace(before, after), "utf-8")


def test_a_project_of_the_first_metamodels_is_understood(tmp_path, monkeypatch, jausml):
    golden = tmp_path / "golden"
    shutil.copytree(Path(__file__).parent / "golden_1_0", golden)
    (golden / ".git").mkdir()
    monkeypatch.chdir(golden)
    done = jausml("validate", "models")
    # Their copies of ready maps do not say what becomes of what is absent.
    assert {*re.findall(r"warning: (JML\d+)", done.output)} == {"JML459"}
    for model in ("rover.xmi", "boat.ros2jaus"):
        done = jausml("generate", f"models/{model}", "-o", f"src/{model}")


@pytest.mark.parametrize("version", ["0.1", "2.7"])
def test_a_model_of_another_version_is_told_so(project, version, jausml):
    model = project() / "models" / "rover.xmi"
    text = model.read_text("utf-8").replace("jausml.org/system/1.0", f"jausml.org/system/{version}")
    model.write_text(text, "utf-8")
    done = jausml("validate", model, status=1)
    assert "JML101" in done.output
    assert f"system/{version}" in done.output
