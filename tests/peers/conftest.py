"""Targets for the live tools: components of ours and of another make, on loopback."""

import time
from contextlib import ExitStack

import ports
import pytest
from click.testing import CliRunner

from jausml.cli import main
from jausml.live.messages import load_catalogue
from jausml.live.peers.entry_messages import message_class
from jausml.live.peers.network import make_network
from jausml.runtime import ComponentSettings, Guard, JausComponent, Scope, ServiceIdentity
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.component.process import running_transport
from jausml.runtime.messages.machine_states import (
    MACHINE_STATES,
    QueryMachineStates,
    ReportMachineStates,
)
from tests.peers.peer import FaultyPeer

TARGET = JausAddress(100, 1, 1)
CORE = "urn:jaus:jss:core:"
NAMES = (
    *("Transport", "Events", "AccessControl", "Management"),
    *("Liveness", "Discovery", "Time", "ListManager"),
)


class Target(JausComponent):
    """A component whose list takes any element."""

    def supports_element(self, _element):
        return True


@pytest.fixture
def free_port():
    """A UDP port of loopback that nobody uses."""
    return ports.free_port()


@pytest.fixture
def network(free_port):
    """The network of the tools, on the free port."""
    return make_network("65000.1.1", "127.0.0.1", free_port, "239.255.0.1", [])


@pytest.fixture(scope="session")
def catalogue():
    """All messages of the library."""
    return load_catalogue()


@pytest.fixture
def component(free_port):
    """Starts a component of ours on the free port; returns it.

    `telling`: answers QueryMachineStates, whose service it then provides.
    """
    with ExitStack() as stack:

        def start(version=1, services=(), names=NAMES, telling=None, **settings):
            further = [ServiceIdentity(f"urn:jaus:jss:{name}", 1, 0) for name in services]
            if telling is not None:
                further.append(ServiceIdentity(MACHINE_STATES, 1, 0))
            transport = stack.enter_context(running_transport(TransportSettings(port=free_port)))
            made = Target(
                transport,
                TARGET,
                name="target",
                services=[ServiceIdentity(CORE + name, 1, version) for name in names] + further,
                component_type=10001,
                settings=ComponentSettings(
                    **{"discovery_scope": Scope.SUBSYSTEM, "control_timeout": 1, **settings}
                ),
            )
            if telling is not None:
                made.provide(QueryMachineStates, ReportMachineStates, telling)
            made.start()
            stack.callback(made.stop)
            return made

        yield start


@pytest.fixture
def peer(free_port):
    """Starts a component of another make with faults; returns it."""
    with ExitStack() as stack:

        def start(*faults):
            made = FaultyPeer(TARGET, free_port, *faults)
            stack.callback(made.close)
            return made

        yield start


@pytest.fixture
def vehicle(component, catalogue):
    """Starts a component of ours with a velocity sensor and a driver; returns it.

    Its attribute `wrenches` has the fields of each SetWrenchEffort that it obeyed.
    """

    def start(**settings):
        made = component(
            services=("mobility:VelocityStateSensor", "mobility:PrimitiveDriver"), **settings
        )
        made.wrenches = []
        made.speed = 1.25
        report = message_class(catalogue.message("ReportVelocityState"))
        made.provide(
            message_class(catalogue.message("QueryVelocityState")),
            report,
            lambda *_: report({"ReportVelocityStateRec": {"Velocity_X": made.speed}}),
        )
        made.handle(
            message_class(catalogue.message("SetWrenchEffort")),
            lambda message, _: made.wrenches.append(message.fields["WrenchEffortRec"]),
            when=Guard.READY,
        )
        return made

    return start


@pytest.fixture
def wait_until():
    """Waits for a condition, with a bound."""

    def wait(condition, seconds=10.0):
        deadline = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < deadline, "the condition did not come true in time"
            time.sleep(0.005)

    return wait


@pytest.fixture
def jausml(free_port):
    """Runs the command line in this process, on the free port; the library is read once."""

    def run(*arguments, input=None):  # noqa: A002 - click's name
        words = [*map(str, arguments), "--port", str(free_port)]
        return CliRunner().invoke(main, words, input=input)

    return run
