"""Exchanges: answers, silence, turns of those that may have the same answer."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jausml.runtime.base.address import JausAddress
from jausml.runtime.clients.exchanges import ATTEMPTS, LATEST, Exchanges, Unanswered
from jausml.runtime.messages import (
    QueryStatus,
    QueryTimeout,
    ReportStatus,
    ReportTimeout,
    RequestControl,
    SetTime,
)

from .conftest import World

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
        assert asker.ends == [("status", Unanswered.SILENT)]
        assert world.count(QueryStatus.CODE) == sent

    @pytest.mark.parametrize("is_query", [True, False])
    @pytest.mark.parametrize("ends_by", ["silence", "being forgotten", "its answer"])
    def test_a_command_without_an_answer_is_not_executed_later(
        self, world, asker, is_query, ends_by
    ):
        forget = asker.ask("time", SetTime(), ReportStatus, is_query=is_query)
        if ends_by == "silence":
            world.run(TIMEOUT + 0.1, step=0.05)
        elif ends_by == "being forgotten":
            forget()
        else:
            answer(world, asker, ReportStatus())
        is_withdrawn = not is_query and ends_by != "its answer"
        command = asker.component.address, PEER, SetTime().encode()
        assert world.withdrawn == [command] * is_withdrawn

    def test_a_command_that_was_not_sent_is_not_withdrawn(self, world, asker):
        asker.ask("first", QueryStatus(), ReportStatus)
        asker.ask("second", SetTime(), ReportStatus, is_query=False)()
        assert world.withdrawn == []

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

    def test_a_late_answer_is_not_taken_for_that_of_the_next(self, world, asker):
        asker.ask("first", SetTime(), ReportStatus, is_query=False)
        world.run(TIMEOUT + 0.1, step=0.05)
        assert asker.ends == [("first", Unanswered.SILENT)]
        asker.ask("second", SetTime(), ReportStatus, is_query=False)
        world.run(1.0, step=0.05)
        assert world.count(SetTime.CODE) == 1
        answer(world, asker, ReportStatus(status=1))
        assert world.counters.snapshot()["exchanges.late_answer"] == 1
        assert world.count(SetTime.CODE) == 2
        second = answer(world, asker, ReportStatus(status=2))
        assert asker.ends[1:] == [("second", second)]

    def test_what_is_owed_is_waited_for_and_no_longer_than_a_stated_time(self, world, asker):
        asker.ask("first", SetTime(), ReportStatus, is_query=False)
        world.run(TIMEOUT + 0.5, step=0.05)
        for _ in range(LATEST - 1):
            asker.ask("refused", QueryStatus(), ReportStatus)
            world.run(TIMEOUT, step=0.05)
        asker.ask("second", QueryStatus(), ReportStatus)
        world.run(TIMEOUT - 0.6, step=0.05)
        assert world.count(QueryStatus.CODE) == 0
        world.run(0.2, step=0.05)
        assert world.count(QueryStatus.CODE) == 1
        payload = answer(world, asker, ReportStatus())
        assert asker.ends == [
            ("first", Unanswered.SILENT),
            *[("refused", Unanswered.UNSENT)] * (LATEST - 1),
            ("second", payload),
        ]

    def test_others_with_another_answer_do_not_wait(self, world, asker):
        asker.ask("first", SetTime(), ReportStatus, is_query=False)
        world.run(TIMEOUT + 0.1, step=0.05)
        asker.ask("other", QueryTimeout(), ReportTimeout)
        payload = answer(world, asker, ReportTimeout())
        assert asker.ends[1:] == [("other", payload)]

    def test_the_same_question_is_asked_again_soon(self, world, asker):
        asker.ask("first", QueryStatus(), ReportStatus)
        world.run(TIMEOUT + 0.1, step=0.05)
        asker.ask("second", QueryStatus(), ReportStatus)
        world.run(TIMEOUT - 0.2, step=0.05)
        assert world.count(QueryStatus.CODE) == ATTEMPTS
        world.run(0.2, step=0.05)
        assert world.count(QueryStatus.CODE) == ATTEMPTS + 1
        payload = answer(world, asker, ReportStatus())
        assert asker.ends == [("first", Unanswered.SILENT), ("second", payload)]

    def test_the_second_answer_to_a_repeated_query_is_none_to_a_command(self, world, asker):
        asker.ask("query", QueryStatus(), ReportStatus)
        world.run(TIMEOUT / ATTEMPTS + 0.1, step=0.05)
        assert world.count(QueryStatus.CODE) == 2
        first = answer(world, asker, ReportStatus(status=1))
        asker.ask("command", SetTime(), ReportStatus, is_query=False)
        world.settle()
        answer(world, asker, ReportStatus(status=1))
        done = answer(world, asker, ReportStatus(status=2))
        assert asker.ends == [("query", first), ("command", done)]

    def test_one_that_is_forgotten_lets_the_next_go_on_after_its_answer(self, world, asker):
        forget = asker.ask("first", QueryStatus(), ReportStatus)
        forget_unsent = asker.ask("never", QueryStatus(), ReportStatus)
        asker.ask("second", SetTime(), ReportStatus, is_query=False)
        for end in (forget, forget, forget_unsent):
            end()
        answer(world, asker, ReportStatus(status=1))
        payload = answer(world, asker, ReportStatus(status=2))
        world.run(2 * TIMEOUT, step=0.1)
        assert asker.ends == [("second", payload)]

    def test_nobody_is_said_to_be_silent_who_was_not_asked(self, world, asker):
        asker.ask("first", QueryStatus(), ReportStatus)
        asker.ask("second", SetTime(), ReportStatus, is_query=False)
        world.run(TIMEOUT + 0.1, step=0.05)
        assert asker.ends == [("first", Unanswered.SILENT), ("second", Unanswered.UNSENT)]
        assert world.count(SetTime.CODE) == 0

    def test_the_time_of_the_answer_begins_when_it_is_asked_for(self, world, asker):
        asker.ask("first", SetTime(), ReportStatus, is_query=False)
        asker.ask("second", SetTime(), ReportStatus, is_query=False)
        world.run(TIMEOUT - 0.1, step=0.05)
        answer(world, asker, ReportStatus())
        world.run(TIMEOUT - 0.1, step=0.05)
        second = answer(world, asker, ReportStatus(status=2))
        assert asker.ends[1:] == [("second", second)]


class SlowPeer:
    """Answers each command with its own number, each as late as it is told."""

    def __init__(self, world, delays):
        self._world = world
        self._delays = list(delays)
        world.attach(PEER, self._receive)

    def _receive(self, payload, source):
        number = RequestControl.decode(payload).authority_code
        delay = self._delays.pop(0)
        if delay is not None:
            self._world.loop.call_later(
                delay,
                lambda: self._world.send(PEER, source, ReportTimeout(timeout=number).encode()),
            )


DELAYS = st.none() | st.floats(0.0, (LATEST + 0.99) * TIMEOUT)
CALLS = st.lists(st.tuples(st.floats(0.0, 4 * TIMEOUT), DELAYS), min_size=2, max_size=12)


@given(CALLS)
def test_no_call_is_given_the_answer_to_another(calls):
    """However late answers are within the stated time, in whatever order calls are made."""
    world = World()
    SlowPeer(world, [delay for _, delay in calls])
    asker = Asker(world)
    for number, (pause, _) in enumerate(calls):
        command = RequestControl(authority_code=number)
        asker.ask(number, command, ReportTimeout, is_query=False)
        world.run(pause, step=0.25)
    world.run(3 * TIMEOUT, step=0.25)
    ended = dict(asker.ends)
    assert sorted(ended) == list(range(len(calls)))
    for number, ending in ended.items():
        if isinstance(ending, bytes):
            assert ReportTimeout.decode(ending).timeout == number
