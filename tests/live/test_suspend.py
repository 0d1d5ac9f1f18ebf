"""A computer that was suspended: nothing that a bridge was told before holds when it goes on.

A halt of the bridge stands for the suspension, whose length its clocks tell (suspended_clocks.py):
the usual one rests meanwhile.
"""

import os
import signal
import struct
from functools import partial
from pathlib import Path

import needs
import pytest
from guardians import guardian_of
from ports import free_domain
from suspended_clocks import SuspendedClocks
from sweeps import sweep

needs.ask("rclpy")

from jausml.generation import native
from jausml.runtime.messages import QueryStatus, ReportStatus, RequestControl, Resume

from . import test_fast_path
from .bridge_support import generate, wait_for
from .test_fast_path import speed

pytestmark = [pytest.mark.live, pytest.mark.needs("compiler"), pytest.mark.timeout(240)]

MODEL = Path(__file__).with_name("suspend.ros2jaus")
SUSPENDED = 10
REPORT_POINT = 0xD107
QUERY_POINT = struct.pack("<H", 0xD000)


def is_halted(process):
    """Whether all threads of a process have stopped."""
    states = [path.read_text() for path in Path(f"/proc/{process}/task").glob("*/stat")]
    return all(state.rpartition(")")[2].split()[0] == "T" for state in states)


class System(test_fast_path.Connected):
    """A bridge and its guardian on a computer that can be suspended, and a peer on another one."""

    def __init__(self, path, folder, *, compiled):
        from geometry_msgs.msg import Point, TwistStamped

        self.clocks = SuspendedClocks(folder, native.compiler())
        log = folder / "bridge.log"
        super().__init__(path, log, f"compiled:={compiled}", **self.clocks.environment)
        self.speeds = self.ros.listen_to_publisher(TwistStamped, "speed_up", 1000)
        self.points = self.ros.node.create_publisher(Point, "report_down", 1)
        wait_for(lambda: " runs as " in log.read_text(), "start")
        wait_for(lambda: self.moves(1.0), "motion")

    def moves(self, vx):
        """Commands a motion, with control that may have lapsed; whether it is what came last."""
        for message in (RequestControl(200), Resume()):
            self.peer.send(message.encode())
        self.peer.send(speed(vx))
        return self.speeds and self.speeds[-1].twist.linear.x == vx

    def asked(self):
        """Asks for the report; the values that came when what is asked after it is answered."""
        first = len(self.peer.look())

        def came(code):
            packets = self.peer.look()[first:]
            return [
                packet.payload
                for packet in packets
                if packet.payload[:2] == struct.pack("<H", code)
            ]

        def is_answered():  # what comes soon after the suspension is taken for what waited
            self.peer.send(QUERY_POINT)
            self.peer.send(QueryStatus().encode())
            return came(ReportStatus.CODE)

        wait_for(is_answered, "answer")
        return [struct.unpack_from("<d", report, 2)[0] for report in came(REPORT_POINT)]

    def reports(self, x):
        """Publishes a value; whether it is what is reported."""
        from geometry_msgs.msg import Point

        self.points.publish(Point(x=x))
        return set(self.asked()) == {x}

    def suspend(self, meanwhile):
        """Suspends the bridge with its guardian while something is done."""
        bridge = self.process.popen.pid
        processes = [bridge, guardian_of(bridge)]
        for process in processes:
            os.kill(process, signal.SIGSTOP)
            wait_for(partial(is_halted, process), "halt")
        meanwhile()
        self.clocks.suspend(SUSPENDED)
        for process in processes:
            os.kill(process, signal.SIGCONT)


@pytest.fixture(params=sweep([True, False], every=2), ids=["core", "Python"])
def system(request, tmp_path, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    with System(generate(MODEL, compiled=True), tmp_path, compiled=request.param) as made:
        yield made


def test_after_a_suspension_the_stop_comes_before_whatever_waited(system):
    wait_for(lambda: system.reports(7.0), "report")
    wait_for(lambda: system.moves(2.0), "motion")
    first = len(system.speeds)

    def wait_in_socket():
        for _ in range(20):
            system.peer.send(speed(3.0))

    system.suspend(wait_in_socket)
    reported = system.asked()
    wait_for(lambda: system.moves(4.0), "motion after it")
    came = [speed.twist.linear.x for speed in list(system.speeds)[first:]]
    assert 3.0 not in came
    assert came.count(0.0) == 1
    assert reported == []
    wait_for(lambda: system.reports(8.0), "report after it")
