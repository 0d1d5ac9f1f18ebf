"""Of a sweep a part guards, the others are slow, and CI runs both."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from needs import SHARED
from sweeps import MARKING, sweep

GUARDS = (".ci/run",)

MADE = ["lint", "test-all", "test-beside"]
PROGRAMS = {
    "make": """echo "$1 $HOME $(ls .. | tr '\\n' ,) ${JAUSML_SHARED:--}" >> "$RAN"
[ "$1" != "$FAILING" ]""",
    **dict.fromkeys(("apt-get", "dpkg"), "true"),
}
CI = Path(__file__).resolve().parents[2] / ".ci" / "run"


def slow(values):
    return [getattr(value, "values", None) for value in values]


def test_each_so_manieth_guards_from_the_first_on():
    assert slow(sweep("abcde", every=2, rest=1)) == [None, ("b",), None, ("d",), None]
    assert sweep("abc", every=1) == ["a", "b", "c"]


def test_a_part_of_the_rest_is_taken_unless_all_is_asked_for():
    assert slow(sweep("abcdef", every=3, rest=2, whole=False)) == [None, ("b",), None, ("e",)]
    assert slow(sweep("abcdefg", every=7, whole=False)) == [None, ("b",), ("g",)]
    assert slow(sweep("abcd", every=3, rest=0, whole=False)) == [None, None]
    assert sweep("abcdef", every=3, rest=0, whole=True) == sweep("abcdef", every=3, rest=1)
    assert sweep("abcdef", every=3, whole=True) == sweep("abcdef", every=3, rest=1)


def test_what_guards_can_be_told():
    assert slow(sweep([(1, "a"), (2, "b")], every=lambda pair: pair[1] == "b")) == [(1, "a"), None]


def test_names_and_marks_stay():
    skipped = pytest.param(2, marks=pytest.mark.skip, id="two")
    _, made = sweep([1, skipped], every=2)
    assert (made.id, [mark.name for mark in made.marks]) == ("two", ["skip", "slow"])


def test_a_sweep_that_guards_nothing_is_refused():
    with pytest.raises(AssertionError, match="nothing guards"):
        sweep([1, 2], every=lambda _: False)


def test_what_is_chosen_by_a_mark_stands_in_a_file_that_names_it(request):
    marked = {
        (item.path, name)
        for item in request.session.items
        for name in MARKING
        if item.get_closest_marker(name)
    }
    assert [
        pair for pair in marked if not re.search(MARKING[pair[1]], pair[0].read_text("utf-8"))
    ] == []


@pytest.fixture
def checkout(tmp_path):
    """A repository with nothing but what CI runs, and what stands beside it."""
    root = tmp_path / "here" / "checkout"
    (root / ".ci").mkdir(parents=True)
    shutil.copy(CI, root / ".ci")
    name = ("-c", "user.name=CI", "-c", "user.email=ci@localhost")
    for command in (("init", "-q"), ("add", "."), (*name, "commit", "-qm", "Begin")):
        subprocess.run(["git", *command], cwd=root, check=True)
    (root.parent / SHARED.name).mkdir()
    return root


def judged(checkout, folder, failing):
    """Runs what CI runs with programs that only note it; returns the status, and what they note."""
    programs = folder / "programs"
    programs.mkdir()
    for name, says in PROGRAMS.items():
        (programs / name).write_text(f"#!/bin/sh\n{says}\n", encoding="utf-8")
        (programs / name).chmod(0o755)
    path = os.pathsep.join([str(programs), os.environ["PATH"]])
    environment = {**os.environ, "PATH": path, "RAN": str(folder / "ran"), "FAILING": failing}
    done = subprocess.run([checkout / ".ci" / "run"], env=environment)
    return done.returncode, [line.split() for line in (folder / "ran").read_text().splitlines()]


@pytest.mark.parametrize("failing", ["", "lint", "test-all", "test-beside"])
def test_ci_runs_all_where_nothing_is_beside_and_fails_if_one_does(checkout, tmp_path, failing):
    status, ran = judged(checkout, tmp_path, failing)
    assert [target for target, *_ in ran] == (MADE[:1] if failing == "lint" else MADE)
    assert (status != 0) == bool(failing)
    for target, home, beside, shared in ran:
        # The clone, its home, and nothing else; the folder is named to the last step alone.
        assert (Path(home).name, beside) == ("home", "home,jausml,")
        assert shared == (str(checkout.parent / SHARED.name) if target == "test-beside" else "-")


def test_ci_says_nothing_of_what_is_not_beside_it(checkout, tmp_path):
    (checkout.parent / SHARED.name).rmdir()
    status, ran = judged(checkout, tmp_path, "")
    assert (status, [target for target, *_ in ran]) == (0, MADE[:2])
