"""Answers are remembered while somebody says that nothing changes, and not a moment longer."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import pytest

from jausml.language.semantics.memory import remembered, remembering


class Counting:
    """A function that counts how often it works."""

    def __init__(self) -> None:
        self.count = 0

        @remembered
        def double(number: int) -> int:
            self.count += 1
            return 2 * number

        self.double = double


def test_each_answer_is_worked_out_once_within():
    asked = Counting()
    with remembering():
        assert [asked.double(each) for each in (1, 2, 1, 2)] == [2, 4, 2, 4]
    assert asked.count == 2


def test_nothing_is_remembered_outside():
    asked = Counting()
    with remembering():
        asked.double(1)
    asked.double(1)
    asked.double(1)
    with remembering():
        asked.double(1)
    assert asked.count == 4


def test_an_error_ends_it_too():
    asked = Counting()
    with pytest.raises(KeyError), remembering():
        raise KeyError
    asked.double(1)
    asked.double(1)
    assert asked.count == 2


def test_other_threads_do_not_notice():
    asked = Counting()
    with remembering(), ThreadPoolExecutor(1) as threads:
        asked.double(1)
        assert threads.submit(asked.double, 1).result() == 2
        assert threads.submit(asked.double, 1).result() == 2
    assert asked.count == 3
