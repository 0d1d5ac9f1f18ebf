"""Answers are remembered while somebody says that nothing changes, and not a moment longer."""

from concurrent.futures import ThreadPoolExecutor

import pytest

from jausml.language import wire
from jausml.language.metamodel.classes import jaus
from jausml.language.semantics.jaus.services import signature
from jausml.language.semantics.subject import remembered, remembering


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
        assert [asked.double(number) for number in (1, 2, 1, 2)] == [2, 4, 2, 4]
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


def test_the_layouts_of_two_messages_are_compared_without_resolving_them_again(monkeypatch):
    message = jaus.MessageDef()
    message.name, message.code = "ReportThing", "4D00"
    resolved = []
    resolve = wire.resolve
    monkeypatch.setattr(
        wire, "resolve", lambda definition: (resolved.append(definition), resolve(definition))[1]
    )
    with remembering():
        assert signature(message) == signature(message)
    assert resolved == [message]
