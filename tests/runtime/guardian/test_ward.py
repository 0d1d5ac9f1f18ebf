"""What a bridge has its guardian know, whatever keeps that from being handed over."""

import os
import select
import signal
import socket
import time
from contextlib import contextmanager

import pytest
from guardians import guardian_of

from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.loop import Loop
from jausml.runtime.guardian.page import MAX_FRAME_SIZE, MAX_STOPS, Page, Slots
from jausml.runtime.guardian.ward import Ward

PATIENCE = 20.0
OWN = JausAddress(1, 1, 9)
MUCH = MAX_FRAME_SIZE - 1000
"""Octets that make a frame long."""

GOAL = bytes(range(16))
STOPS = {"patience": 0.5, "topics": [], "datagrams": []}
TOPIC = {
    "topic": "/cmd_vel", "type": "geometry_msgs/msg/Twist",
    "library": "/nowhere/libgeometry_msgs__rosidl_typesupport_c.so", "qos": {}, "data": "",
    "stamps": [],
}  # fmt: skip


class Guarding:
    """A loop that a test turns, with a ward and a vehicle that listens."""

    def __init__(self, loop):
        self._loop = loop
        self.ward = Ward(loop, dict, lambda: 0, lambda: None)
        self.vehicle = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.vehicle.bind(("127.0.0.1", 0))

    def command(self, number, topics=(), size=0):
        """Guards a connection whose stop the vehicle gets, in a frame that may be long."""
        data = f"stop {number:02d}..".encode().hex()
        datagram = {"data": data, "endpoint": self.vehicle.getsockname(), "slot": 0}
        content = {**STOPS, "topics": topics, "datagrams": [datagram], "padding": "." * size}
        return self.ward.guard(lambda: content)

    def turn_until(self, condition, what):
        end = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < end, f"no {what}: {self.ward.failure!r}"
            self._loop.run_once(0.05)

    @contextmanager
    def halted_guardian(self):
        """A guardian that reads nothing for a time."""
        guardian = guardian_of(os.getpid())
        os.kill(guardian, signal.SIGSTOP)
        try:
            yield
        finally:
            os.kill(guardian, signal.SIGCONT)

    def heard(self, count):
        """The stops that come while the loop does not turn, until so many different ones did."""
        found = set()
        while len(found) < count and select.select([self.vehicle], [], [], PATIENCE)[0]:
            found.add(self.vehicle.recv(100)[:-2].decode())
        return found


@pytest.fixture
def guarding():
    with Loop() as loop:
        made = Guarding(loop)
        yield made
        made.ward.close()
        made.vehicle.close()


def test_stops_that_a_halted_guardian_had_no_room_for_are_handed_over_later(guarding):
    connections = [guarding.command(0)]
    with guarding.halted_guardian():
        connections += [guarding.command(number, size=MUCH) for number in range(1, 30)]
        for connection in connections:
            connection.arm(True)
        assert "not handed over (" in guarding.ward.failure
    guarding.turn_until(lambda: not guarding.ward.failure, "handing over")
    assert guarding.heard(30) == {f"stop {number:02d}" for number in range(30)}


def test_goals_that_a_halted_guardian_had_no_room_for_are_handed_over_later(guarding):
    guarding.command(0)
    with guarding.halted_guardian():
        for size in (MUCH, 0):  # until there is no room for a small frame either
            while guarding.ward.send("padding", {"padding": "." * size}):
                pass
        guarding.ward.open_goal(GOAL, "/follow/_action/cancel_goal", "libaction_msgs.so")
    # Where there is no ROS it says so of each goal that it gets.
    guarding.turn_until(lambda: guarding.ward.failure.endswith(": 1 refused by ROS"), "goal")
    guarding.ward.close_goal(GOAL)
    guarding.turn_until(lambda: not guarding.ward.failure, "end of it")


def test_a_stop_that_is_too_long_is_told_while_it_stands(guarding):
    guarding.command(0, size=MAX_FRAME_SIZE)
    assert "1 not handed over (" in guarding.ward.failure
    guarding.ward.release()
    assert guarding.ward.failure == ""


def test_connections_without_room_are_told(guarding):
    assert all(guarding.ward.guard(lambda: STOPS) for _ in range(MAX_STOPS))
    assert guarding.ward.guard(lambda: STOPS) is None
    assert "1 without room" in guarding.ward.failure


def test_a_topic_that_ros_refuses_leaves_the_other_stops(guarding, capfd):
    connection = guarding.command(7, topics=[TOPIC])
    connection.arm(True)
    guarding.turn_until(lambda: "1 refused by ROS" in guarding.ward.failure, "refusal")
    assert guarding.heard(1) == {"stop 07"}
    assert capfd.readouterr().err.count("/cmd_vel cannot be stopped") == 1


def test_places_are_for_as_many_routes_as_a_page_has_and_are_given_back():
    slots, user, other = Slots(), object(), object()
    routes = [(OWN, JausAddress(subsystem, 1, 1)) for subsystem in range(1, MAX_STOPS + 2)]
    found = [slots.take(user, route, lambda: 9) for route in routes]
    assert found == [*range(MAX_STOPS), None]
    assert slots.refused == 1
    assert slots.take(other, routes[4], lambda: 9) == 4  # one for all who send to a component
    descriptor = Page.descriptor()
    page = Page.at(descriptor)
    slots.write(page)
    assert page.numbers[MAX_STOPS - 1] == 9
    os.close(descriptor)
    slots.give_back(user, routes[4])
    assert slots.take(user, routes[-1], lambda: 9) is None
    slots.give_back(other, routes[4])
    assert slots.take(user, routes[-1], lambda: 9) == 4
    assert slots.refused == 0
