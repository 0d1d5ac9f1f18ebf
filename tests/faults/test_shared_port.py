"""Programs of one host at one port: its owner is lost, or another one; the others go on."""

from functools import partial

import needs
import pytest

needs.ask("rclpy")

from .failing import Fault, ended, halted, killed, suffer

pytestmark = [pytest.mark.slow, pytest.mark.live, pytest.mark.timeout(240)]

SHARED = [
    Fault("owner of the port killed", partial(killed, role="vehicle"), 3, ("odometry",)),
    Fault("owner of the port restarted", partial(ended, role="vehicle"), 0, ("odometry",)),
    Fault("another at the port killed", partial(killed, role="operator"), 3, ("cruise",)),
    Fault("owner of the port halted for 10 s", partial(halted, role="vehicle"), 10, ("odometry",)),
]
"""Where all have one port: the vehicle starts first and owns it."""


@pytest.mark.faults
@pytest.mark.parametrize(
    "fault",
    [pytest.param(fault_case, id=fault_case.name.replace(" ", "_")) for fault_case in SHARED],
)
def test_fault_on_a_shared_port(shared_system, fault, record):
    record("faults", fault.name, suffer(shared_system, fault))
