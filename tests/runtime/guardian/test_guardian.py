"""Guardians of real processes, which have stops for JAUS components alone."""

import os
import select
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
from guardians import guardian_of
from suspended_clocks import SuspendedClocks
from sweeps import sweep

from jausml.generation.native import compiler
from jausml.runtime.guardian.page import Page, frame, read_frame, steady_ns
from jausml.runtime.guardian.process import SEARCH_TIME, Guardian
from jausml.runtime.guardian.rcl import Publisher

ROOT = Path(__file__).parents[3]
PATIENCE = 20.0
BRIDGE = """
import os, signal, sys, threading
from jausml.runtime.base.loop import Loop
from jausml.runtime.guardian.ward import Ward

port, life, patience = int(sys.argv[1]), sys.argv[2], float(sys.argv[3])
with Loop() as loop:
    taken, goes_on = [], threading.Event()
    ward = Ward(loop, dict, lambda: 0, lambda: taken.append(1) or print("taken", flush=True))
    loop.start()
    with loop.lock:
        slot = ward.slots.take("drive", ("own", "vehicle"), lambda: 4660)
        content = {"data": b"stop..".hex(), "endpoint": ("127.0.0.1", port), "slot": slot}
        contents = [content]
        if life == "under two commands":
            contents.append({**content, "data": b"halt..".hex()})
        stops = {"patience": patience, "topics": [], "datagrams": contents}
        guarded = ward.guard(lambda: stops)
        if life != "at rest":
            guarded.arm(True)
        print("runs", flush=True)
        if life == "halted":  # before its loop has done anything
            os.kill(os.getpid(), signal.SIGSTOP)
    for line in sys.stdin:
        if line == "disarm\\n":
            with loop.lock:
                guarded.arm(False)
            print("disarmed", flush=True)
        if line == "hang\\n":
            loop.call_soon(goes_on.wait)
        if line == "go on\\n":
            goes_on.set()
    ward.close()
print("ended", flush=True)
"""


class Bridge:
    """A process with a loop, a command to a component and a guardian."""

    def __init__(self, life="under command", patience=0.5, environment=None):
        self.vehicle = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.vehicle.bind(("127.0.0.1", 0))
        line = [sys.executable, "-c", BRIDGE, str(self.vehicle.getsockname()[1]), life]
        line.append(str(patience))
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True, "bufsize": 1}
        self.process = subprocess.Popen(line, cwd=ROOT, env=environment, **pipes)
        assert self.said() == "runs"
        if life == "killed":  # before its guardian has done anything
            self.process.kill()
            self.process.wait()
        self.guardian = guardian_of(self.process.pid)
        # It tells the end of a process at once: who inherits one may take seconds to wait for it.
        self._end_of_guardian = os.pidfd_open(self.guardian)

    def said(self):
        return self.process.stdout.readline().strip()

    def tell(self, what):
        self.process.stdin.write(f"{what}\n")

    def stop(self, seconds=PATIENCE):
        """The stop that arrives within a time; None when there is none."""
        if not select.select([self.vehicle], [], [], seconds)[0]:
            return None
        return self.vehicle.recv(100)

    def has_guardian(self, seconds=0.0):
        """Whether the guardian goes on for a time."""
        return not select.select([self._end_of_guardian], [], [], seconds)[0]

    def go_on(self):
        """Ends a standstill; the bridge says that its command was taken."""
        self.process.send_signal(signal.SIGCONT)
        assert self.said() == "taken"

    def wait_alone(self):
        assert not self.has_guardian(PATIENCE), "the guardian goes on"

    def close(self):
        self.process.kill()
        self.process.wait()
        self.process.stdin.close()
        self.process.stdout.close()
        self.wait_alone()
        os.close(self._end_of_guardian)
        self.vehicle.close()


@pytest.fixture
def bridge():
    made = []

    def start(*life, **given):
        made.append(Bridge(*life, **given))
        return made[-1]

    yield start
    for instance in made:
        instance.close()


STOP = b"stop\x34\x12"
"""The last two octets are the sequence number of the page."""


@pytest.mark.parametrize("number", sweep([signal.SIGKILL, signal.SIGSEGV, signal.SIGABRT], every=3))
def test_the_stop_is_said_thrice_when_the_bridge_dies(bridge, number):
    dying = bridge()
    dying.process.send_signal(number)
    assert [dying.stop(), dying.stop(), dying.stop()] == [STOP] * 3
    dying.wait_alone()
    assert dying.stop(0.0) is None


def test_each_stop_to_a_component_has_a_number_of_its_own_and_keeps_it(bridge):
    dying = bridge("under two commands")
    dying.process.kill()
    assert [dying.stop() for _ in range(6)] == [STOP, b"halt\x35\x12"] * 3


def test_the_stop_is_said_when_the_bridge_died_before_its_guardian_ran(bridge):
    dying = bridge("killed")
    assert [dying.stop(), dying.stop(), dying.stop()] == [STOP] * 3


def test_the_stop_is_said_when_the_bridge_stands_still(bridge):
    halted = bridge()
    halted.process.send_signal(signal.SIGSTOP)
    assert halted.stop() == STOP
    halted.go_on()
    assert halted.has_guardian()


def test_the_stop_is_said_thrice_of_a_bridge_that_stands_still(bridge):
    halted = bridge()
    halted.process.send_signal(signal.SIGSTOP)
    assert [halted.stop(), halted.stop(), halted.stop()] == [STOP] * 3
    assert halted.stop(1.0) is None
    halted.go_on()


def test_a_bridge_that_was_back_for_less_than_a_look_is_told_again(bridge):
    halted = bridge()
    halted.process.send_signal(signal.SIGSTOP)
    assert [halted.stop(), halted.stop(), halted.stop()] == [STOP] * 3
    os.kill(halted.guardian, signal.SIGSTOP)
    halted.go_on()
    halted.process.send_signal(signal.SIGSTOP)
    time.sleep(0.6)  # the last beat is older than the patience when the guardian looks again
    os.kill(halted.guardian, signal.SIGCONT)
    assert halted.stop() == STOP


@pytest.mark.needs("compiler")
def test_the_time_for_which_the_computer_was_suspended_counts(bridge, tmp_path):
    clocks = SuspendedClocks(tmp_path, compiler())
    halted = bridge(patience=5 * PATIENCE, environment={**os.environ, **clocks.environment})
    halted.process.send_signal(signal.SIGSTOP)
    assert halted.stop(0.5) is None
    clocks.suspend(int(10 * PATIENCE))
    assert halted.stop() == STOP
    halted.go_on()


def test_the_stop_is_said_of_a_bridge_that_stands_still_before_its_loop_ran(bridge):
    halted = bridge("halted")
    assert halted.stop() == STOP
    halted.go_on()


def test_the_stop_is_said_when_the_loop_hangs(bridge):
    hanging = bridge()
    hanging.tell("hang")
    assert hanging.stop() == STOP
    hanging.tell("go on")
    assert hanging.said() == "taken"


def test_nothing_is_said_of_a_bridge_at_rest(bridge):
    resting = bridge("at rest")
    resting.process.kill()
    resting.wait_alone()
    assert resting.stop(0.0) is None


def test_nothing_is_said_after_the_bridge_has_said_its_stop(bridge):
    stopped = bridge()
    stopped.tell("disarm")
    assert stopped.said() == "disarmed"
    stopped.process.kill()
    stopped.wait_alone()
    assert stopped.stop(0.0) is None


def test_a_bridge_that_ends_takes_its_guardian_along(bridge):
    ending = bridge()
    ending.process.stdin.close()
    assert ending.said() == "ended"
    assert ending.process.wait(PATIENCE) == 0
    ending.wait_alone()
    assert ending.stop(0.0) is None


@pytest.mark.parametrize("number", sweep([signal.SIGINT, signal.SIGTERM, signal.SIGHUP], every=3))
def test_signals_for_the_bridge_do_not_end_the_guardian(bridge, number):
    guarded = bridge()
    # Its handlers stand when it has read what was handed over; a stop proves that.
    os.kill(guarded.guardian, signal.SIGCONT)
    guarded.process.send_signal(signal.SIGSTOP)
    assert guarded.stop() == STOP
    guarded.process.send_signal(signal.SIGCONT)
    os.kill(guarded.guardian, number)
    assert guarded.said() == "taken"
    guarded.process.kill()
    assert guarded.stop() == STOP


def unheard():
    """A library of ROS whose topics never have a subscriber."""
    names = ("type", "check", "destroy", "close", "publishers", "subscribers")
    return SimpleNamespace(
        publisher=lambda topic, *_: Publisher(None, topic), **dict.fromkeys(names, lambda *_: 0)
    )


def test_a_stop_does_not_wait_for_subscribers_of_an_earlier_one():
    descriptor, death = Page.descriptor(), os.pidfd_open(os.getpid())
    page = Page.at(descriptor)
    page.beat, page.armed[0], page.armed[1] = steady_ns(), True, True
    own, other = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with own, other, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vehicle:
        vehicle.bind(("127.0.0.1", 0))
        topic = {"topic": "/drive", "library": "", "type": "a/msg/A", "data": "", "stamps": []}
        datagram = {"data": b"stop..".hex(), "endpoint": vehicle.getsockname(), "slot": 0}
        topics, datagrams = [{**topic, "qos": {}}], [datagram]
        for number, contents in enumerate(([topics, []], [[], datagrams])):
            stops = dict(zip(("topics", "datagrams"), contents, strict=True))
            own.send(frame("stops", {"number": number, "patience": 0.2 + 0.3 * number, **stops}))
        guardian = Guardian(other, page, death, "bridge", os.getpid())
        guardian._ros = unheard()
        thread = threading.Thread(target=guardian.run)
        thread.start()
        assert select.select([vehicle], [], [], SEARCH_TIME / 2)[0], "the search comes first"
        own.send(frame("bye", {}))
        thread.join()
    os.close(death)
    os.close(descriptor)


def test_both_sides_read_the_same_page():
    descriptor = Page.descriptor()
    one, other = Page.at(descriptor), Page.at(descriptor)
    assert (one.beat, one.taken, one.simulated) == (0, 0, 0)
    one.beat, one.taken, one.simulated = 2**63, 7, -5
    one.armed[1023] = True
    one.numbers[1023] = 65536 + 9
    assert (other.beat, other.taken, other.simulated) == (2**63, 7, -5)
    assert [other.armed[index] for index in (0, 1022, 1023)] == [False, False, True]
    assert [other.numbers[index] for index in (0, 1023)] == [0, 9]
    os.close(descriptor)


def test_frames_come_whole_and_end_with_the_other_side():
    one, other = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with other:
        with one:
            one.send(frame("goal", {"id": "00ff"}))
            one.send(frame("bye", {}))
        assert read_frame(other) == {"kind": "goal", "id": "00ff"}
        assert read_frame(other) == {"kind": "bye"}
        assert read_frame(other) is None
