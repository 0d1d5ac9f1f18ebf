"""The fuzz driver, as a process."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent

FINDS = """
def seeds():
    return [b"good"]

def one_input(data):
    assert b"d" in data or not data.startswith(b"goo"), "found"
"""

GROWS = """
KEPT = []

def one_input(data):
    KEPT.append(bytes(100_000 if len(KEPT) > 300 else 0) + data)
"""


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, str(folder / "run.py"), *arguments],
        capture_output=True,
        text=True,
        timeout=120,
    )


@pytest.fixture
def driver(tmp_path: Path) -> Path:
    """A copy of the driver with targets of its own."""
    (tmp_path / "targets").mkdir()
    (tmp_path / "run.py").write_bytes((HERE / "run.py").read_bytes())
    (tmp_path / "targets" / "finds.py").write_text(FINDS)
    (tmp_path / "targets" / "grows.py").write_text(GROWS)
    return tmp_path


def test_datagrams_raise_nothing_pile_up_nothing_and_are_all_counted():
    done = run(HERE, "datagrams", "--plain", "--runs", "5000", "--seed", "7")
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.startswith("5000 inputs in ")
    for end in ("delivered", "judp.truncated=", "transport.duplicate=", "transport.reassembled="):
        assert end in done.stdout


def test_streams_are_read_the_same_however_they_are_cut():
    done = run(HERE, "streams", "--plain", "--runs", "2000", "--seed", "5")
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.slow
def test_components_contradict_themselves_in_nothing_and_end_when_they_are_stopped():
    done = run(HERE, "components", "--plain", "--runs", "500", "--seed", "3")
    assert done.returncode == 0, done.stdout + done.stderr
    for name in ("messages sent", "access_control.timed_out=", "management.clear_ignored="):
        assert name in done.stdout


@pytest.mark.slow
def test_bodies_are_refused_or_go_out_as_they_came():
    done = run(HERE, "bodies", "--plain", "--runs", "5000", "--seed", "7")
    counts = r"(\d+) messages: (\d+) refused, (\d+) taken but not sent, (\d+) sent again"
    report = re.search(counts, done.stdout)
    assert report is not None, done.stdout + done.stderr
    messages, *outcomes = map(int, report.groups())
    assert messages > 300
    assert sum(outcomes) == 5_000
    assert min(outcomes) > 0


@pytest.mark.slow
def test_a_run_can_be_repeated():
    reports = [
        run(HERE, "datagrams", "--plain", "--runs", "500", "--seed", seed).stdout.splitlines()[1:]
        for seed in ("3", "3", "4")
    ]
    assert reports[0] == reports[1] != reports[2]


def test_an_input_that_raises_is_kept_and_told(driver):
    done = run(driver, "finds", "--plain", "--runs", "10000")
    assert done.returncode == 1
    assert "AssertionError: found" in done.stderr
    (kept,) = driver.glob("found-*")
    data = kept.read_bytes()
    assert data.startswith(b"goo")
    assert b"d" not in data
    assert data.hex() in done.stdout


def test_growing_memory_is_an_error(driver):
    done = run(driver, "grows", "--plain", "--runs", "1400", "--growth", "20")
    assert done.returncode == 1
    assert "memory grew by more than 20 MiB" in done.stdout


def test_a_duration_ends_a_run(driver):
    done = run(driver, "grows", "--plain", "--seconds", "0.05", "--growth", "100000")
    assert done.returncode == 0, done.stdout + done.stderr


def test_an_unknown_target_is_a_usage_error_with_a_suggestion():
    done = run(HERE, "datagram")
    assert done.returncode == 2
    assert "did you mean datagrams?" in done.stderr


@pytest.mark.needs("atheris")
def test_a_run_guided_by_coverage(driver):
    """Of a target of its own: to instrument the runtime takes seconds, which `make fuzz` does."""
    found = run(driver, "finds", "--runs", "200000")
    assert found.returncode not in (0, 2)
    assert "stat::number_of_executed_units: " in found.stderr
    assert list(driver.glob("found-*"))
