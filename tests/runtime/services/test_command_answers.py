"""Queries for a command that a bridge obeys: what was commanded last answers them."""

import pytest

from jausml.runtime import CommandAnswer, Guard
from jausml.runtime.messages import (
    CreateEvent,
    QueryTime,
    RejectEventRequest,
    ReleaseControl,
    ReportTime,
    RequestControl,
    Resume,
)

from .bridge_support import CORE, OTHER, OWN, Number, message_connection, minutes, obeyed

ALL = QueryTime(presence_vector=3)
TOLD = CommandAnswer(QueryTime, ReportTime)
EMPTY = CommandAnswer(QueryTime, ReportTime, has_empty=True)


@pytest.fixture
def operator(world):
    return world.probe(str(OTHER), strict=False)


def asked(operator, query=ALL):
    """The minutes that the bridge reports; None for those that it does not have."""
    answers = [message for message in operator.ask(query, OWN) if isinstance(message, ReportTime)]
    return [answer.time_stamp and answer.time_stamp.minutes for answer in answers]


def test_the_last_command_is_told(setting, operator):
    setting.open(message_connection(answer=TOLD))
    assert asked(operator) == []
    operator.tell(OWN, minutes(5), minutes(7))
    assert setting.ros.numbers("times") == [5.0, 7.0]
    assert asked(operator) == [7]
    assert asked(operator, QueryTime(presence_vector=2)) == [None]


def test_what_is_not_passed_on_is_not_told(setting, operator):
    def few(message):
        small = message.time_stamp.minutes < 10
        return Number(float(message.time_stamp.minutes)) if small else None

    setting.open(message_connection(few, answer=TOLD))
    operator.tell(OWN, minutes(5), minutes(20))
    assert asked(operator) == [5]


@pytest.mark.parametrize(("answer", "nothing"), [(TOLD, []), (EMPTY, [None])])
def test_after_the_stop_nothing_is_commanded(answer, nothing, setting, operator):
    connection = obeyed(answer=answer)
    setting.open(connection, services=CORE)
    assert asked(operator) == nothing
    operator.tell(OWN, RequestControl(authority_code=200), Resume(), minutes(5))
    assert asked(operator) == [5]
    operator.tell(OWN, ReleaseControl())
    assert setting.ros.numbers("times")[-1] == -1.0
    assert asked(operator) == nothing


def test_a_command_that_was_stopped_is_not_told_again(world, setting, operator):
    """Whoever commands next ends the stop by what its map leaves out, and commands nothing."""

    def few(message):
        small = message.time_stamp.minutes < 10
        return Number(float(message.time_stamp.minutes)) if small else None

    setting.open(obeyed(few, answer=TOLD), services=CORE)
    following = world.probe("1.1.7", strict=False)
    for commanding, value in ((operator, 5), (following, 20)):
        commanding.send(RequestControl(authority_code=200), OWN)
        commanding.send(Resume(), OWN)
        commanding.send(minutes(value), OWN)
        world.settle()
        assert asked(commanding) == ([value] if value < 10 else [])
        commanding.send(ReleaseControl(), OWN)
        world.settle()


def test_what_holds_is_told_on(setting, operator):
    connection = message_connection(when=Guard.READY, hold_reason="it is a goal", answer=TOLD)
    setting.open(connection, services=CORE)
    operator.tell(OWN, RequestControl(authority_code=200), Resume(), minutes(5), ReleaseControl())
    assert asked(operator) == [5]


def test_a_command_of_another_kind_is_not_told(setting, operator):
    """As QueryVelocityCommand names the kind of command that it means."""
    setting.open(message_connection(answer=CommandAnswer(QueryTime, ReportTime, same=("NAME",))))
    operator.tell(OWN, minutes(5))
    assert asked(operator) == []


def test_nobody_gets_every_change(world, setting, operator):
    """For nobody tells of changes on the way of a command."""
    setting.open(message_connection(answer=TOLD), services=CORE)
    operator.send(minutes(5), OWN)
    wanted = CreateEvent(1, CreateEvent.EventType.EVERY_CHANGE, 0.0, ALL.encode())
    (refused,) = operator.ask(wanted, OWN)
    assert isinstance(refused, RejectEventRequest)
    assert refused.response_code == 2
    wanted = CreateEvent(2, CreateEvent.EventType.PERIODIC_SC, 10.0, ALL.encode())
    operator.send(wanted, OWN)
    world.run(1.0)
    reports = [message.report_message for message in operator.take() if message.NAME == "Event"]
    assert len(reports) > 5
    assert {ReportTime.decode(report).time_stamp.minutes for report in reports} == {5}
