"""The bridge and its peers over TCP, at a node manager and at one port: cut, killed, and back."""

from functools import partial

import needs
import pytest

needs.ask("rclpy")

from .conftest import running
from .failing import Fault, ended, halted, killed, network, suffer
from .networks import NodeManager, Tcp

pytestmark = [pytest.mark.slow, pytest.mark.live, pytest.mark.timeout(240)]

LONG = (pytest.mark.faults,)
ALL = ("drive", "cruise", "odometry")


def kills(where):
    """Yields what happens to the roles of a network: killed, restarted, halted."""
    stops = {"bridge": ("drive",), "vehicle": ("odometry",), "operator": ("cruise",)}
    for role, standing in stops.items():
        yield Fault(f"{where}, {role} killed", partial(killed, role=role), 3, standing, marks=LONG)
    for name, what, seconds in (("restarted", ended, 0), ("halted for 10 s", halted, 10)):
        during = partial(what, role="vehicle")
        yield Fault(f"{where}, vehicle {name}", during, seconds, ("odometry",), marks=LONG)


TCP = [
    Fault("TCP, connections cut for 3 s", partial(network, cut=1), 3, ALL),
    Fault("TCP, held for 4 s", partial(network, hold=1), 4, ALL, marks=LONG),
    Fault("TCP, held for 10 s", partial(network, hold=1), 10, ALL, marks=LONG),
    *kills("TCP"),
]
MANAGER = [Fault("node manager killed", partial(network, cut=1), 3, ALL), *kills("node manager")]


@pytest.fixture(scope="module")
def joined(request, path, tmp_path_factory):
    """All roles joined by a network; that of one ends before that of the next begins."""
    logs = tmp_path_factory.mktemp("joined") / "logs"
    with running(path, logs, network=request.param) as made:
        yield made


@pytest.mark.parametrize(
    ("joined", "fault"),
    [
        pytest.param(
            network, fault_case, marks=fault_case.marks, id=fault_case.name.replace(" ", "_")
        )
        for network, faults in ((Tcp, TCP), (NodeManager, MANAGER))
        for fault_case in faults
    ],
    indirect=["joined"],
)
def test_fault(joined, fault, record):
    record("faults", fault.name, suffer(joined, fault))


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
