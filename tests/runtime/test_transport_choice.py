"""Processes of real components on each transport, and what they say when a port is taken."""

from __future__ import annotations

import re
import signal
import socket
from pathlib import Path
from typing import TYPE_CHECKING

import ports
import pytest

from jausml.runtime import ComponentSettings, ControlState, JausComponent
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.loop import Loop
from jausml.runtime.base.settings import TransportKind, TransportSettings
from jausml.runtime.component.process import create_transport
from jausml.runtime.messages import QueryStatus, ReportStatus
from jausml.runtime.transports import ports as port_holder
from jausml.runtime.transports.jtcp import JtcpTransport
from jausml.runtime.transports.node_manager import NodeManagerTransport
from jausml.runtime.transports.udp.judp import JudpTransport

from .conftest import wait_until

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from conftest import Program

pytestmark = pytest.mark.ports

ROBOT_SCRIPT = Path(__file__).with_name("services") / "robot_process.py"
MANAGER_SCRIPT = Path(__file__).with_name("junior_manager.py")
HOLDER = """
import socket, sys
sock = socket.socket(socket.AF_INET, getattr(socket, sys.argv[1]))
sock.bind((sys.argv[2], int(sys.argv[3])))
if sys.argv[1] == "SOCK_STREAM":
    sock.listen()
print("ready", flush=True)
sys.stdin.read()
"""
EVERY_INTERFACE = "0.0.0.0"  # noqa: S104
ROBOT, OTHER, OPERATOR = JausAddress(1, 1, 1), JausAddress(1, 1, 2), JausAddress(2, 1, 1)
QUICK = ComponentSettings(register_services=False, retry_max=1.0)


@pytest.fixture
def robot(start, free_port) -> Callable[..., Program]:
    """Starts robots on the free port."""
    return lambda *options: start(ROBOT_SCRIPT, "--jaus-port", free_port, *options)


@pytest.fixture
def folder(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("nm")


@pytest.fixture
def operator(station) -> Iterator[Callable[..., JausComponent]]:
    """Makes a running operator on a transport of its own."""
    made: list[JausComponent] = []

    def make(**settings: object) -> JausComponent:
        transport = station(**settings).transport
        made.append(
            JausComponent(transport, OPERATOR, name="operator", services=(), settings=QUICK)
        )
        made[0].start()
        return made[0]

    yield make
    for jaus_component in made:
        jaus_component.stop()


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        (TransportKind.JUDP, JudpTransport),
        (TransportKind.JTCP, JtcpTransport),
        (TransportKind.NODE_MANAGER, NodeManagerTransport),
    ],
)
def test_each_kind_has_its_transport(kind, expected):
    with Loop() as loop:
        assert type(create_transport(TransportSettings(transport=kind), loop)) is expected


def control_both(operator: JausComponent) -> None:
    """Control two robots and see their status."""
    statuses: dict[JausAddress, list[ReportStatus]] = {}
    sessions = [operator.control(address, authority=100) for address in (ROBOT, OTHER)]
    for address in (ROBOT, OTHER):
        operator.subscribe(
            address,
            QueryStatus(),
            ReportStatus,
            lambda report, sender: statuses.setdefault(sender, []).append(report),
        )
    wait_until(lambda: all(session.state is ControlState.READY for session in sessions))
    wait_until(lambda: set(statuses) == {ROBOT, OTHER})


def test_two_robots_and_an_operator_over_tcp(robot, operator, free_port):
    robots = [
        robot("--jaus-transport", "jtcp", "--jaus-id", str(address)) for address in (ROBOT, OTHER)
    ]
    for process in robots:
        process.expect("initialize")
    here = ("127.0.0.1", free_port)
    tested = operator(
        transport=TransportKind.JTCP,
        port=ports.free_port(),
        address_book={ROBOT: here, OTHER: here},
    )
    control_both(tested)
    assert [process.end(signal.SIGTERM) for process in robots] == [0, 0]


def test_two_robots_and_an_operator_through_a_node_manager(
    start, robot, operator, folder, free_port
):
    start(MANAGER_SCRIPT, folder, free_port, "-").expect("ready")
    options = ("--jaus-transport", "node-manager", "--jaus-node-manager-directory", str(folder))
    robots = [robot(*options, "--jaus-id", str(address)) for address in (ROBOT, OTHER)]
    for process in robots:
        process.expect("initialize")
    tested = operator(transport=TransportKind.NODE_MANAGER, node_manager_directory=str(folder))
    control_both(tested)
    assert [process.end(signal.SIGTERM) for process in robots] == [0, 0]
    assert not (folder / str(ROBOT.packed)).exists()


class TestPortTaken:
    def test_a_program_that_does_not_share_is_named(self, start, robot, free_port):
        holder = start("-c", HOLDER, "SOCK_DGRAM", EVERY_INTERFACE, free_port)
        holder.expect("ready")
        tested = robot()
        assert tested.end() == 1
        assert "Traceback" not in tested.log
        assert f"JUDP port {free_port} of 127.0.0.1" in tested.log
        assert f"(process {holder.running.pid})" in tested.log
        for way_out in ("--jaus-transport node-manager", "--jaus-port"):
            assert way_out in tested.log

    def test_a_port_that_is_shared_needs_no_action(self, start, robot, free_port):
        holder = start("-c", HOLDER, "SOCK_DGRAM", "127.0.0.1", free_port)
        holder.expect("ready")
        tested = robot()
        tested.expect("initialize")
        said = rf"port {free_port} is owned by .*\(process {holder.running.pid}\)"
        wait_until(lambda: re.search(said, tested.log))
        assert tested.end(signal.SIGTERM) == 0

    def test_a_tcp_port_that_a_stranger_holds(self, start, robot, free_port):
        holder = start("-c", HOLDER, "SOCK_STREAM", "127.0.0.1", free_port)
        holder.expect("ready")
        tested = robot("--jaus-transport", "jtcp")
        said = rf"TCP port {free_port} is taken.*\(process {holder.running.pid}\)"
        wait_until(lambda: re.search(said, tested.log))
        assert tested.end(signal.SIGTERM) == 0

    def test_a_component_that_runs_twice_at_a_node_manager(self, start, robot, folder, free_port):
        start(MANAGER_SCRIPT, folder, free_port, "-").expect("ready")
        options = ("--jaus-transport", "node-manager", "--jaus-node-manager-directory", str(folder))
        robot(*options).expect("initialize")
        second = robot(*options)
        assert second.end() == 1
        assert "another process runs component 1.1.1" in second.log
        assert "Traceback" not in second.log

    def test_a_missing_folder_of_a_node_manager(self, robot, folder):
        missing = str(folder / "missing")
        tested = robot("--jaus-transport", "node-manager", "--jaus-node-manager-directory", missing)
        assert tested.end() == 1
        assert f"there is no folder {missing}" in tested.log

    @pytest.mark.parametrize("has_manager", [False, True])
    def test_what_cannot_be_seen_is_guessed(self, folder, monkeypatch, has_manager):
        monkeypatch.setattr(port_holder, "_PROC", folder)  # as if nothing were readable
        settings = TransportSettings(node_manager_directory=str(folder))
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
            if has_manager:
                manager.bind(str(folder / port_holder.MANAGER))
            text = port_holder.advice("udp", settings)
        guess = f"the node manager whose socket is in {folder}" if has_manager else "Junior or fkie"
        assert guess in text
