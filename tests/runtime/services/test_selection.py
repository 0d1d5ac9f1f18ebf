"""A query's presence vector names the fields that its report shall carry."""

import pytest

from jausml.runtime.messages import QueryTime, ReportTime

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
