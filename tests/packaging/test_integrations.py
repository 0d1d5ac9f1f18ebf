"""The action and the examples for CI systems: sound by their schemas, and their commands run."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import check_jsonschema
import pytest
import yaml
from click.testing import CliRunner
from scripts import ran
from sweeps import sweep

from jausml.cli import main
from jausml.language.model import LIBRARY_URI

GUARDS = ("integrations", "action.yml")

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "integrations"
ACTION = yaml.safe_load((ROOT / "action.yml").read_text(encoding="utf-8"))
MINIMAL = (ROOT / "models" / "minimal" / "minimal.xmi").read_text(encoding="utf-8")
MINIMAL = MINIMAL.replace("../library/", LIBRARY_URI)
DOUBTFUL = MINIMAL.replace(
    '<topics name="velocity"/>',
    '<topics name="velocity"/><safeValue target="twist.linear.x" value="0"/>',
)
EXPRESSION = re.compile(r"\$\{\{\s*(.*?)\s*\}\}")


@pytest.mark.parametrize(
    ("schema", "file"),
    [
        ("github-actions", ROOT / "action.yml"),
        ("github-workflows", FOLDER / "github-workflow.yml"),
        ("github-workflows", ROOT / ".github" / "workflows" / "ci.yml"),
        ("github-workflows", ROOT / ".github" / "workflows" / "release.yml"),
        ("gitlab-ci", FOLDER / "gitlab-ci.yml"),
        ("azure-pipelines", FOLDER / "azure-pipelines.yml"),
    ],
    ids=lambda parameter: parameter if isinstance(parameter, str) else parameter.name,
)
def test_it_is_what_the_schema_of_its_system_says(schema, file, tmp_path):
    # Some schemas have expressions as browsers took them before Unicode.
    options = ["--builtin-schema", f"vendor.{schema}", "--regex-variant", "nonunicode"]
    done = CliRunner().invoke(check_jsonschema.main, [*options, str(file)])
    assert done.exit_code == 0, done.output
    wrong = tmp_path / "wrong.yml"
    wrong.write_text("[1]", encoding="utf-8")
    assert CliRunner().invoke(check_jsonschema.main, [*options, str(wrong)]).exit_code == 1


@pytest.mark.parametrize(
    "file", ["action.yml", ".github/workflows/ci.yml", ".github/workflows/release.yml"]
)
def test_what_it_runs_of_others_cannot_change(file):
    used = re.findall(r"uses: (.*)", (ROOT / file).read_text(encoding="utf-8"))
    assert used
    assert [
        action for action in used if not re.fullmatch(r"\S+@[0-9a-f]{40} # v[\d.]+", action)
    ] == []


@pytest.fixture
def repository(tmp_path, monkeypatch):
    """A repository of models, and the current folder: a clean one and one with a warning."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "robot.xmi").write_text(MINIMAL, encoding="utf-8")
    (tmp_path / "models" / "doubtful.xmi").write_text(DOUBTFUL, encoding="utf-8")
    return tmp_path


def run_action(folder, **given):
    """Runs the scripts of the action but for the installation, as a runner does."""
    inputs = {
        name: action_input["default"] for name, action_input in ACTION["inputs"].items()
    } | given
    known = {f"inputs.{name}": value for name, value in inputs.items()}
    (step,) = (
        action for action in ACTION["runs"]["steps"] if action.get("name") == "Validate models"
    )
    assert "${{" not in step["run"], "an input within a script could be a command"
    values = {
        name: EXPRESSION.sub(lambda match: known[match[1]], text)
        for name, text in step["env"].items()
    }
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    # So GitHub calls a script of `shell: bash`.
    return ran(
        ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", step["run"]],
        cwd=folder,
        env={**os.environ, **values, "PATH": path},
        timeout=120,
    )


@pytest.mark.slow
def test_the_action_tells_findings_and_leaves_sarif_to_upload(repository):
    done = run_action(repository, models="models/robot.xmi models/doubtful.xmi")
    assert done.returncode == 1
    assert done.stdout.startswith("::warning file=models/doubtful.xmi,line=")
    (run,) = json.loads((repository / "jausml.sarif").read_text())["runs"]
    (result,) = run["results"]
    rule = run["tool"]["driver"]["rules"][result["ruleIndex"]]
    assert rule["help"]["markdown"].startswith("**JML426: ")


@pytest.mark.slow
def test_the_action_takes_a_baseline_and_no_command(repository):
    known = ("validate", "models", "--baseline", "known.json", "--write-baseline")
    assert CliRunner().invoke(main, known).exit_code == 0
    done = run_action(repository, baseline="known.json", sarif="$(touch hit).sarif")
    assert (done.returncode, done.stdout) == (0, "")
    assert not (repository / "hit").exists()


@pytest.mark.parametrize(
    "models", sweep(["a folder\nmodels/robot.xmi", "  a folder", "a folder\n\n"], every=3)
)
def test_the_action_looks_at_each_line(models, repository):
    (repository / "a folder").mkdir()
    (repository / "models" / "doubtful.xmi").rename(repository / "a folder" / "doubtful.xmi")
    done = run_action(repository, models=models)
    assert done.returncode == 1
    assert done.stdout.startswith("::warning file=a folder/doubtful.xmi,line=")
    assert done.stderr == f"1 warning in {'2 files' if 'robot' in models else '1 file'}\n"


@pytest.mark.parametrize(
    "given",
    sweep(
        [
            {"models": "--help"},
            {"models": "models\nnowhere"},
            {"models": "models", "strict": "yes"},
            {"models": "models", "upload": "True\n::notice::"},
            {"models": "models", "sarif": "nowhere/jausml.sarif"},
        ],
        every=3,
    ),
    ids=lambda given: next(reversed(given)),
)
def test_the_action_fails_at_what_it_cannot_mean(given, repository):
    done = run_action(repository, **given)
    assert done.returncode == 2
    assert len((done.stdout + done.stderr).splitlines()) == 1


def test_the_action_installs_itself_and_uploads_what_it_wrote():
    steps = ACTION["runs"]["steps"]
    assert steps[1]["env"] == {"ACTION_PATH": "${{ github.action_path }}"}
    (upload,) = (step for step in steps if "upload-sarif" in step.get("uses", ""))
    assert upload["with"]["sarif_file"] == ACTION["outputs"]["sarif"]["value"]
    assert "always()" in upload["if"]


def test_the_workflow_gives_the_permission_that_the_upload_needs():
    workflow = yaml.safe_load((FOLDER / "github-workflow.yml").read_text(encoding="utf-8"))
    validate = workflow["jobs"]["validate"]
    assert validate["permissions"]["security-events"] == "write"
    given = next(step for step in validate["steps"] if "jausml" in step.get("uses", ""))
    assert set(given["with"]) <= set(ACTION["inputs"])
    assert workflow["permissions"] == {"contents": "read"}


EXAMPLES = ("github-workflow.yml", "gitlab-ci.yml", "azure-pipelines.yml")


@pytest.mark.slow
def test_the_commands_of_the_examples_run(repository):
    """Those that several have are run once."""
    texts = {example: (FOLDER / example).read_text(encoding="utf-8") for example in EXAMPLES}
    found = {
        name: re.findall(r"\bjausml ((?:validate|generate) .+)$", text, re.MULTILINE)
        for name, text in texts.items()
    }
    assert all(found.values())
    (repository / "models" / "doubtful.xmi").unlink()
    assert CliRunner().invoke(main, ["generate", "models/robot.xmi", "-o", "src"]).exit_code == 0
    for command in dict.fromkeys(line for commands in found.values() for line in commands):
        done = CliRunner().invoke(main, command.split())
        assert done.exit_code == 0, done.output
    for report in ("jausml.xml", "generated.xml"):
        assert (repository / report).read_text().startswith("<?xml")
    for example in EXAMPLES[1:]:
        for report in ("jausml.xml", "generated.xml"):
            assert texts[example].count(report) == 2, "what is written is what is shown"


def test_the_image_is_made_of_what_is_there():
    """A daemon that builds it is not everywhere; its words are."""
    text = (FOLDER / "Containerfile").read_text(encoding="utf-8").replace("\\\n", "")
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    words = [line.split()[0] for line in lines]
    assert set(words) <= {"FROM", "COPY", "RUN", "USER", "WORKDIR", "CMD"}
    assert all(":" in line for line in lines if line.startswith("FROM"))
    assert words.index("USER") > max(n for n, word in enumerate(words) if word == "RUN")
    held = re.search(r"cp /source/(requirements/\S+) /wheels\b", text)[1]
    assert "graphviz-pure==" in (ROOT / held).read_text(encoding="utf-8")
    assert f"--require-hashes --requirement /wheels/{Path(held).name}" in text
    for instruction in (line for line in lines if line.startswith("RUN")):
        script = instruction.removeprefix("RUN ")
        assert subprocess.run(["sh", "-n", "-c", script]).returncode == 0
