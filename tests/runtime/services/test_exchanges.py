"""Exchanges: answers, silence, turns of those that may have the same answer."""

from __future__ import annotations

import pytest

from jausml.runtime.base.address import JausAddress
from jausml.runtime.clients.exchanges import ATTEMPTS, Exchanges
from jausml.runtime.messages import (
    QueryStatus,
    QueryTimeout,
    ReportStatus,
    ReportTimeout,
    SetTime,
)

PEER = JausAddress(1, 1, 1)
OTHER = JausAddress(1, 1, 2)
TIMEOUT = 3.0


class Asker:
    """A component that asks.

    Attributes:
        ends: What each exchange ended with, in order: its name and the answer.
    """

    def __init__(self, world):
        self.component = world.component("2.1.1", services=())
        self.component.start()
        self.exchanges = Exchanges(self.component)
        self.exchanges.listen([ReportStatus, ReportTimeout])
        self.ends = []

    def ask(self, name, query, answer, *, target=PEER, is_query=True):
        return self.exchanges.ask(
            target,
            query.encode(),
            [answer],
            lambda payload: self.ends.append((name, payload)),
            timeout=TIMEOUT,
            is_query=is_query,
        )


@pytest.fixture
def asker(world):
    return Asker(world)


@pytest.fixture
def peer(world):
    return world.probe(str(PEER), strict=False)


def answer(world, asker, message, *, source=PEER):
    payload = message.encode()
    world.send(source, asker.component.address, payload)
    world.settle()
    return payload


@pytest.mark.usefixtures("peer")
class TestExchanges:
    def test_answer_ends_it_once(self, world, asker):
        asker.ask("status", QueryStatus(), ReportStatus)
        payload = answer(world, asker, ReportStatus())
        answer(world, asker, ReportStatus())
        world.run(2 * TIMEOUT, step=0.1)
        assert asker.ends == [("status", payload)]
        assert world.count(QueryStatus.CODE) == 1

    def test_answer_of_somebody_else_is_none(self, world, asker):
        world.probe(str(OTHER), strict=False)
        asker.ask("status", QueryStatus(), ReportStatus)
        answer(world, asker, ReportStatus(), source=OTHER)
        assert asker.ends == []

    @pytest.mark.parametrize(("is_query", "sent"), [(True, ATTEMPTS), (False, 1)])
    def test_silence_ends_it_and_queries_alone_are_repeated(self, world, asker, is_query, sent):
        asker.ask("status", QueryStatus(), ReportStatus, is_query=is_query)
        world.run(TIMEOUT - 0.1, step=0.05)
        assert asker.ends == []
        world.run(10 * TIMEOUT, step=0.5)
        assert asker.ends == [("status", None)]
        assert world.count(QueryStatus.CODE) == sent

    def test_those_with_the_same_answer_take_turns(self, world, asker):
        asker.ask("first", QueryStatus(), ReportStatus)
        asker.ask("second", QueryStatus(), ReportStatus)
        asker.ask("other", QueryTimeout(), ReportTimeout)
        world.settle()
        assert world.count(QueryStatus.CODE) == 1
        assert world.count(QueryTimeout.CODE) == 1
        one = answer(world, asker, ReportStatus(status=1))
        assert world.count(QueryStatus.CODE) == 2
        two = answer(world, asker, ReportStatus(status=2))
        assert asker.ends == [("first", one), ("second", two)]

    def test_a_late_answer_is_taken_for_that_of_the_next(self, world, asker):
        """Nothing in messages of JAUS tells them apart; docs/how-to/services.md says so."""
        asker.ask("first", QueryStatus(), ReportStatus)
        world.run(TIMEOUT + 0.1, step=0.05)
        answer(world, asker, ReportStatus(status=1))
        assert asker.ends == [("first", None)]
        asker.ask("second", QueryStatus(), ReportStatus)
        late = answer(world, asker, ReportStatus(status=2))
        assert asker.ends[1:] == [("second", late)]

    def test_one_that_is_forgotten_lets_the_next_go_on(self, world, asker):
        forget = asker.ask("first", QueryStatus(), ReportStatus)
        asker.ask("second", QueryStatus(), ReportStatus)
        forget()
        forget()
        world.settle()
        payload = answer(world, asker, ReportStatus())
        world.run(2 * TIMEOUT, step=0.1)
        assert asker.ends == [("second", payload)]

    def test_time_runs_while_it_waits_for_its_turn(self, world, asker):
        asker.ask("first", QueryStatus(), ReportStatus)
        asker.ask("second", SetTime(), ReportStatus, is_query=False)
        world.run(TIMEOUT + 0.1, step=0.05)
        assert asker.ends == [("first", None), ("second", None)]
        assert world.count(SetTime.CODE) == 0
