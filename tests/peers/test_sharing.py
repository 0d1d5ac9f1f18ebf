"""Live tools on a host whose port belongs to a node manager."""

import socket
import subprocess
import sys
from pathlib import Path

import ports
import pytest
from click.testing import CliRunner

from jausml.cli import main
from jausml.runtime import JausComponent, ServiceIdentity
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.settings import TransportKind, TransportSettings
from jausml.runtime.component.process import running_transport

pytestmark = pytest.mark.ports

MANAGER = Path(__file__).parents[1] / "runtime" / "junior_manager.py"
CORE = "urn:jaus:jss:core:"


def run(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture
def taken(free_port):
    """The free port, held by a program that does not share it."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as holder:
        holder.bind(("", free_port))
        yield free_port


@pytest.fixture
def manager(tmp_path_factory, free_port):
    """The folder of a node manager that runs on the free port."""
    folder = tmp_path_factory.mktemp("nm")
    command = [sys.executable, str(MANAGER), str(folder), str(free_port), "-"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as running:
        assert running.stdout.readline() == "ready\n"
        yield folder
        running.kill()


def test_ocu_names_what_it_can_do(taken):
    result = run("ocu", "status", "100.1.1", "--port", taken)
    assert result.exit_code == 2
    assert f"port {taken} is in use and not shared; " in result.stderr
    assert "--transport node-manager; or use another port" in result.stderr
    assert "--port 3795 --peer ID=HOST:3794" in result.stderr


def test_conformance_names_what_it_can_do(taken):
    result = run("conformance", "100.1.1", "--port", taken)
    assert result.exit_code == 2
    assert "--port 3795 --peer ID=HOST:3794" in result.stderr
    assert "--transport" not in result.stderr


def test_listening_names_what_shows_the_traffic(taken):
    result = run("decode", "--listen", "--port", taken)
    assert result.exit_code == 2
    assert "Address already in use and not shared; " in result.stderr
    assert f"jausml decode --port {taken} --pcap -" in result.stderr


@pytest.mark.parametrize(
    "words", [("ocu", "status", "100.1.1"), ("conformance", "100.1.1", "--only", "liveness")]
)
def test_another_port_and_a_peer_reach_a_component(words, component, free_port):
    component()
    peer = f"100.1.1=127.0.0.1:{free_port}"
    result = run(*words, "--port", ports.free_port(), "--peer", peer)
    assert result.exit_code == 0, result.output


def test_the_names_of_the_options_of_components_hold(component, free_port):
    component()
    result = run("ocu", "status", "100.1.1", "--jaus-port", free_port, "--jaus-transport", "judp")
    assert result.exit_code == 0, result.output


def test_ocu_goes_through_a_node_manager(manager):
    settings = TransportSettings(
        transport=TransportKind.NODE_MANAGER, node_manager_directory=str(manager)
    )
    services = [ServiceIdentity(CORE + name, 1, 1) for name in ("Management", "AccessControl")]
    with running_transport(settings) as transport:
        target = JausComponent(transport, JausAddress(100, 1, 1), name="target", services=services)
        target.start()
        options = ("--transport", "node-manager", "--node-manager-directory", manager)
        result = run("ocu", "status", "100.1.1", *options)
        target.stop()
    assert result.stdout == "100.1.1 STANDBY; not controlled, default authority 0\n", result.stderr


def test_ocu_speaks_tcp(free_port):
    settings = TransportSettings(port=free_port, transport=TransportKind.JTCP)
    services = [ServiceIdentity(CORE + name, 1, 1) for name in ("Management", "AccessControl")]
    with running_transport(settings) as transport:
        target = JausComponent(transport, JausAddress(100, 1, 1), name="target", services=services)
        target.start()
        options = ("--transport", "jtcp", "--port", ports.free_port())
        result = run(
            "ocu", "status", "100.1.1", *options, "--peer", f"100.1.1=127.0.0.1:{free_port}"
        )
        silent = run("ocu", "status", "100.1.2", *options, "--timeout", "0.2")
        target.stop()
    assert result.stdout == "100.1.1 STANDBY; not controlled, default authority 0\n", result.stderr
    assert "Without multicast, --peer ID=HOST:PORT says where components are" in silent.stderr


def test_a_node_manager_that_does_not_run_is_told(tmp_path):
    options = ("--transport", "node-manager", "--node-manager-directory", tmp_path)
    result = run("ocu", "status", "100.1.1", "--timeout", "0.2", *options)
    assert result.exit_code == 2
    assert "through the node manager of this host, and none runs" in result.stderr
