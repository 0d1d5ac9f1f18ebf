"""Two bridges of lists, the node of nav2 beside them, and an operator."""

import sys

import pytest
from nav2 import nav2

from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.component.process import running_transport

from ..bridge_support import RosPeer, generate, wait_for
from .list_system import LIVE, PATIENCE, ROBOT, Operator, System, facts


@pytest.fixture(scope="module")
def packages():
    """The module path of the generated bridges, of their messages, and of nav2_msgs."""
    messages = nav2()
    made = generate(LIVE / "waypoint_lists.ros2jaus")
    with pytest.MonkeyPatch.context() as patch:
        for message in [*made, messages]:
            patch.syspath_prepend(message)
        yield [*made, messages]


@pytest.fixture
def system(tmp_path, packages):
    made = System(tmp_path, packages)
    yield made
    end(made)


def end(system):
    """Ends a system, and shows what was logged."""
    for name in system.processes:
        sys.stderr.write(f"--- {name}\n{system.log_of(name)}\n")
    system.close()


@pytest.fixture
def operator(system):
    """An operator in control of the robot's bridge, whose action server is there."""
    system.start_ros_robot()
    yield from operator_of(system, "robot")


@pytest.fixture
def tracker_operator(system):
    """An operator in control of the bridge that follows path segments."""
    system.start_ros_robot("path")
    yield from operator_of(system, "tracker", "--jaus-id", str(ROBOT))


def operator_of(system, bridge, *arguments):
    """Yields an operator in control of a bridge, which is started."""
    system.start_bridge(bridge, *arguments)
    wait_for(lambda: facts(system, "client"), "client of the action", PATIENCE)
    yield from controlling(system, bridge)


def controlling(system, bridge):
    """Yields an operator in control of a bridge."""
    with running_transport(TransportSettings(port=system.port)) as transport:
        made = Operator(transport, bridge=bridge)
        made.ready()
        yield made
        if system.lasts:
            made.rest()
            # Else the next test takes the end of this one's goal for its own.
            wait_for(lambda: not system.open_goals(), "end of the goals", PATIENCE)
        made.stop()


@pytest.fixture
def peer(packages):
    """A node of the test, which finds nav2_msgs."""
    del packages
    made = RosPeer()
    yield made
    made.close()
