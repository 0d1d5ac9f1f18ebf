"""Workflow, hooks and forms are well formed, and run what is there."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
import yaml

try:
    import tomllib
except ImportError:  # Python 3.10
    tomllib = None

GUARDS = (".github", ".pre-commit-config.yaml", "Makefile")

ROOT = Path(__file__).resolve().parents[2]
MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")
TARGETS = set(re.findall(r"^([a-z][a-z-]*):", MAKEFILE, re.MULTILINE))
FORMS = sorted((ROOT / ".github" / "ISSUE_TEMPLATE").glob("*.yml"))


def read(name):
    return yaml.safe_load((ROOT / name).read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def workflow():
    return read(".github/workflows/ci.yml")


def test_the_workflow_runs_targets_that_are_there(workflow):
    steps = [step for job in workflow["jobs"].values() for step in job["steps"]]
    run = "\n".join(step.get("run", "") for step in steps)
    named = set(re.findall(r"\bmake ([a-z-]+)", run))
    assert {"lint", "coverage", "test-all", "test-random"} <= named <= TARGETS


@pytest.mark.skipif(tomllib is None, reason="needs Python 3.11")
def test_the_workflow_has_the_promised_versions_of_python(workflow):
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    promised = re.findall(r"Python :: (3\.\d+)", "\n".join(project["classifiers"]))
    assert workflow["jobs"]["check"]["strategy"]["matrix"]["python"] == promised


def test_hooks_run_what_lint_runs():
    hooks = [hook for repo in read(".pre-commit-config.yaml")["repos"] for hook in repo["hooks"]]
    lint = re.search(r"^lint:.*\n((?:\t.*\n)+)", MAKEFILE, re.MULTILINE)[1]
    programs = set(re.findall(r"\$\(BIN\)/([a-z-]+)", lint))
    assert {hook["entry"].split()[0] for hook in hooks} == {f".venv/bin/{p}" for p in programs}
    assert all(hook["language"] == "system" for hook in hooks)


@pytest.mark.parametrize("form", FORMS, ids=lambda path: path.stem)
def test_forms_are_yaml(form):
    content = read(form.relative_to(ROOT))
    assert form.name == "config.yml" or {"name", "description", "body"} <= content.keys()


@pytest.mark.parametrize(
    "page", ["CONTRIBUTING.md", ".github/pull_request_template.md", "docs/explanation/versions.md"]
)
def test_pages_name_targets_that_are_there(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    named = set(re.findall(r"`make ([a-z-]+)", text))
    assert named
    assert named <= TARGETS


def test_help_says_what_each_target_does():
    said = subprocess.run(
        ["make", "--no-print-directory", "help"], cwd=ROOT, capture_output=True, text=True
    ).stdout
    assert {line.split()[0] for line in said.splitlines()} == TARGETS
