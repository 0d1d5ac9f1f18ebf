"""What a hand holds ends with its stop, whoever comes first: the hand, its page or the time."""

import time
from queue import Queue

import pytest
from suspended_clocks import SuspendedClocks

from jausml.generation.native import compiler
from jausml.live.messages import load_catalogue
from jausml.live.operating.journal import Journal
from jausml.live.operating.sticks import Lease, Stick, Sticks
from jausml.live.operating.stops import Stops, parse_stop
from jausml.live.peers.query_client import Refused
from jausml.runtime import JausAddress
from jausml.runtime.base.standstill import steady


def test_a_lease_whose_time_is_up_is_not_renewed_before_its_thread_has_seen_it():
    expired = Queue()
    lease = Lease(0.01, lambda: expired.put("expired"))
    with lease._news:  # its thread waits for this
        while (left := lease._due - steady()) > 0:
            time.sleep(left)
        assert not lease.renew()
    assert expired.get(timeout=10) == "expired"
    assert not lease.renew()


@pytest.mark.needs("compiler")
def test_a_lease_does_not_outlast_a_suspension_of_the_computer(tmp_path):
    code = "from jausml.live.operating.sticks import Lease; from queue import Queue; q = Queue();"
    code += "lease = Lease(100, lambda: q.put('over')); print(lease.renew(), flush=True); input();"
    code += "print(lease.renew(), q.get(timeout=10), flush=True)"
    clocks = SuspendedClocks(tmp_path, compiler())
    assert clocks.told(code, 200) == "True\nFalse over\n"


def test_a_lease_that_is_ended_does_not_expire():
    expired = Queue()
    lease = Lease(0.05, lambda: expired.put("ended"))
    due = lease._due
    assert lease.renew()
    assert lease._due > due
    lease.end()
    assert not lease.renew()
    Lease(0.1, lambda: expired.put("a later one"))
    assert expired.get(timeout=10) == "a later one"


@pytest.fixture
def held():
    """A stick, and all that was said of it in its order."""
    said = Queue()

    def begin(seconds):
        return Stick(seconds, said.put, lambda: said.put("stop"), said.put), said

    return begin


def told(said, number):
    return [said.get(timeout=10) for _ in range(number)]


def test_nothing_follows_the_stop_of_a_stick(held):
    stick, said = held(60.0)
    stick.move("left")
    stick.end("released")
    stick.end("released twice")
    with pytest.raises(Refused):
        stick.move("right")
    assert told(said, 3) == ["left", "stop", "released"]
    assert said.empty()


def test_a_stick_whose_page_is_silent_is_stopped(held):
    stick, said = held(0.05)
    assert told(said, 2) == ["stop", "the page said nothing for 0.05 s"]
    with pytest.raises(Refused):
        stick.move("left")
    stick.end("released")
    assert said.empty()


CAR, OTHER = JausAddress(100, 1, 1), JausAddress(100, 1, 2)


class Unit:
    """Stands for an operator that speaks with one component, which acknowledges when it is told."""

    def __init__(self):
        self.running = self.operator = self
        self.is_in_control = True
        self.sent, self.stops = [], []
        stop = parse_stop("SetWrenchEffort 60 PropulsiveLinearEffortX=0", load_catalogue())
        self.journal = Journal(lambda *_: None)
        self.sticks = Sticks(self, self.journal, Stops({}, [stop]))

    def name_of(self, target):
        return str(target)

    def controls(self, _target):
        return self.is_in_control

    def message(self, entry, fields):
        return entry.name, fields

    def send(self, _target, message):
        self.sent.append(message)

    def deliver(self, _target, message, arrived):
        self.stops.append((message, arrived))

    def begin(self, target=CAR):
        return self.sticks.begin("page", target, load_catalogue().message("SetWrenchEffort"))[0]


@pytest.fixture
def unit():
    return Unit()


def test_a_stop_that_nobody_acknowledges_is_repeated_and_told_in_the_end(unit):
    unit.sticks.release(unit.begin())
    for number in range(1, 6):
        assert len(unit.stops) == number
        unit.stops[-1][1](False)
    assert len(unit.stops) == 5
    assert [alarm["text"] for alarm in unit.journal.alarms] == ["the stop was never acknowledged"]


def test_a_stop_that_has_arrived_is_not_repeated(unit):
    unit.sticks.release(unit.begin())
    unit.stops[-1][1](True)
    assert len(unit.stops) == 1
    assert unit.journal.alarms == []


def test_an_old_stop_does_not_come_into_a_new_stick(unit):
    unit.sticks.release(unit.begin())
    number = unit.begin()
    unit.stops[-1][1](False)
    assert (len(unit.stops), unit.journal.alarms) == (1, [])
    unit.sticks.release(number)
    unit.begin(OTHER)  # that of another component is no matter
    unit.stops[-1][1](False)
    assert len(unit.stops) == 3


def test_only_the_stick_that_is_held_is_moved_and_ended(unit):
    old = unit.begin()
    with pytest.raises(Refused):
        unit.begin()
    unit.sticks.end("control is lost", OTHER)
    assert unit.stops == []
    unit.sticks.end("control is lost", CAR)
    assert len(unit.stops) == 1
    assert [alarm["text"] for alarm in unit.journal.alarms] == ["stopped: control is lost"]
    number = unit.begin()
    for late in (lambda: unit.sticks.move(old, {}), lambda: unit.sticks.release(old)):
        with pytest.raises(Refused):
            late()
    assert (len(unit.stops), unit.sent) == (1, [])
    unit.sticks.end("stop")
    assert (len(unit.stops), unit.sticks.held) == (2, None)
    assert number == old + 1


def test_nobody_holds_a_stick_of_what_is_not_controlled(unit):
    unit.is_in_control = False
    with pytest.raises(Refused, match="not controlled"):
        unit.begin()
    assert unit.sticks.held is None
