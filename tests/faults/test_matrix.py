"""What happens to each connection when something fails, and that all come back by themselves.

Each fault begins while data flows, lasts, and ends. Afterwards what was sent since then arrives
by all connections, without anybody touching the bridge; while it lasts, a stop stands where a
source is lost; and no command was obeyed late. Of what was sent by way of the network, receivers
know how much came and how much was lost, exactly.
"""

from functools import partial

import needs
import pytest

needs.ask("rclpy")

from .failing import (
    BRIDGE,
    VEHICLE,
    Fault,
    emergency,
    ended,
    halted,
    killed,
    network,
    nonsense,
    preempted,
    suffer,
)
from .rover_system import ROLES

pytestmark = [pytest.mark.slow, pytest.mark.live, pytest.mark.timeout(240)]

ROLE_STOPS = {
    "bridge": ("drive",),
    "vehicle": ("odometry",),
    "operator": ("cruise",),
    "ros": ("drive",),
}
"""What must stand when a role is gone."""

LONG = pytest.mark.faults


FAULTS = [
    *[
        Fault(f"{r} killed", partial(killed, role=r), 3, ROLE_STOPS[r], marks=(LONG,))
        for r in ROLES
    ],
    *[
        Fault(f"{r} restarted", partial(ended, role=r), 0, ROLE_STOPS[r], marks=(LONG,))
        for r in ROLES
    ],
    *[
        Fault(
            f"{r} halted for 10 s",
            partial(halted, role=r),
            10,
            ROLE_STOPS[r],
            unread=r,
            marks=(LONG,),
        )
        for r in ROLES
    ],
    *[
        Fault(f"{r} halted for 1.5 s", partial(halted, role=r), 1.5, unread=r)
        for r in ("bridge", "vehicle")
    ],
    Fault(
        "network cut for 10 s",
        partial(network, drop=1.0),
        10,
        ("drive", "cruise", "odometry"),
        marks=(LONG,),
    ),
    Fault("20 % lost", partial(network, drop=0.2), flows=True),
    Fault("40 % lost", partial(network, drop=0.4), 5, marks=(LONG,)),
    Fault("half of all repeated", partial(network, repeat=0.5), flows=True),
    Fault("reordered within 60 ms", partial(network, jitter=0.06), flows=True),
    Fault("100 ms late", partial(network, delay=0.1), flows=True),
    Fault("bridge taken over", partial(preempted, peer=BRIDGE), 0.5, ("cruise",)),
    Fault("vehicle taken over", partial(preempted, peer=VEHICLE), 0.5, ("drive",)),
    Fault("emergency of the bridge", partial(emergency, peer=BRIDGE), 0.5, ("drive", "cruise")),
    Fault("emergency of the vehicle", partial(emergency, peer=VEHICLE), 0.5, ("drive",)),
    Fault("a peer that talks nonsense", nonsense, 0.2, flows=True, is_forged=True),
]


@pytest.mark.parametrize(
    "fault",
    [
        pytest.param(fault_case, marks=fault_case.marks, id=fault_case.name.replace(" ", "_"))
        for fault_case in FAULTS
    ],
)
def test_fault(system, fault, record):
    record("faults", fault.name, suffer(system, fault))
