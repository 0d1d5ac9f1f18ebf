"""One place says what tests need; a test that lacks it is skipped with the cure."""

import os
import re
import sys
from pathlib import Path

import needs
import pytest
from for_each import for_each
from scripts import ran
from sweeps import sweep

from jausml.live.machine.programs import PROGRAMS

ROOT = Path(__file__).resolve().parents[2]

CASES = """
import needs, pytest

@pytest.fixture
def shell():
    needs.ask("zsh")

@pytest.fixture
def never():
    raise AssertionError("made in vain")

@pytest.mark.needs("bash", "tshark")
def test_marked(never): pass

def test_that_asks(shell): pass

@pytest.mark.needs("wings")
def test_of_an_unknown_need(): pass

@pytest.mark.beside("golden/none.jsonl")
def test_beside(never): pass

def test_that_needs_nothing(): pass
"""
MODULE = """
import needs
needs.ask("rclpy")
import rclpy
"""


PLUGINS = {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1", "PYTEST_PLUGINS": "xdist.plugin,pytest_timeout"}
"""Others are half of what it takes to begin."""


@pytest.fixture
def run(tmp_path):
    """Runs tests of their own; returns what pytest prints."""
    found = f"{ROOT / 'tests' / 'support'} {ROOT / 'tools'}"
    settings = f"[pytest]\npythonpath = {found}\nmarkers =\n  needs\n  beside\n"
    (tmp_path / "pytest.ini").write_text(settings, encoding="utf-8")

    def run_(text, *options, **environment):
        (tmp_path / "test_cases.py").write_text(text, encoding="utf-8")
        plugins = ("-p", "needs", "-p", "expected_skips", f"--basetemp={tmp_path / 'kept'}")
        return ran(
            [sys.executable, "-m", "pytest", *plugins, *options],
            cwd=tmp_path,
            env={**os.environ, **PLUGINS, **environment},
        )

    return run_


@pytest.fixture
def without_programs(tmp_path):
    """A PATH with a shell alone."""
    folder = tmp_path / "programs"
    folder.mkdir()
    (folder / "bash").symlink_to("/bin/sh")
    return str(folder)


def test_what_is_missing_is_skipped_with_its_cure(run, without_programs, tmp_path):
    done = run(CASES, PATH=without_programs, JAUSML_SHARED=str(tmp_path))
    assert "1 passed, 3 skipped, 1 error" in done.stdout, done.stdout
    assert "1 skipped: needs tshark: apt install tshark\n" in done.stdout
    assert "1 skipped: needs zsh: apt install zsh\n" in done.stdout
    assert "1 skipped: needs shared/golden/none.jsonl beside the checkout\n" in done.stdout
    assert "'wings' is no need that tests/support/needs.py knows" in done.stdout


@pytest.mark.slow
def test_a_module_is_not_imported_further_and_says_what_its_package_said(run, tmp_path):
    (tmp_path / "rclpy.py").write_text("import half_of_it", encoding="utf-8")
    done = run(MODULE, PYTHONPATH=str(tmp_path))
    reason = "needs rclpy: pip install --editable '.[ros]' (No module named 'half_of_it')"
    assert f"1 skipped: {reason}\n" in done.stdout, done.stdout


@pytest.mark.slow
def test_what_stands_beside_is_chosen_and_found(run, tmp_path):
    (tmp_path / "golden").mkdir()
    (tmp_path / "golden" / "none.jsonl").touch()
    done = run(CASES.replace("(never)", "()"), "-m", "beside", JAUSML_SHARED=str(tmp_path))
    assert "1 passed, 4 deselected" in done.stdout, done.stdout


@for_each("name", sorted(needs.NEEDS))
def test_each_need_is_met_or_says_how(name):
    cure = needs.missing(name)
    assert not cure or cure.startswith(("apt install ", "pip install ", "make ", "run "))


def test_users_are_told_the_same_packages(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CXX", raising=False)
    for program in PROGRAMS:
        assert needs.NEEDS[program.name]() == program.cure


def test_nothing_else_asks_for_packages():
    asking = re.compile(r"import" r"orskip\(|skipif\([^)]*(?:which|find_spec|compiler)\(")
    found = [
        path.relative_to(ROOT).as_posix()
        for path in sorted((ROOT / "tests").rglob("*.py"))
        if asking.search(path.read_text(encoding="utf-8"))
    ]
    assert found == []


# -- skips that are expected -----------------------------------------------------------------------

SKIPS = """
import pytest

def test_one(): pytest.skip("no colour here: red")
def test_two(): pytest.skip("no colour here: blue")
def test_three(): pytest.skip("nobody has run it")
"""


EXPECTED = [
    (["2 | no colour here | printed", "1 | nobody | later"], []),
    (
        ["1 | no colour here | printed", "9 | nobody | later"],
        ["2 skipped, at most 1 may be: no colour here"],
    ),
    (["# none", "", "2 | no colour here | printed"], ["1 skipped: nobody has run it"]),
    (
        ["2 | no colour | a", "0 | no colour here: red | b", "1 | nobody | c"],
        ["1 skipped, at most 0 may be: no colour here: red"],
    ),
]


@pytest.mark.parametrize(
    ("lines", "told", "workers"),
    sweep([*((*case, ()) for case in EXPECTED), (*EXPECTED[1], ("-n", "2"))], every=3),
)
def test_skips_that_are_not_expected_fail_a_run(run, tmp_path, lines, told, workers):
    (tmp_path / "expected.txt").write_text("\n".join(lines), encoding="utf-8")
    done = run(SKIPS, "--expected-skips", "expected.txt", *workers)
    found = [line for line in done.stdout.splitlines() if line.startswith("not expected: ")]
    assert done.returncode == bool(told)
    assert found == [f"not expected: {skip_reason}" for skip_reason in told]
    assert "1 skipped: nobody has run it\n" in done.stdout


@pytest.mark.slow
def test_without_the_option_any_skip_is_fine(run):
    done = run(SKIPS)
    assert (done.returncode, "not expected" in done.stdout) == (0, False)


@pytest.mark.slow
@pytest.mark.parametrize("line", sweep(["many | reason | why", "1 | reason", "1 | | why"], every=3))
def test_a_line_that_is_no_allowance_is_a_usage_error(run, tmp_path, line):
    (tmp_path / "expected.txt").write_text(f"# first\n{line}\n", encoding="utf-8")
    done = run(SKIPS, "--expected-skips", "expected.txt")
    assert done.returncode == pytest.ExitCode.USAGE_ERROR
    assert "expected.txt: line 2 is not MOST | REASON | WHY" in done.stderr


@pytest.mark.slow
def test_the_file_of_the_project_is_one(run):
    done = run("", "--expected-skips", str(ROOT / "tests" / "expected_skips.txt"))
    assert done.returncode == pytest.ExitCode.NO_TESTS_COLLECTED, done.stderr
