"""Components whose values do not fit their fields: nothing wrong is sent, all of it is counted."""

import pytest

from jausml.runtime.messages import QueryTime, ReportTime, SetTime
from jausml.runtime.wire.message import EncodeError

COUNTER = "component.report_not_encodable"


class Clock:
    """Provides the time of a number of minutes, legal or not."""

    def __init__(self, world):
        self.minutes = 1
        self.component = world.component("1.1.1")
        self.component.provide(QueryTime, ReportTime, self.report)
        self.component.start()

    def report(self, _query, _sender):
        return ReportTime(time_stamp=ReportTime.TimeStamp(minutes=self.minutes))


def minutes_of(reports):
    return [report.time_stamp.minutes for report in reports]


def test_a_query_stays_unanswered(world):
    clock, probe = Clock(world), world.probe("2.1.1")
    clock.minutes = 77
    assert probe.ask(QueryTime(1), clock.component) == []
    assert world.counters.snapshot()[COUNTER] == 1
    clock.minutes = 7
    assert minutes_of(probe.ask(QueryTime(1), clock.component)) == [7]
    assert world.counters.snapshot()[COUNTER] == 1


@pytest.mark.parametrize("rate", [10.0, None])
def test_an_event_is_not_sent_and_goes_on_afterwards(world, rate):
    clock, client, taken = Clock(world), world.component("2.1.1"), []
    client.start()
    client.subscribe(
        clock.component.address,
        QueryTime(1),
        ReportTime,
        lambda report, _: taken.append(report.time_stamp.minutes),
        rate=rate,
    )

    def set_minutes(minutes):
        clock.minutes = minutes
        clock.component.report_changed(ReportTime)
        world.run(0.5)

    world.run(0.5)
    set_minutes(77)
    assert world.counters.snapshot()[COUNTER] >= 1
    set_minutes(8)
    assert set(taken) == {1, 8}
    assert clock.component.running


def test_send_lets_the_error_out_and_nothing_is_sent(world):
    component = world.started("1.1.1")
    world.settle()
    sent = len(world.log)
    message = SetTime(time_stamp=SetTime.TimeStamp(minutes=77))
    with pytest.raises(EncodeError, match="minutes: 77 is outside 0"):
        component.send(message, component.address)
    assert len(world.log) == sent
