"""Pieces of work: the processes of a pool come to the results that are asked of them."""

import functools
import operator
import os
import tempfile
from pathlib import Path

import pytest

from jausml.language.attributes.units import parse_unit
from jausml.live.workers.pool import PoolError, Work
from jausml.live.workers.worker import BridgeCode, Worker, WorkerError

GUARDS = ("jausml/live/workers", "jausml/proving/running.py", "jausml/mutating/running.py")


def test_results_are_those_of_their_pieces():
    work = Work(operator.itemgetter, 1)
    found = dict(work.results([(number, number * number) for number in range(20)], jobs=3))
    assert found == {number: number * number for number in range(20)}


def test_what_a_worker_raises_is_raised():
    with pytest.raises(IndexError):
        list(Work(operator.itemgetter, 1).results([(1, 2), ()], jobs=1))


def test_an_error_that_cannot_be_made_of_its_text_is_told_by_it():
    with pytest.raises(RuntimeError, match="UnitError: 'parsec'"):
        list(Work(functools.partial, parse_unit).results(["parsec"], jobs=1))


def test_a_process_that_ends_is_told():
    work = Work(functools.partial, os._exit)
    with pytest.raises(PoolError, match="has ended"):
        list(work.results([3, 3], jobs=2))


def test_what_is_left_in_folders_is_removed():
    work = Work(functools.partial, tempfile.mkdtemp)
    results = work.results([".a", ".b", ".c"], jobs=1)
    _, first = next(results)
    assert Path(first).is_dir()
    results.close()  # as a campaign that is ended early does
    assert not Path(first).parent.exists()


def test_a_worker_that_ends_in_its_answer_is_told(tmp_path):
    script = tmp_path / "script.py"
    script.write_text('input(); print(\'{"half": 1\', end="")\n')
    worker = Worker(BridgeCode({"a/a/a.py": ""}, ""), script)
    with pytest.raises(WorkerError, match="its process has ended"):
        worker.ask({}, 30)
    worker.close()
