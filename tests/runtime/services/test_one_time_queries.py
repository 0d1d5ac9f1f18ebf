"""One-time queries: answers, repetitions, failures and their end."""

import pytest

from jausml.runtime.base.address import JausAddress
from jausml.runtime.messages import QueryStatus, QueryTime, ReportStatus, ReportTime

TARGET = JausAddress(1, 1, 1)


def target(world, **settings):
    return world.started(str(TARGET), **settings)


class TestQuery:
    def test_answer(self, world, client):
        target(world)
        answers = []
        client.query(TARGET, QueryStatus(), ReportStatus, lambda *answer: answers.append(answer))
        world.settle()
        assert answers == [(ReportStatus(status=2, reserved=0), TARGET)]
        world.run(5.0)
        assert world.count(QueryStatus.CODE) == 1

    def test_failure(self, world, client):
        answers, failures = [], []
        client.query(
            TARGET,
            QueryStatus(),
            ReportStatus,
            lambda *answer: answers.append(answer),
            on_failure=lambda: failures.append(world.time),
            timeout=0.5,
            retries=2,
        )
        start = world.time
        world.run(10.0)
        assert world.count(QueryStatus.CODE) == 3
        assert failures == [pytest.approx(start + 1.5, abs=0.05)]
        target(world)
        client.send(QueryStatus(), TARGET)
        world.settle()
        assert answers == []

    def test_two_at_once(self, world, client):
        target(world)
        answers = []
        for number in range(2):
            client.query(
                TARGET, QueryStatus(), ReportStatus, lambda *_, n=number: answers.append(n)
            )
        world.settle()
        assert answers == [0, 1]

    def test_report_of_another_component_is_no_answer(self, world, client):
        answers = []
        client.query(TARGET, QueryStatus(), ReportStatus, lambda *answer: answers.append(answer))
        world.probe("3.1.1").ask(ReportStatus(status=1, reserved=0), client)
        assert answers == []

    def test_cancel(self, world, client):
        answers = []
        pending = client.query(TARGET, QueryStatus(), ReportStatus, lambda *_: answers.append(1))
        pending.cancel()
        target(world)
        world.run(5.0)
        assert answers == []
        assert world.count(QueryStatus.CODE) == 1

    def test_cancel_before_the_start(self, world):
        target(world)
        late = world.component("2.1.1", services=())
        answers = []
        late.query(TARGET, QueryStatus(), ReportStatus, lambda *_: answers.append(1)).cancel()
        late.start()
        world.run(3.0)
        assert answers == []
        assert world.count(QueryStatus.CODE) == 0

    def test_failure_of_one_cancels_another(self, world, client):
        failed, asked = [], []

        def fail():
            failed.append(world.time)
            asked[1].cancel()

        for _ in range(2):
            asked.append(
                client.query(TARGET, QueryStatus(), ReportStatus, print, retries=0, on_failure=fail)
            )
        world.run(5.0)
        assert len(failed) == 1
        assert world.counters.snapshot()["query_client.unanswered"] == 1

    def test_what_is_no_report_is_counted_and_the_query_repeated(self, world, client):
        answers = []
        client.query(TARGET, QueryStatus(), ReportStatus, lambda *answer: answers.append(answer))
        spoilt = ReportStatus(status=2, reserved=0).encode()[:-1]
        world.send(TARGET, client.address, spoilt)
        world.settle()
        assert "component.bad_message" in world.counters.drops()
        target(world)
        world.run(1.5)
        assert answers == [(ReportStatus(status=2, reserved=0), TARGET)]

    def test_queries_of_different_patience_fail_each_in_its_time(self, world, client):
        failed, start = [], world.time
        for seconds in (0.5, 0.2, 0.5):
            client.query(
                TARGET,
                QueryStatus(),
                ReportStatus,
                print,
                timeout=seconds,
                retries=1,
                on_failure=lambda: failed.append(world.time - start),
            )
        world.run(5.0)
        assert failed == [pytest.approx(delay, abs=0.05) for delay in (0.4, 1.0, 1.0)]

    def test_before_the_start(self, world):
        target(world)
        late = world.component("2.1.1", services=())
        answers = []
        late.query(TARGET, QueryStatus(), ReportStatus, lambda *_: answers.append(1))
        late.start()
        world.settle()
        assert answers == [1]


FULL = ReportTime(
    time_stamp=ReportTime.TimeStamp(minutes=7), date_stamp=ReportTime.DateStamp(month=3)
)


@pytest.fixture
def clock(world):
    component = world.component("1.1.1")
    component.provide(QueryTime, ReportTime, lambda _query, _sender: FULL)
    component.start()
    return component


@pytest.mark.parametrize(
    ("wanted", "presence"), [(0, 0), (1, 1), (2, 2), (3, 3), (0xFF, 3), (0xFC, 0)]
)
def test_an_answer_has_the_fields_that_were_asked_for(world, clock, wanted, presence):
    (report,) = world.probe("2.1.1").ask(QueryTime(wanted), clock)
    assert report.encode()[2] == presence
    assert FULL.encode()[2] == 3


def test_an_event_has_the_fields_that_were_asked_for(world, clock):
    client, taken = world.component("2.1.1"), []
    client.start()
    client.subscribe(
        clock.address, QueryTime(2), ReportTime, lambda report, _: taken.append(report), rate=10.0
    )
    world.run(0.5)
    assert taken[0] == ReportTime(date_stamp=FULL.date_stamp)
