"""Of a sweep a part guards, the others are slow, and CI runs both."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest
from sweeps import sweep

GUARDS = (".ci/run",)

MADE = ["lint", "test-slow", "test"]
PROGRAMS = {
    "make": 'echo "$1" >> "$RAN"; [ "$1" != "$FAILING" ]',
    **dict.fromkeys(("apt-get", "chromium", "nft"), "true"),
}
CI = Path(__file__).resolve().parents[2] / ".ci" / "run"


def slow(values):
    return [getattr(each, "values", None) for each in values]


def test_each_so_manieth_guards_from_the_first_on():
    assert slow(sweep("abcde", every=2)) == [None, ("b",), None, ("d",), None]
    assert sweep("abc", every=1) == ["a", "b", "c"]


def test_what_guards_can_be_told():
    assert slow(sweep([(1, "a"), (2, "b")], every=lambda pair: pair[1] == "b")) == [(1, "a"), None]


def test_names_and_marks_stay():
    skipped = pytest.param(2, marks=pytest.mark.skip, id="two")
    _, made = sweep([1, skipped], every=2)
    assert (made.id, [each.name for each in made.marks]) == ("two", ["skip", "slow"])


def test_a_sweep_that_guards_nothing_is_refused():
    with pytest.raises(AssertionError, match="nothing guards"):
        sweep([1, 2], every=lambda _: False)


@pytest.mark.parametrize("failing", ["", "test-slow", "test", "lint"])
def test_ci_runs_both_and_fails_if_one_does(tmp_path, failing):
    (tmp_path / ".ci").mkdir()
    shutil.copy(CI, tmp_path / ".ci")
    programs = tmp_path / "programs"
    programs.mkdir()
    for name, says in PROGRAMS.items():
        (programs / name).write_text(f"#!/bin/sh\n{says}\n", encoding="utf-8")
        (programs / name).chmod(0o755)
    path = os.pathsep.join([str(programs), os.environ["PATH"]])
    environment = {**os.environ, "PATH": path, "RAN": str(tmp_path / "ran"), "FAILING": failing}
    done = subprocess.run([tmp_path / ".ci" / "run"], env=environment)
    made = (tmp_path / "ran").read_text().split()
    assert made == (MADE[:1] if failing == "lint" else MADE)
    assert (done.returncode != 0) == bool(failing)
