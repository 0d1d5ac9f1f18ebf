"""Clocks that jump, and stamps from other days: data goes on both ways."""

import time

import needs
import pytest

needs.ask("rclpy")

from tests.live.bridge_support import RosPeer, wait_for
from tests.live.test_simulated_time import Simulation

from .conftest import running

DAY = 86400.0
HOUR = 3600.0
pytestmark = [pytest.mark.slow, pytest.mark.live, pytest.mark.faults, pytest.mark.timeout(120)]


@pytest.mark.parametrize("offset", [-3 * DAY, -HOUR, HOUR, 3 * DAY])
def test_stamps_of_another_time(system, offset):
    """Stamps are data: those of a peer whose clock is wrong hold up nothing."""
    for role in ("ros", "vehicle"):
        system.end(role)
        system.start(role, str(offset))
    system.flows(time.monotonic())


@pytest.fixture(scope="module")
def simulated(path, tmp_path_factory):
    """A system whose bridge follows `/clock`, and what speaks there."""
    peer = RosPeer()
    arguments = ("--ros-args", "-p", "use_sim_time:=true", "--")
    try:
        with running(path, tmp_path_factory.mktemp("logs"), bridge=arguments, wait=False) as made:
            simulation = Simulation(peer)
            made.flows(time.monotonic())
            yield made, simulation
            simulation.close()
    finally:
        peer.close()


@pytest.mark.parametrize("jump", [HOUR, -HOUR, 0.7, -0.7])
def test_clock_jumps(simulated, jump):
    system, simulation = simulated
    before = simulation.time
    simulation.time += jump
    wait_for(lambda: simulation.time != before + jump, "time after the jump")
    system.flows(time.monotonic())
