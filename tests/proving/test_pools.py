"""Pieces of work: the processes of a pool come to the results that are asked of them."""

import functools
import operator
import os
import tempfile
from pathlib import Path

import pytest

from jausml.language.attributes.units import parse_unit
from jausml.live.workers.pool import PoolError, work_on
from jausml.live.workers.worker import BridgeCode, Worker, WorkerError

GUARDS = ("jausml/live/workers", "jausml/proving/running.py", "jausml/mutating/running.py")


def test_results_are_those_of_their_pieces():
    pieces = [(number, number * number) for number in range(20)]
    found = dict(work_on(pieces, 3, operator.itemgetter, 1))
    assert found == {number: number * number for number in range(20)}


def test_what_a_worker_raises_is_raised():
    with pytest.raises(IndexError):
        list(work_on([(1, 2), ()], 1, operator.itemgetter, 1))


def test_an_error_that_cannot_be_made_of_its_text_is_told_by_it():
    with pytest.raises(RuntimeError, match="UnitError: 'parsec'"):
        list(work_on(["parsec"], 1, functools.partial, parse_unit))


def test_a_process_that_ends_is_told():
    with pytest.raises(PoolError, match="has ended"):
        list(work_on([3, 3], 2, functools.partial, os._exit))


def test_what_is_left_in_folders_is_removed():
    results = work_on([".a", ".b", ".c"], 1, functools.partial, tempfile.mkdtemp)
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
