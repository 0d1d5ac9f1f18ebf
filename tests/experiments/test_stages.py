"""Stages: in a process of their own, bounded, and kept while nothing changes."""

from __future__ import annotations

import importlib
import importlib.util
import io
import time
from pathlib import Path

import pytest

from experiments.right_turn.__main__ import _expected
from experiments.right_turn.data import Plan
from experiments.right_turn.progress import Progress
from experiments.right_turn.stages import STAGES, Stage, digest, is_done, perform

PLAN = Plan(quick=True, runs=2)
CODE = {
    "good": """
def run(folder, plan, tell):
    tell(f"driving {plan.runs}")
    print("words of its own")
    (folder / "summary.json").write_text("{}")
""",
    "bad": """
def run(folder, plan, tell):
    raise OSError("no port is free")
""",
    "endless": """
import subprocess, sys, time
def run(folder, plan, tell):
    child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
    (folder / "child").write_text(str(child.pid))
    tell("waiting")
    time.sleep(600)
""",
}


@pytest.fixture
def perform_stage(tmp_path, monkeypatch):
    """Runs the stage of a name of CODE; returns why it failed, its folder, and what was told."""
    (tmp_path / "code").mkdir()
    for name, text in CODE.items():
        (tmp_path / "code" / f"stage_{name}.py").write_text(text)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "code"))
    stream = io.StringIO()
    progress = Progress(stream, 200)

    def perform_one(name, limit=30.0):
        stage = Stage(name, f"stage_{name}", "a test", 30.0)
        why = perform(stage, tmp_path / name, PLAN, "sources", progress, limit)
        return why, tmp_path / name, stream.getvalue()

    return perform_one


def test_a_stage_tells_how_far_it_is_and_keeps_its_words_in_a_log(perform_stage):
    why, folder, told = perform_stage("good")
    assert why == ""
    assert "driving 2" in told
    assert "words of its own" not in told
    assert (folder / "log.txt").read_text() == "words of its own\n"


def test_a_stage_that_was_done_counts_for_its_plan_and_sources_alone(perform_stage):
    _, folder, _ = perform_stage("good")
    assert is_done(folder, PLAN, "sources")
    assert not is_done(folder, Plan(quick=True, runs=3), "sources")
    assert not is_done(folder, PLAN, "other sources")
    assert not is_done(folder / "nothing", PLAN, "sources")


def test_a_stage_that_fails_is_not_done(perform_stage):
    why, folder, _ = perform_stage("bad")
    assert why.startswith("exit status 1")
    assert "no port is free" in (folder / "log.txt").read_text()
    assert not is_done(folder, PLAN, "sources")


@pytest.mark.slow
def test_a_stage_without_end_is_ended_with_all_that_it_started(perform_stage):
    why, folder, told = perform_stage("endless", limit=3.0)
    assert why.startswith("not done after 3 s")
    assert "waiting" in told
    child = int((folder / "child").read_text())
    deadline = time.monotonic() + 10.0
    while _lives(child) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not _lives(child)


def _lives(process):
    """Whether a process still runs; one that ended may wait for its parent to take note."""
    try:
        return Path(f"/proc/{process}/stat").read_text().split()[2] != "Z"
    except FileNotFoundError:
        return False


@pytest.mark.parametrize("stage", STAGES, ids=lambda stage: stage.name)
def test_each_stage_has_a_module_with_a_function(stage):
    assert importlib.util.find_spec(stage.module)
    assert hasattr(importlib.import_module(stage.module), "run")


def test_the_digest_changes_with_each_source_and_with_nothing_else(tmp_path):
    source = tmp_path / "models" / "plant.py"
    source.parent.mkdir()
    source.write_text("mass = 1\n")
    first = digest(tmp_path)
    (tmp_path / "models" / "turn.png").write_bytes(b"picture")
    (tmp_path / "notes.py").write_text("elsewhere\n")
    assert digest(tmp_path) == first
    source.write_text("mass = 2\n")
    changed = digest(tmp_path)
    source.rename(source.with_name("body.py"))
    assert len({first, changed, digest(tmp_path)}) == 3


@pytest.mark.parametrize(
    ("quick", "load", "said"),
    [(True, 0.2, "seventy seconds"), (False, 0.2, "ten minutes"), (True, 4.0, "--patience 3")],
)
def test_what_it_takes_is_said_before(quick: bool, load: float, said: str) -> None:
    text = _expected(Plan(quick=quick), load, 2)

    assert said in text
    assert ("longer" in text) is (load > 1.0)
