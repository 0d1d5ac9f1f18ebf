"""Answers are worked out again only when what they read has changed, however long the chain."""

from __future__ import annotations

import pytest

from jausml.language.metamodel.reactive import Answers, Engine, SelfAskingError, Watch


class Chain:
    """Answers each of which asks for the one before; the first one reads a value."""

    def __init__(self):
        self.engine = Engine()
        self.watch = Watch(self.engine)
        self.value = 1

    def answer(self, number):
        if number == 0:
            self.watch.note("value")
            return self.value
        return self.engine.ask((self.answer, number - 1))

    def sign(self, number):
        return self.engine.ask((self.answer, number)) > 0

    def told(self, number):
        return str(self.engine.ask((self.sign, number)))

    def ring(self, number):
        return self.engine.ask((self.ring, (number + 1) % 3))

    def change(self, value):
        self.value = value
        self.watch.touch("value")


def test_a_long_chain_is_followed_without_recursion():
    chain = Chain()
    for number in range(20_000):  # from the first one on: each finds the one before
        chain.engine.ask((chain.answer, number))
    runs = chain.engine.runs
    chain.change(2)
    assert chain.engine.ask((chain.answer, 19_999)) == 2
    assert chain.engine.runs == runs + 20_000


def test_an_equal_answer_ends_the_wave():
    chain = Chain()
    root = chain.engine.keep((chain.told, 0))
    assert [chain.engine.ask(each.call) for each in chain.engine.woken()] == ["True"]
    runs = chain.engine.runs
    chain.change(2)
    assert list(chain.engine.woken()) == [root]
    assert chain.engine.ask(root.call) == "True"
    assert chain.engine.runs == runs + 2  # the value and its sign, and no more


def test_nothing_runs_where_nothing_has_changed():
    chain = Chain()
    chain.engine.keep((chain.sign, 3))
    for each in chain.engine.woken():
        chain.engine.ask(each.call)
    runs = chain.engine.runs
    chain.watch.touch("another value")
    assert list(chain.engine.woken()) == []
    assert chain.engine.runs == runs


@pytest.mark.parametrize("kind", [Engine, Answers])
def test_an_answer_that_asks_for_itself_is_an_error_that_names_it(kind):
    chain = Chain()
    chain.engine = kind()
    for _ in range(2):
        with pytest.raises(SelfAskingError, match=r"Chain\.ring asks for its own answer"):
            chain.engine.ask((chain.ring, 0))


def test_what_nobody_asks_for_any_more_is_forgotten():
    chain = Chain()
    root = chain.engine.keep((chain.answer, 50))
    chain.engine.ask(root.call)
    assert len(chain.engine) == 51
    chain.engine.drop(root)
    chain.engine.sweep()
    assert len(chain.engine) == 0
