"""`jausml validate`."""

import json
import os
import subprocess

import pytest
import warm
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

pytestmark = pytest.mark.usefixtures("folder")


def test_clean_model(jausml):
    result = jausml("validate", "good.xmi")
    assert (result.exit_code, result.stdout) == (0, "")
    assert result.stderr == "no problems in 1 file\n"


def test_problems_are_lines_that_editors_know(jausml, folder):
    result = jausml("validate", "./bad.xmi")
    assert result.exit_code == 1
    lines = (folder / "bad.xmi").read_text().splitlines()
    line = next(number for number, text in enumerate(lines, 1) if 'rate="2000"' in text)
    place = f"./bad.xmi:{line}:{lines[line - 1].index('rate=') + 1}"
    assert result.stdout.startswith(
        f"{place}: error: JML425 rate 2000 of 'velocity' is out of range"
    )
    assert result.stderr == "1 error in 1 file\n"


def test_reader_and_rules_report_in_one_run(jausml, folder):
    text = (folder / "bad.xmi").read_text().replace('type="vehicle"', 'typ="vehicle"')
    (folder / "bad.xmi").write_text(text)
    result = jausml("validate", "bad.xmi", "--format", "json", "-q")
    assert result.stderr == ""
    content = json.loads(result.stdout)
    assert [diagnostic["rule"] for diagnostic in content["diagnostics"]] == ["JML103", "JML425"]
    assert content["diagnostics"][0]["hint"] == "did you mean 'type'?"
    assert content["diagnostics"][1]["element"] == "minimal/sensor_bridge/velocity"


def test_warnings_fail_only_with_strict(jausml):
    assert jausml("validate", "doubtful.xmi").exit_code == 0
    result = jausml("validate", "--strict", "doubtful.xmi")
    assert result.exit_code == 1
    assert "warning: JML426" in result.stdout


def test_folder(jausml, folder):
    (folder / "sub" / ".hidden").mkdir(parents=True)
    (folder / "good.xmi").rename(folder / "sub" / "good.xmi")
    (folder / "bad.xmi").rename(folder / "sub" / ".hidden" / "bad.xmi")
    result = jausml("validate", ".")
    assert result.exit_code == 0
    assert result.stdout.startswith("doubtful.xmi:")
    assert "1 warning in 2 files" in result.stderr


def test_same_file_twice_is_one_file(jausml):
    result = jausml("validate", "bad.xmi", ".", "bad.xmi")
    assert result.stdout.count("JML425") == 1


def test_nothing_found_is_2(refused, folder):
    (folder / "empty").mkdir()
    refused("no .xmi or .ros2jaus files in empty", "validate", "empty")


def test_missing_path_is_2(jausml):
    result = jausml("validate", "good.xmi", "nowhere.xmi")
    assert result.exit_code == 2
    assert "nowhere.xmi: No such file or directory" in result.stderr
    assert result.stdout == ""


def test_output_goes_to_a_file(jausml, refused, folder):
    result = jausml("validate", "bad.xmi", "--format", "json", "--output", "report.json")
    assert result.exit_code == 1
    assert result.stdout == ""
    assert json.loads((folder / "report.json").read_text())["diagnostics"][0]["rule"] == "JML425"
    told = "cannot write nowhere/report.json"
    refused(told, "validate", "bad.xmi", "--output", "nowhere/report.json")


def test_references_out_of_the_project_need_permission(jausml, folder, model_text):
    (folder / "project").mkdir()
    (folder / "other.xmi").write_text(model_text)
    reference = '<peers href="../other.xmi#sensor"/><topics'
    text = model_text.replace('peers="sensor"', "").replace("<topics", reference)
    (folder / "project" / "model.xmi").write_text(text)
    arguments = ("validate", "project/model.xmi", "--project-root", "project")
    refused = jausml(*arguments)
    assert refused.exit_code == 1
    assert "JML209" in refused.stdout
    allowed = jausml(*arguments, "--allow-outside")
    assert allowed.exit_code == 0, allowed.stdout


def test_a_project_is_found_where_an_option_says(jausml, refused, folder, model_text):
    (folder / "far").mkdir()
    (folder / "far" / "other.xmi").write_text(model_text)
    (folder / "near").mkdir()
    reference = '<peers href="platform:/resource/other.models/other.xmi#sensor"/><topics'
    text = model_text.replace('peers="sensor"', "").replace("<topics", reference)
    (folder / "near" / "model.xmi").write_text(text)
    arguments = ("validate", "near/model.xmi", "--project-root", "near")
    assert "JML210" in jausml(*arguments).stdout
    assert jausml(*arguments, "--project", "other.models=far").exit_code == 0
    for wrong in ("other.models", "other.models=nowhere", "=far"):
        refused(f"'{wrong}' is not NAME=DIR", *arguments, "--project", wrong)


@pytest.mark.slow
def test_same_bytes_in_every_process(folder):
    (folder / "bad.xmi").write_text(
        (folder / "bad.xmi").read_text().replace("Velocity_X", "V").replace("10.1.2", "10.1.1")
    )
    outputs = {
        subprocess.run(
            [*warm.command(), "validate", "--format", "json", "."],
            capture_output=True,
            env={**os.environ, "PYTHONHASHSEED": str(seed)},
        ).stdout
        for seed in range(3)
    }
    assert len(outputs) == 1
    assert b"JML302" in outputs.pop()


@pytest.mark.slow
def test_exit_status_of_the_process():
    def status(*arguments):
        command = [*warm.command(), "validate", *arguments]
        return subprocess.run(command, capture_output=True).returncode

    assert status("good.xmi") == 0
    assert status("bad.xmi") == 1
    assert status("none.xmi") == 2


@pytest.mark.parametrize("content", [b"", b"<a", b"\xff\xfe\x00", b"<a/>", b"<<<<<<< HEAD\n"])
def test_what_is_no_model_is_a_problem_with_a_place(jausml, folder, content):
    (folder / "bad.xmi").write_bytes(content)
    result = jausml("validate", "bad.xmi")
    assert result.exit_code == 1
    assert result.stdout.startswith("bad.xmi:1:")


@settings(
    max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_spoilt_models_never_end_in_a_traceback(jausml, folder, model_text, data):
    start = data.draw(st.integers(0, len(model_text) - 1))
    end = data.draw(st.integers(start, min(len(model_text), start + 60)))
    new = data.draw(st.text(max_size=12) | st.sampled_from(['"', "<a>", "&#10;", "-1", "NaN", ""]))
    text = model_text[:start] + new + model_text[end:]
    (folder / "bad.xmi").write_bytes(text.encode("utf-8", "surrogatepass"))
    result = jausml("validate", "bad.xmi")
    assert result.exit_code in (0, 1), result.stderr


@pytest.mark.parametrize(
    ("name", "start"),
    [("junit", '<?xml version="1.0"'), ("sarif", '{\n  "$schema"'), ("github", "::error file=")],
)
def test_formats_for_build_servers(jausml, name, start):
    result = jausml("validate", "bad.xmi", "--format", name, "-q")
    assert result.exit_code == 1
    assert result.stdout.startswith(start)
    assert "bad.xmi" in result.stdout


def test_copies_of_the_library_in_a_project_are_judged_as_the_library_if_named(jausml, tmp_path):
    assert jausml("init", tmp_path / "rover", "--from", "empty").exit_code == 0
    result = jausml("validate", "--strict", tmp_path / "rover")
    assert (result.exit_code, result.stderr) == (0, "no problems in 1 file\n")
    copy = tmp_path / "rover" / "library" / "jaus" / "iop.xmi"
    result = jausml("validate", copy)
    assert result.exit_code == 0
    assert "iop.xmi:416:67: warning: JML323" in result.stdout
    copy.write_bytes(copy.read_bytes() + b"\n")
    changed = jausml("validate", tmp_path / "rover")
    assert changed.exit_code == 1
    assert "iop.xmi:416:67: error: JML323" in changed.stdout


@pytest.mark.timeout(60)
@pytest.mark.parametrize("verb", ["validate", "diagram", "generate", "diff", "merge"])
@pytest.mark.parametrize("kind", ["endless", "pipe"])
def test_what_is_no_regular_file_is_refused(refused, folder, verb, kind):
    file = folder / "sub" / "a.xmi"
    file.parent.mkdir()
    if kind == "endless":
        file.symlink_to("/dev/zero")
    else:
        os.mkfifo(file)
    more = {"merge": ["good.xmi", "good.xmi"], "diff": ["good.xmi"], "diagram": ["-o", "a.svg"]}
    refused("a.xmi: it is no regular file", verb, "sub/a.xmi", *more.get(verb, []))


@pytest.mark.timeout(60)
def test_a_folder_with_a_pipe_is_refused(jausml, folder):
    (folder / "sub").mkdir()
    os.mkfifo(folder / "sub" / "a.xmi")
    result = jausml("validate", "sub")
    assert result.exit_code == 1
    assert "sub/a.xmi:1:1: error: JML001 it is no regular file" in result.stdout


def test_a_link_out_of_the_project_is_refused(jausml, refused, folder, tmp_path_factory):
    outside = tmp_path_factory.mktemp("outside") / "secret.xmi"
    outside.write_bytes((folder / "good.xmi").read_bytes())
    (folder / "sub").mkdir()
    (folder / "sub" / "a.xmi").symlink_to(outside)
    refused("a.xmi: JML209 the link leads out of the project root", "validate", "sub")
    assert jausml("validate", "sub/a.xmi").exit_code == 0
