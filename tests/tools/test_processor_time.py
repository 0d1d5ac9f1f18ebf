"""What tests cost is told by files, and a table that is wrong fails the run that judges it."""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import processor_time
import pytest
import warm
from for_each import for_each

GUARDS = ("CONTRIBUTING.md",)

ROOT = Path(__file__).resolve().parents[2]
PAGE = """
| file | CPU s | why |
|---|---|---|
| `live/test_cheap.py` | {seconds} | it would be dear |
"""
TEST = """
def test_it():
    assert sum(range(1000))
"""


def test_the_table_is_read():
    text = "| file | s | why |\n|---|---|---|\n| `live/test_demo.py` | 16 | drives |\n"
    assert processor_time.table(text) == {"live/test_demo.py": 16}


def test_the_table_of_the_project_names_files_that_are_there():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    listed = processor_time.table(text)
    assert listed
    assert [file for file in listed if not (ROOT / "tests" / file).is_file()] == []


@for_each(
    ("listed", "spent", "found"),
    [
        ({}, {"a.py": 24.0}, []),
        ({}, {"a.py": 26.0}, ["a.py takes 26 s and is not listed"]),
        ({"a.py": 20}, {"a.py": 10.5}, []),
        ({"a.py": 20}, {"a.py": 9.0}, ["a.py takes 9 s, and 20 s are listed"]),
        ({"a.py": 20}, {"a.py": 39.0}, []),
        ({"a.py": 20}, {"a.py": 41.0}, ["a.py takes 41 s, and 20 s are listed"]),
        ({"a.py": 20}, {}, ["a.py takes 0 s, and 20 s are listed"]),
    ],
)
def test_what_is_wrong_by_more_than_half_is_told(listed, spent, found):
    assert processor_time.differences(listed, spent, spent) == found


def test_after_an_earlier_run_a_file_may_take_less():
    assert processor_time.differences({"a.py": 20}, {"a.py": 1.0}, None) == []
    assert processor_time.differences({"a.py": 20}, {"a.py": 41.0}, None)


def test_where_a_slow_test_came_first_the_others_may_take_less():
    assert processor_time.differences({"a.py": 20}, {"a.py": 1.0}, {"a.py": 11.0}) == []
    assert processor_time.differences({"a.py": 20}, {"a.py": 1.0}, {"a.py": 9.0})
    assert processor_time.differences({}, {"a.py": 1.0}, {"a.py": 90.0}) == []


def test_seconds_are_those_of_the_computer_of_the_table():
    own = 2 * processor_time.WORK_SECONDS
    assert processor_time.scaled({"a.py": 30.0}, own) == {"a.py": pytest.approx(15.0)}


def test_commands_of_the_warm_process_are_counted():
    before = warm.seconds()
    subprocess.run([*warm.command(), "list", "maps"], check=True, capture_output=True)
    end = time.monotonic() + 60
    while warm.seconds() <= before:  # its process is let go of a moment after its end is told
        assert time.monotonic() < end
        time.sleep(0.01)


@pytest.mark.slow
@pytest.mark.parametrize(("seconds", "status"), [(12, 1), (0, 0)])
def test_a_run_fails_by_its_table_alone(tmp_path, seconds, status):
    (tmp_path / "support").mkdir()
    for name in ("processor_time.py", "warm.py", "isolation.py"):
        shutil.copy(ROOT / "tests" / "support" / name, tmp_path / "support")
    (tmp_path / "test_cheap.py").write_text(TEST, encoding="utf-8")
    page = PAGE.format(seconds=seconds) if seconds else ""
    (tmp_path.parent / "CONTRIBUTING.md").write_text(page, encoding="utf-8")
    environment = {
        **os.environ,
        "PYTHONPATH": str(tmp_path / "support"),
        "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",
    }
    command = [sys.executable, "-m", "pytest", "-p", "processor_time", "--judge-budget"]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert "1 passed" in done.stdout, done.stdout + done.stderr
    assert done.returncode == status
    told = "CONTRIBUTING.md: live/test_cheap.py takes 0 s, and 12 s are listed"
    assert (told in done.stdout) == bool(status)
