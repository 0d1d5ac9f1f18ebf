"""Pieces of work: processes of this machine and workers of Dask come to the same results."""

from __future__ import annotations

import functools
import json
import operator
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import needs
import pytest

from jausml import installing
from jausml.live.workers.pool import Work
from jausml.live.workers.pool_processes import PoolError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

GUARDS = ("jausml/live/workers", "jausml/proving/running.py", "jausml/mutating/running.py")
WINCH = Path(__file__).resolve().parents[2] / "models" / "examples" / "winch" / "winch.xmi"


def test_results_are_those_of_their_pieces() -> None:
    work = Work(operator.itemgetter, 1)
    found = dict(work.results([(each, each * each) for each in range(20)], jobs=3))
    assert found == {each: each * each for each in range(20)}


def test_what_a_worker_raises_is_raised() -> None:
    with pytest.raises(IndexError):
        list(Work(operator.itemgetter, 1).results([(1, 2), ()], jobs=1))


def test_a_process_that_ends_is_told() -> None:
    work = Work(functools.partial, os._exit)
    with pytest.raises(PoolError, match="has ended"):
        list(work.results([3, 3], jobs=2))


def test_what_is_left_in_folders_is_removed() -> None:
    work = Work(functools.partial, tempfile.mkdtemp)
    results = work.results([".a", ".b", ".c"], jobs=1)
    _, first = next(results)
    assert Path(first).is_dir()
    results.close()  # as a campaign that is ended early does
    assert not Path(first).parent.exists()


@pytest.mark.slow
def test_nobody_at_the_address_is_told(tmp_path: Path) -> None:
    done = run("prove", some_maps(tmp_path), "--scheduler", "nonsense://nowhere")
    assert done.returncode == 2
    assert done.stderr.startswith("Error: ")
    assert len(done.stderr.splitlines()) == 1
    assert "nonsense://nowhere" in done.stderr or "jausml[dask]" in done.stderr


def test_without_the_extra_it_is_named(tmp_path: Path) -> None:
    hidden = tmp_path / "hidden"
    hidden.mkdir()
    (hidden / "distributed.py").write_text("raise ModuleNotFoundError('distributed')\n")
    done = run(
        "mutate", WINCH, "--limit", 1, "--scheduler", "tcp://127.0.0.1:9", PYTHONPATH=str(hidden)
    )
    assert done.returncode == 2
    assert done.stderr.splitlines() == [
        f"Error: a scheduler of Dask needs the extra `dask`: {installing.command('dask')}"
    ]


# -- Dask ----------------------------------------------------------------------------------------


class Engine(NamedTuple):
    """A scheduler of Dask with two workers."""

    address: str
    workers: list[subprocess.Popen[bytes]]
    folders: list[Path]


@pytest.fixture(scope="module")
def engine(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Engine]:
    """An engine for all tests, of which the last one may leave less than there was."""
    folder = tmp_path_factory.mktemp("engine")
    file = folder / "scheduler.json"
    begun = [dask("scheduler", folder, "--port", "0", "--scheduler-file", file)]
    try:
        assert wait_for(file.exists)
        folders = [folder / "one", folder / "two"]
        for each in folders:
            each.mkdir()
            options = ("--no-nanny", "--nthreads", "1", "--scheduler-file", file)
            begun.append(dask("worker", each, *options))
        yield Engine(json.loads(file.read_text())["address"], begun[1:], folders)
    finally:
        for process in reversed(begun):  # a worker waits long for a scheduler that is gone
            process.terminate()
            if not wait_for(lambda process=process: process.poll() is not None):
                process.kill()
                process.wait()


def dask(verb: str, folder: Path, *options: object) -> subprocess.Popen[bytes]:
    """Begins a process of Dask whose temporary files are in a folder.

    It has the compiler itself (`compile_once`): what is killed in the middle of it takes its time.
    """
    line = [sys.executable, "-m", "dask", verb, "--host", "127.0.0.1", "--no-dashboard"]
    environment = {name: each for name, each in os.environ.items() if name != "CXX"}
    # Else each worker looks at its own stack a hundred times a second.
    environment["DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED"] = "False"
    with (folder / f"{verb}.log").open("wb") as log:
        return subprocess.Popen(
            [*line, *map(str, options)],
            cwd=folder,
            env={**environment, "TMPDIR": str(folder)},
            stdout=log,
            stderr=log,
        )


def wait_for(is_so: Callable[[], object]) -> bool:
    """Waits for a condition, a minute at most."""
    until = time.monotonic() + 60
    while not is_so():
        if time.monotonic() > until:
            return False
        time.sleep(0.02)
    return True


def some_maps(folder: Path) -> Path:
    """A model with three maps."""
    path = folder / "speeds.ros2jaus"
    maps = (
        f"speed_{each} {{ JAUS GlobalWaypointDriver.ReportTravelSpeed"
        " ROS ackermann_msgs/AckermannDrive"
        f" JAUS->ROS ( Speed -> speed : scale({each}) )"
        " ROS->JAUS ( speed -> Speed : scale(0.5) ) }\n"
        for each in range(1, 4)
    )
    path.write_text("import jaus.mobility\n" + "".join(maps))
    return path


def command(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "jausml", *map(str, arguments)]


def run(*arguments: object, **more: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command(*arguments),
        env={**os.environ, **more},
        capture_output=True,
        text=True,
        timeout=240,
    )


def without_times(text: str) -> Any:
    found = json.loads(text)
    for each in found["maps"]:
        del each["seconds"]
        for one in each["fields"]:
            del one["needs"]
    return found


@pytest.mark.live
@pytest.mark.slow
@pytest.mark.timeout(400)
def test_mutations_are_the_same(engine: Engine) -> None:
    needs.ask("rclpy")
    asked = ("mutate", WINCH, "--only", "figure", "--limit", 2, "--format", "json")
    done = run(*asked, "--scheduler", engine.address)
    assert done.returncode in (0, 1), done.stderr
    assert json.loads(done.stdout)["tried"] == 2
    assert json.loads(done.stdout) == json.loads(run(*asked).stdout)


@pytest.mark.live
@pytest.mark.slow
@pytest.mark.timeout(400)
@pytest.mark.needs("compiler")
def test_proofs_are_the_same_though_a_worker_is_killed(tmp_path: Path, engine: Engine) -> None:
    asked = ("prove", some_maps(tmp_path), "--budget", "0.01", "--no-cache", "--format", "json")
    with subprocess.Popen(
        command(*asked, "--scheduler", engine.address), stdout=subprocess.PIPE, text=True
    ) as proving:
        # Each of them is in the middle of a proof.
        assert wait_for(
            lambda: all(any(e.glob("jausml_pool_*/jausml_proof_*")) for e in engine.folders)
        )
        os.kill(engine.workers[0].pid, signal.SIGKILL)
        told, _ = proving.communicate(timeout=240)
    assert proving.returncode == 1  # of three pairs of factors one is right
    assert engine.workers[0].wait(timeout=60) == -signal.SIGKILL
    found = without_times(told)
    assert found == without_times(run(*asked).stdout)
    assert [each["name"] for each in found["maps"]] == [f"speed_{each}" for each in range(1, 4)]
    assert [bool(each["found"]) for each in found["maps"]] == [True, False, True]
    # Nothing of the work stays, not even of the worker that is killed.
    assert wait_for(lambda: not [each for one in engine.folders for each in one.glob("jausml_*")])
