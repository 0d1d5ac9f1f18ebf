"""`jausml generate`, with small targets in place of the shipped ones."""

import json
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest
import warm

from jausml.generation.artifact import Kind, MethodContract, SkeletonContract
from jausml.generation.contract.finding import FindingKind
from jausml.generation.errors import GenerationError
from jausml.generation.manifest import read_manifest
from jausml.generation.target import Target, TextFile, TextTask, WholeLibrary
from jausml.language.metamodel.classes import jaus

SKELETON = '''\
"""Yours."""


class Sensor(SensorBase):
    def on_velocity(self, message):
        pass
'''
CONTRACT = SkeletonContract(
    "Sensor", "SensorBase", (MethodContract("on_velocity", ("message",), "0x4404", "stub\n"),)
)

pytestmark = pytest.mark.usefixtures("folder")


def small_tasks(model):
    components = model.instances(jaus.Component)
    bases = [
        TextFile(f"{c.name}_base.py", f"ADDRESS = {c.address!r}\n", f"component:{c.name}", "m")
        for c in components
    ]
    skeleton = TextTask(
        [TextFile("sensor.py", SKELETON, "component:sensor", "m")],
        kind=Kind.SKELETON,
        contract=lambda _: CONTRACT,
    )
    return [TextTask(bases), skeleton]


def processes(model):
    return [{"name": c.name} for c in model.instances(jaus.Component)]


def one_file(path, text):
    return lambda _: [TextTask([TextFile(path, text, "x", "m")])]


SMALL = Target("small", "A generated file for each component.", small_tasks, processes=processes)
BASES = replace(SMALL, tasks=lambda model: small_tasks(model)[:1])
BROKEN = Target("broken", "Fails.", one_file("a.py", "def"))
ASKED = Target(
    "asked",
    "Runs when it is named.",
    one_file("asked.lua", "-- some\n"),
    is_on_request=True,
    whole_library=WholeLibrary("everything", one_file("asked.lua", "-- all\n")),
)


@pytest.fixture(autouse=True)
def targets(monkeypatch):
    installed = {"small": SMALL}
    monkeypatch.setattr("jausml.generation.target.load_targets", lambda: installed)
    return installed


def test_generates_beside_the_current_folder_by_default(jausml, folder):
    result = jausml("generate", "good.xmi")
    assert result.exit_code == 0, result.stderr
    out = folder / "good_ws" / "src"
    assert (out / "sensor_base.py").is_file()
    assert (out / "sensor.py").read_text() == SKELETON
    assert "create sensor_base.py (new)" in result.stdout
    assert f"4 created in {out}" in result.stderr
    assert '"processes"' in (out / ".jausml" / "manifest.json").read_text()


def test_second_run_changes_nothing(jausml):
    jausml("generate", "good.xmi", "-o", "out")
    before = {path: path.stat().st_mtime_ns for path in Path("out").rglob("*")}
    result = jausml("generate", "good.xmi", "-o", "out")
    assert result.stdout == ""
    assert "4 kept" in result.stderr
    listed = jausml("--verbose", "generate", "good.xmi", "-o", "out").stdout
    assert "keep   sensor.py (yours)" in listed
    assert {path: path.stat().st_mtime_ns for path in Path("out").rglob("*")} == before
    assert jausml("generate", "good.xmi", "-o", "out", "--check").exit_code == 0


def test_quiet_lists_nothing_but_what_a_check_finds(jausml):
    result = jausml("generate", "good.xmi", "-o", "out", "--quiet")
    assert (result.stdout, result.stderr) == ("", "")
    Path("out", "sensor_base.py").unlink()
    result = jausml("generate", "good.xmi", "-o", "out", "--quiet", "--check")
    assert result.exit_code == 1
    assert "create sensor_base.py" in result.stdout


def test_many_files_of_a_package_are_one_line(jausml, targets):
    paths = [f"big/part_{number}.py" for number in range(4)]
    paths += [f"little/part_{number}.py" for number in range(3)]
    files = [TextFile(path, "PART = 1\n", path, "m") for path in paths]
    targets["small"] = Target("small", "Packages.", lambda _: [TextTask(files)])
    result = jausml("generate", "good.xmi", "-o", "out")
    assert "create big/ (4 files, new)\n" in result.stdout
    assert "big/part" not in result.stdout
    assert "create little/part_2.py (new)\n" in result.stdout
    listed = jausml("--verbose", "generate", "good.xmi", "-o", "out", "--force").stdout
    assert "keep   big/part_0.py (unchanged)\n" in listed


@pytest.mark.parametrize("mode", ["--check", "--diff", "--dry-run"])
def test_modes_write_nothing(jausml, mode):
    result = jausml("generate", "good.xmi", "-o", "out", mode)
    assert result.exit_code == (1 if mode == "--check" else 0)
    assert not Path("out").exists()
    assert "sensor_base.py" in result.stdout
    assert "4 to create" in result.stderr


def test_diff_is_a_patch(jausml):
    jausml("generate", "good.xmi", "-o", "out")
    text = Path("good.xmi").read_text()
    Path("good.xmi").write_text(text.replace('"10.1.1"', '"10.1.9"'))
    patch = jausml("generate", "good.xmi", "-o", "out", "--diff").stdout
    assert "--- a/sensor_base.py\n+++ b/sensor_base.py\n" in patch
    assert "\n-ADDRESS = '10.1.1'\n" in patch
    assert "\n+ADDRESS = '10.1.9'\n" in patch
    assert jausml("generate", "good.xmi", "-o", "out", "--check").exit_code == 1


def test_modes_exclude_each_other(jausml):
    assert jausml("generate", "good.xmi", "--check", "--diff").exit_code == 2


def test_invalid_model_stops_before_anything(jausml, folder):
    result = jausml("generate", "bad.xmi")
    assert result.exit_code == 1
    assert "JML425" in result.stderr
    assert "nothing generated" in result.stderr
    assert not (folder / "bad_ws").exists()


def test_warnings_are_shown_and_do_not_stop(jausml):
    result = jausml("generate", "doubtful.xmi")
    assert result.exit_code == 0
    assert "JML426" in result.stderr


def test_edited_file_is_refused_until_forced(jausml):
    jausml("generate", "good.xmi", "-o", "out")
    Path("out/sensor_base.py").write_text("MINE = 1\n")
    refused = jausml("generate", "good.xmi", "-o", "out")
    assert refused.exit_code == 1
    assert "out/sensor_base.py: error: edited by hand" in refused.stderr
    assert "--force" in refused.stderr
    assert "nothing written" in refused.stderr
    assert Path("out/sensor_base.py").read_text() == "MINE = 1\n"
    assert jausml("generate", "good.xmi", "-o", "out", "--force").exit_code == 0
    assert Path("out/sensor_base.py.orig").read_text() == "MINE = 1\n"
    assert "10.1.1" in Path("out/sensor_base.py").read_text()


def test_drift_is_reported_with_a_place_and_a_stub(jausml):
    jausml("generate", "good.xmi", "-o", "out")
    Path("out/sensor.py").write_text(SKELETON.replace("on_velocity", "on_nothing_like_it"))
    result = jausml("generate", "good.xmi", "-o", "out")
    assert result.exit_code == 0
    assert "out/sensor.py:5:1: warning: JML908 on_nothing_like_it" in result.stderr
    assert "out/sensor.py:4:1: info: JML910 Sensor does not define" in result.stderr
    assert "\nstub\n" in result.stderr


def test_an_error_in_code_of_the_user_fails(jausml):
    jausml("generate", "good.xmi", "-o", "out")
    Path("out/sensor.py").write_text("class Sensor(\n")
    result = jausml("generate", "good.xmi", "-o", "out")
    assert "out/sensor.py:1:" in result.stderr
    assert ": error: JML9" in result.stderr
    assert result.exit_code == 1


@pytest.mark.parametrize("option", ["--check", "--strict"])
def test_code_that_fell_behind_fails_where_it_is_asked(jausml, option):
    jausml("generate", "good.xmi", "-o", "out")
    assert jausml("generate", "good.xmi", "-o", "out", option).exit_code == 0
    # A handler that the class lacks has a default in the base; one that nobody calls is lost.
    Path("out/sensor.py").write_text(SKELETON.replace("on_velocity", "on_nothing_like_it"))
    assert jausml("generate", "good.xmi", "-o", "out").exit_code == 0
    result = jausml("generate", "good.xmi", "-o", "out", option)
    assert result.exit_code == 1
    assert "warning: JML908 on_nothing_like_it" in result.stderr


def test_strict_generation_stops_at_warnings_about_the_model(jausml, model_text):
    Path("good.xmi").write_text(model_text.replace('address="10.1.1"', 'address="511.1.1"'))
    assert jausml("generate", "good.xmi", "-o", "out").exit_code == 0
    result = jausml("generate", "good.xmi", "-o", "strict", "--strict")
    assert result.exit_code == 1
    assert "JML309" in result.stderr
    assert not Path("strict").exists()


def test_component_that_is_gone(jausml, model_text):
    jausml("generate", "good.xmi", "-o", "out")
    Path("good.xmi").write_text(model_text.replace('name="sensor_bridge"', 'name="other_bridge"'))
    result = jausml("generate", "good.xmi", "-o", "out")
    assert "delete sensor_bridge_base.py" in result.stdout
    assert not Path("out/sensor_bridge_base.py").exists()


def test_only_some_targets(jausml, refused, targets):
    targets["broken"] = BROKEN
    assert jausml("generate", "good.xmi", "--target", "small").exit_code == 0
    told = "no target 'smal'; installed: small, broken"
    refused(told, "generate", "good.xmi", "--target", "smal")


def test_faulty_target_is_an_internal_error_and_writes_nothing(jausml, folder, targets):
    targets["broken"] = BROKEN
    result = jausml("generate", "good.xmi")
    assert result.exit_code == 3
    assert "a.py would not be readable" in result.stderr
    assert not (folder / "good_ws").exists()


def test_targets_that_cannot_be_loaded(refused, monkeypatch):
    def fail():
        raise GenerationError("target 'x' is broken")

    monkeypatch.setattr("jausml.generation.target.load_targets", fail)
    refused("target 'x' is broken", "generate", "good.xmi")


def test_model_without_a_system(refused):
    Path("set.xmi").write_text(
        '<jaus:ServiceSet xmlns:jaus="http://www.jausml.org/jaus/1.0" name="set"/>'
    )
    refused("set.xmi holds no system, where one is needed", "generate", "set.xmi")


def test_output_that_cannot_be_written(jausml, refused):
    Path("out").write_text("a file")
    refused("out is no folder", "generate", "good.xmi", "-o", "out")
    assert jausml("generate", ".").exit_code == 2


@pytest.fixture
def asked(targets):
    targets["asked"] = ASKED


@pytest.mark.usefixtures("asked")
def test_a_target_on_request_does_not_run_by_itself(jausml, folder):
    assert jausml("generate", "good.xmi", "-o", "out").exit_code == 0
    assert not (folder / "out" / "asked.lua").exists()
    assert jausml("generate", "good.xmi", "-o", "out", "--target", "asked").exit_code == 0
    assert (folder / "out" / "asked.lua").read_text().endswith("-- some\n")
    assert (folder / "out" / "sensor_base.py").exists()


@pytest.mark.usefixtures("asked")
def test_files_of_a_target_on_request_stay_when_others_run(jausml, folder):
    jausml("generate", "good.xmi", "-o", "out", "--target", "asked")
    assert jausml("generate", "good.xmi", "-o", "out").exit_code == 0
    assert (folder / "out" / "asked.lua").exists()
    result = jausml("generate", "good.xmi", "-o", "out", "--check")
    assert result.exit_code == 0
    assert "asked.lua" not in result.output


@pytest.mark.usefixtures("asked")
def test_files_of_a_target_that_is_gone_are_deleted(jausml, folder, targets):
    jausml("generate", "good.xmi", "-o", "out")
    del targets["small"]
    assert jausml("generate", "good.xmi", "-o", "out").exit_code == 0
    assert not (folder / "out" / "sensor_base.py").exists()


@pytest.mark.usefixtures("asked")
def test_all_reaches_the_target_that_knows_it(jausml, folder):
    arguments = ("generate", "good.xmi", "-o", "out", "--target", "asked", "--all")
    assert jausml(*arguments).exit_code == 0
    assert (folder / "out" / "asked.lua").read_text().endswith("-- all\n")


@pytest.mark.parametrize("arguments", [(), ("--target", "small")])
@pytest.mark.usefixtures("asked")
def test_all_without_such_a_target_is_a_usage_error(refused, folder, arguments):
    told = "--all is an option of --target asked"
    refused(told, "generate", "good.xmi", "-o", "out", "--all", *arguments)
    assert not (folder / "out").exists()


@pytest.fixture
def another(folder, model_text):
    """A second system with a bridge of its own, in other.xmi."""
    text = model_text.replace('name="minimal"', 'name="other"').replace("sensor_bridge", "arm")
    (folder / "other.xmi").write_text(text)
    return text


@pytest.mark.usefixtures("another")
def test_two_models_share_a_workspace(jausml, folder, targets):
    targets["small"] = BASES
    assert jausml("generate", "good.xmi", "-o", "out").exit_code == 0
    result = jausml("generate", "other.xmi", "-o", "out")
    assert result.exit_code == 0, result.stderr
    assert "delete" not in result.stdout
    assert (folder / "out" / "sensor_bridge_base.py").exists()
    assert jausml("generate", "good.xmi", "-o", "out", "--check").exit_code == 0
    names = read_manifest(folder / "out").models
    assert list(names["minimal"]["processes"]) == [{"name": "sensor"}, {"name": "sensor_bridge"}]
    assert list(names["other"]["processes"]) == [{"name": "sensor"}, {"name": "arm"}]


def test_a_file_that_two_models_want_is_refused(jausml, folder, another):
    assert jausml("generate", "good.xmi", "-o", "out").exit_code == 0
    before = contents(folder / "out")
    (folder / "other.xmi").write_text(
        another.replace('"arm"', '"sensor_bridge"').replace('"10.1.1"', '"10.1.9"')
    )
    result = jausml("generate", "other.xmi", "-o", "out")
    assert result.exit_code == 1
    where = folder / "out" / "sensor_base.py"
    assert f"{where}: error: component:sensor of 'other' asks for the" in result.stderr
    assert "of the model 'minimal'" in result.stderr
    assert "nothing written" in result.stderr
    assert contents(folder / "out") == before


@pytest.mark.usefixtures("another")
def test_a_renamed_system_takes_over_its_files(jausml, refused, folder, targets):
    targets["small"] = BASES
    jausml("generate", "good.xmi", "-o", "out")
    told = "knows no model 'nobody' to adopt; there are: minimal"
    refused(told, "generate", "other.xmi", "-o", "out", "--adopt", "nobody")
    result = jausml("generate", "other.xmi", "-o", "out", "--adopt", "minimal")
    assert result.exit_code == 0
    assert "delete sensor_bridge_base.py" in result.stdout
    assert list(read_manifest(folder / "out").models) == ["other"]


def contents(folder):
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.slow
@pytest.mark.usefixtures("folder")
def test_runs_at_once_wait_for_each_other():
    """All end well, and the tree is that of one run."""
    command = [*warm.command(), "generate", "good.xmi", "-o", "out"]
    runs = [
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for _ in range(3)
    ]
    outputs = [run.communicate(timeout=300) for run in runs]

    assert [run.returncode for run in runs] == [0, 0, 0], outputs
    assert subprocess.run([*command, "--check"], check=False, capture_output=True).returncode == 0
    assert sum("created" in error for _, error in outputs) == 1


def test_a_folder_that_cannot_be_written_says_that_a_part_may_be(jausml, folder):
    jausml("generate", "good.xmi", "-o", "out")
    base = folder / "out" / "sensor_base.py"
    base.unlink()
    base.with_name(f".{base.name}.jausml-tmp").mkdir()

    result = jausml("generate", "good.xmi", "-o", "out")

    assert result.exit_code == 2
    assert base.name in result.output
    assert "some files may be written already" in result.output


REPORTED = {
    "json": ('"rule": "JML908"', '"file": "out/sensor.py"'),
    "junit": ('<testsuite name="out/sensor.py"', "JML908 on_nothing_like_it"),
    "sarif": ('"ruleId": "JML908"', '"uri": "out/sensor.py"'),
    "github": ("::warning file=out/sensor.py,line=5,col=1,title=JML908::on_nothing_like_it",),
}


@pytest.mark.parametrize("output_format", REPORTED)
def test_a_check_reports_code_as_models_are_reported(jausml, output_format):
    jausml("generate", "good.xmi", "-o", "out")
    Path("out/sensor.py").write_text(SKELETON.replace("on_velocity", "on_nothing_like_it"))
    check = ("generate", "good.xmi", "-o", "out", "--check", "--format", output_format)
    result = jausml(*check)
    assert result.exit_code == 1
    assert all(passage in result.stdout for passage in REPORTED[output_format])
    assert "sensor.py" not in result.stderr
    assert jausml(*check, "--output", "report").exit_code == 1
    assert Path("report").read_text() == result.stdout


def test_a_report_of_a_check_has_models_and_stale_files_too(jausml):
    def found(model):
        result = jausml("generate", model, "-o", "out", "--check", "--format", "sarif")
        assert result.exit_code == 1
        (run,) = json.loads(result.stdout)["runs"]
        rules = [rule["id"] for rule in run["tool"]["driver"]["rules"]]
        assert all(rules[finding["ruleIndex"]] == finding["ruleId"] for finding in run["results"])
        return {
            (
                sarif_result["ruleId"],
                sarif_result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"],
            )
            for sarif_result in run["results"]
        }

    stale = {finding for finding in found("good.xmi") if finding[0] == "JML901"}
    assert ("JML901", "out/sensor.py") in stale
    assert ("JML901", "out/sensor_base.py") in stale
    bad = found("bad.xmi")
    assert bad
    assert {path for _, path in bad} == {"bad.xmi"}


@pytest.mark.parametrize("options", [["--format", "json"], ["--output", "x"]])
def test_a_report_is_of_a_check_alone(refused, options):
    told = "--format and --output are of --check"
    refused(told, "generate", "good.xmi", "-o", "out", "--dry-run", *options)
    assert not Path("x").exists()


def test_each_kind_of_finding_in_code_is_a_rule_that_is_explained(jausml):
    for kind in FindingKind:
        assert jausml("explain", kind.value).stdout.startswith(f"{kind.value}: code: ")
