"""Greeting of peers that say nothing before they are asked who they are."""

import logging
from itertools import pairwise

import pytest

from jausml.runtime import ComponentSettings, Scope
from jausml.runtime.base.address import JausAddress
from jausml.runtime.clients.greeter import GREETING_INTERVAL
from jausml.runtime.messages import QueryIdentification, ReportHeartbeatPulse, ReportIdentification
from jausml.runtime.services.host import GREETING_PATIENCE as PATIENCE

from .bridge_support import OWN, event, values

JUDGE = JausAddress(42, 1, 1)
GREETED = {JUDGE: Scope.SUBSYSTEM}
ANSWER = ReportIdentification(query_type=Scope.SUBSYSTEM, type_=20001, identification="judge")


class Silent:
    """A peer that answers who asks for its identification, and says nothing by itself."""

    def __init__(self, world, *, answers=True):
        self.answers, self.asked = answers, []
        self._world = world
        world.attach(JUDGE, self._receive)

    def _receive(self, payload, source):
        query = QueryIdentification.decode(payload)
        self.asked.append((self._world.time, query.query_type))
        if self.answers:
            self._world.send(JUDGE, source, ANSWER.encode())


@pytest.fixture
def entry(world):
    return world.component("155.1.1", greeted=GREETED)


def test_it_asks_at_once_and_no_more_when_answered(world, entry, caplog):
    caplog.set_level(logging.INFO)
    judge = Silent(world)
    began = world.time
    entry.start()
    world.run(50.0, step=0.5)
    assert judge.asked == [(began, Scope.SUBSYSTEM)]
    assert entry.unanswered_greetings == {JUDGE: 0}
    told = [record.message for record in caplog.records if str(JUDGE) in record.message]
    assert told == ["42.1.1 speaks, and is greeted no more"]


def test_it_asks_in_a_steady_pace_until_it_is_answered_and_tells_once(world, entry, caplog):
    judge = Silent(world, answers=False)
    entry.start()
    world.run(100.0, step=0.5)
    times = [time for time, _ in judge.asked]
    pauses = [later - former for former, later in pairwise(times)]
    assert pauses == [GREETING_INTERVAL] * 20
    told = [record.message for record in caplog.records if "greet" in record.message]
    detail = f"42.1.1 has answered none of {PATIENCE} greetings"
    assert told == [f"greeter.unanswered (1 times): {detail}"]
    judge.answers = True
    world.run(50.0, step=0.5)
    assert len(judge.asked) == len(times) + 1
    assert entry.unanswered_greetings == {JUDGE: 0}


def test_any_message_of_the_peer_is_an_answer(world, entry):
    judge = Silent(world, answers=False)
    entry.start()
    world.send(JUDGE, entry.address, ReportHeartbeatPulse().encode())
    world.run(20.0, step=0.5)
    assert len(judge.asked) == 1


def test_after_a_long_silence_it_is_asked_again(world, entry):
    judge = Silent(world)
    entry.start()
    world.run(150.0, step=0.5)
    lost = ComponentSettings().discovery_timeout
    times = [time for time, _ in judge.asked]
    assert len(times) == 3
    pauses = [later - former for former, later in pairwise(times)]
    assert all(lost <= pause <= lost + GREETING_INTERVAL for pause in pauses)


def test_who_has_stopped_asks_nobody(world, entry):
    judge = Silent(world, answers=False)
    entry.start()
    world.run(7.0)
    entry.stop()
    asked = len(judge.asked)
    world.run(20.0, step=0.5)
    assert len(judge.asked) == asked == 2


def test_nobody_is_greeted_who_is_not_named(world):
    judge = Silent(world, answers=False)
    world.component("155.1.1").start()
    world.run(20.0, step=0.5)
    assert judge.asked == []


def test_a_wildcard_is_nobody_to_greet():
    with pytest.raises(ValueError, match=r"155\.255\.1 names no single component to greet"):
        ComponentSettings(greeted={JausAddress(155, 255, 1): Scope.NODE})


def test_diagnostics_of_a_bridge_say_who_does_not_answer(world, setting):
    setting.open(event(), greeted=GREETED)
    world.run(2.0, step=0.5)
    status = setting.ros.statuses[-1]["jaus greetings"]
    assert (status.level, status.message, status.hardware_id) == ("ok", "running", str(OWN))
    assert values(status) == {"greetings to 42.1.1": "1"}
    world.run(15.0, step=0.5)
    assert setting.judged("jaus greetings") == ("warning", "no answer of 42.1.1")
    Silent(world)
    world.run(10.0, step=0.5)
    status = setting.ros.statuses[-1]["jaus greetings"]
    assert (status.level, values(status)) == ("ok", {"greetings to 42.1.1": "0"})
