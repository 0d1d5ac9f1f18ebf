"""What the guardian of a bridge says when the bridge cannot, and that it is silent otherwise."""

import os
import re
import signal
import time

import needs
import pytest
from guardians import guardian_of
from sweeps import sweep

needs.ask("rclpy")

from jausml.runtime.guardian.ward import TOO_SOON
from tests.live.bridge_support import wait_for

from .conftest import running

pytestmark = [pytest.mark.slow, pytest.mark.live, pytest.mark.timeout(240)]

COMMANDS = ("cruise", "drive")
SPEECH = re.compile(r"jausml guardian: .*")
CONTROL = 9
"""Seconds after which the control of the vehicle lapses by itself."""


def speeches(system):
    """Returns what guardians have said that they do."""
    logs = sorted(system.logs.glob("bridge-*.log"))
    return [match for log in logs for match in SPEECH.findall(log.read_text(errors="replace"))]


@pytest.fixture(scope="module")
def system(path, tmp_path_factory):
    """A system whose vehicle stops by itself only long after the guardian should have."""
    logs = tmp_path_factory.mktemp("logs")
    with running(path, logs, vehicle=("0", str(CONTROL))) as made:
        yield made


@pytest.fixture(autouse=True)
def _whole(request):
    """Where a test has left the system without its bridge, the next one is not the next to fail."""
    yield
    system = request.node.funcargs.get("system")
    if system is not None and system.running["bridge"].popen.poll() is not None:
        system.kill("bridge")
        system.start("bridge")


def stopped(system, began):
    """Waits until the stops of the guardian stand, and returns when they came."""
    found = {command: system.stops(command, began) for command in COMMANDS}
    first = next(x for x in system.arrivals("drive") if x["at"] > began and not x["value"])
    assert "why" not in first, "the vehicle has stopped by itself"
    return found


def restart(system):
    system.kill("bridge")
    system.start("bridge")
    system.begins("bridge")
    system.flows(time.monotonic())


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSEGV])
def test_a_bridge_that_is_killed_or_crashes_has_its_stops_said(system, record, number):
    system.flows(time.monotonic())
    began = time.monotonic()
    system.signal("bridge", number)
    found = stopped(system, began)
    record("guardian", number.name, found)
    assert "has died" in speeches(system)[-1]
    restart(system)


@pytest.mark.parametrize("seconds", sweep([2.5, 1.0, 0.6], every=3))
def test_a_bridge_that_is_halted_has_its_stops_said_and_goes_on_later(system, seconds, record):
    system.flows(time.monotonic())
    said = len(speeches(system))
    began = time.monotonic()
    system.signal("bridge", signal.SIGSTOP)
    found = {}
    if seconds > 1.0:
        found = stopped(system, began)
    time.sleep(max(0.0, began + seconds - time.monotonic()))
    # What is said later may be of another halt: others may starve the bridge as it catches up.
    spoken = speeches(system)[said:]
    system.signal("bridge", signal.SIGCONT)
    back = time.monotonic()
    system.flows(back)
    record("guardian", f"halted for {seconds} s", found)
    assert len(spoken) <= 1
    assert seconds <= 1.0 or "does not run its loop" in spoken[0]


def test_the_guardian_is_silent_where_a_bridge_ends_in_good_order(system):
    began = time.monotonic()
    system.flows(began)
    said = speeches(system)
    system.end("bridge")
    system.stops("drive", began)
    assert speeches(system) == said
    system.start("bridge")
    system.flows(time.monotonic())
    assert speeches(system) == said


def test_a_guardian_that_dies_is_replaced_and_one_that_dies_soon_is_not(system):
    bridge = system.running["bridge"]
    time.sleep(TOO_SOON + 1.0)  # a life that is long enough
    first = guardian_of(bridge.popen.pid)
    os.kill(first, signal.SIGKILL)
    wait_for(lambda: "another one runs" in bridge.log.read_text(), "another guardian")
    second = guardian_of(bridge.popen.pid)
    assert second != first
    os.kill(second, signal.SIGKILL)
    wait_for(lambda: "nothing stops the robot" in bridge.log.read_text(), "the end of guarding")
    system.flows(time.monotonic())  # the bridge itself goes on
    restart(system)
