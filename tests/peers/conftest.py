"""Targets for the live tools: components of ours and of another make, on loopback."""

from __future__ import annotations

import importlib.util
import socket
import sys
from contextlib import ExitStack
from pathlib import Path

import pytest

from jausml.messages import load_catalogue
from jausml.peers.network import make_network
from jausml.runtime.address import JausAddress
from jausml.runtime.component import ComponentSettings, JausComponent, Scope, ServiceIdentity
from jausml.runtime.process import running_transport
from jausml.runtime.settings import TransportSettings

TARGET = JausAddress(100, 1, 1)
CORE = "urn:jaus:jss:core:"
NAMES = ("Transport", "Events", "AccessControl", "Management", "Liveness", "Discovery")


def find_free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        return sock.getsockname()[1]


@pytest.fixture
def free_port():
    """A UDP port of loopback that nobody uses."""
    return find_free_port()


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
    """Starts a component of ours on the free port; returns it."""
    with ExitStack() as stack:

        def start(version=1, **settings):
            transport = stack.enter_context(running_transport(TransportSettings(port=free_port)))
            made = JausComponent(
                transport,
                TARGET,
                name="target",
                services=[ServiceIdentity(CORE + name, 1, version) for name in NAMES],
                component_type=10001,
                settings=ComponentSettings(
                    **{"discovery_scope": Scope.SUBSYSTEM, "control_timeout": 1, **settings}
                ),
            )
            made.start()
            stack.callback(made.stop)
            return made

        yield start


@pytest.fixture(scope="session")
def peer_module():
    """The component of another make, from the file beside this one."""
    spec = importlib.util.spec_from_file_location(
        "faulty_peer", Path(__file__).with_name("peer.py")
    )
    module = importlib.util.module_from_spec(spec)
    sys.modules["faulty_peer"] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def peer(free_port, peer_module):
    """Starts a component of another make with faults; returns it."""
    with ExitStack() as stack:

        def start(*faults):
            made = peer_module.FaultyPeer(TARGET, free_port, *faults)
            stack.callback(made.close)
            return made

        yield start
