"""Components as clients of a node manager, over real local sockets and processes."""

from __future__ import annotations

import os
import socket
import struct
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from jausml.runtime.base.address import BROADCAST
from jausml.runtime.base.loop import Loop
from jausml.runtime.base.settings import TransportKind, TransportSettings
from jausml.runtime.transports.node_manager import NodeManagerTransport
from jausml.runtime.transports.packets.packet import AckNak, Broadcast, Packet

from .conftest import wait_until
from .transport_support import DRIVER, OCU, PEER, SENSOR, STATUS

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from conftest import Program, Station

pytestmark = pytest.mark.ports

SCRIPT = Path(__file__).with_name("junior_manager.py")


@pytest.fixture
def folder(tmp_path_factory) -> Path:
    """A folder whose name is short enough for local sockets."""
    return tmp_path_factory.mktemp("nm")


@pytest.fixture
def managers(start, folder, free_port) -> Callable[..., Program]:
    """Starts node managers on the free port."""

    def make(peer: str = "-") -> Program:
        manager = start(SCRIPT, folder, free_port, peer)
        manager.expect("ready")
        return manager

    return make


@pytest.fixture
def client(station, folder) -> Callable[..., Station]:
    """Makes running transports that attach to the manager of the folder."""

    def make(**settings: object) -> Station:
        return station(
            **{
                "transport": TransportKind.NODE_MANAGER,
                "node_manager_directory": str(folder),
                **settings,
            }
        )

    return make


def test_two_components_of_two_processes_exchange_messages(client, managers):
    manager = managers()
    here, there = client().attach(DRIVER), client().attach(OCU)
    for address in (DRIVER, OCU):
        manager.expect(f"client {address.packed}")
    results = here.send(DRIVER, OCU, STATUS, acknowledge=True)
    wait_until(lambda: there.received and results)
    assert (there.payloads, results) == ([STATUS], [True])
    big = os.urandom(50_000)
    there.transport.send(OCU, DRIVER, big, acknowledge=True, on_result=results.append)
    wait_until(lambda: len(results) == 2)
    assert (here.payloads, results[1]) == ([big], True)


def test_two_components_of_one_process_exchange_messages(client, managers):
    managers()
    here = client().attach(DRIVER, SENSOR)
    here.transport.send(DRIVER, SENSOR, STATUS)
    wait_until(lambda: here.received)
    assert here.received[0][0] == SENSOR


def test_a_broadcast_reaches_every_other_component_once(client, managers):
    managers()
    here, there = client().attach(DRIVER, SENSOR), client().attach(OCU)
    wait_until(lambda: all(map(here.transport.is_attached, (DRIVER, SENSOR))))
    wait_until(lambda: there.transport.is_attached(OCU))
    here.transport.send(DRIVER, BROADCAST, STATUS)
    wait_until(lambda: here.received and there.received)
    assert [own for own, _ in here.received + there.received] == [SENSOR, OCU]


def test_the_world_is_reached_through_the_manager(client, managers, peer, free_port):
    managers(f"127.0.0.1:{peer.endpoint[1]}")
    here = client().attach(DRIVER, SENSOR)
    here.transport.send(DRIVER, BROADCAST, STATUS)
    packet = peer.receive()
    assert (packet.source, packet.destination, packet.payload) == (DRIVER, BROADCAST, STATUS)
    assert packet.broadcast is Broadcast.GLOBAL
    assert peer.answered_from == ("127.0.0.1", free_port)
    wait_until(lambda: here.received)
    question = Packet(BROADCAST, PEER, STATUS, 7, acknowledge=AckNak.REQUESTED)
    peer.send(question)
    answers = [peer.receive(), peer.receive()]
    assert {answer.source for answer in answers} == {DRIVER, SENSOR}
    assert {(answer.acknowledge, answer.sequence) for answer in answers} == {(AckNak.ACK, 7)}
    assert peer.is_quiet()
    peer.send(question)
    assert {peer.receive().source, peer.receive().source} == {DRIVER, SENSOR}
    wait_until(lambda: here.counter("transport.duplicate") == 2)
    assert len(here.received) == 3


def test_messages_wait_for_the_manager_to_accept(client, managers):
    managers()
    there = client().attach(OCU)
    wait_until(lambda: there.transport.is_attached(OCU))
    here = client()
    with here.loop.lock:
        here.attach(DRIVER)
        for count in range(5):
            here.transport.send(DRIVER, OCU, STATUS + bytes([count]))
        assert not here.transport.is_attached(DRIVER)
    wait_until(lambda: len(there.received) == 5)
    assert there.payloads == [STATUS + bytes([count]) for count in range(5)]


ACCEPT, CANCEL = 2, 3


class HandMade:
    """A manager of which the test decides when it answers."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind(str(folder / "JuniorRTE"))
        self.socket.settimeout(5)

    def receive(self) -> bytes:
        return self.socket.recv(65535)

    def say(self, code: int) -> None:
        client = struct.pack("<I", DRIVER.packed)
        head, tail = bytes.fromhex("01000000100602"), bytes(4 + 4)
        data = head + struct.pack("<H", code) + client + tail
        self.socket.sendto(data, str(self.folder / str(DRIVER.packed)))


@pytest.fixture
def by_hand(folder) -> Iterator[HandMade]:
    made = HandMade(folder)
    yield made
    made.socket.close()


@pytest.fixture
def here(client, by_hand) -> Station:
    """A station whose component the manager has accepted."""
    made = client().attach(DRIVER)
    by_hand.say(ACCEPT)
    wait_until(lambda: made.transport.is_attached(DRIVER))
    return made


def test_the_bytes_of_the_handshake(client, by_hand):
    here = client().attach(DRIVER)
    connect = "01000000100602{code}" + "00000000" + "01016400" + "00000000"
    assert by_hand.receive().hex() == connect.format(code="0100")
    by_hand.say(ACCEPT)
    wait_until(lambda: here.transport.is_attached(DRIVER))
    here.transport.detach(DRIVER)
    while (data := by_hand.receive().hex()) == connect.format(code="0100"):
        pass  # asked again before the answer came
    assert data == connect.format(code="0300")


def test_a_late_answer_is_an_answer(client, by_hand):
    here = client().attach(DRIVER)
    wait_until(lambda: here.counter("node_manager.no_answer") == 1)
    by_hand.say(ACCEPT)
    wait_until(lambda: here.transport.is_attached(DRIVER))
    by_hand.say(ACCEPT)
    wait_until(lambda: here.counter("node_manager.accepted_again") == 1)


def test_a_manager_that_cancels_is_asked_again(here, by_hand):
    by_hand.say(CANCEL)
    wait_until(lambda: here.counter("node_manager.lost") == 1)
    by_hand.say(ACCEPT)
    wait_until(lambda: here.transport.is_attached(DRIVER))


def test_a_busy_manager_is_waited_for(here, by_hand):
    """The system holds few datagrams for a local socket; messages come in bursts."""
    for _ in range(200):
        here.transport.send(DRIVER, OCU, bytes(4079))
    received = 0
    while received < 200:
        received += by_hand.receive()[0] == 2
    assert here.counter("node_manager.queue_full") == 0


def test_a_burst_and_a_very_large_message_reach_their_component(client, managers):
    managers()
    here, there = client().attach(DRIVER), client().attach(OCU)
    wait_until(lambda: here.transport.is_attached(DRIVER) and there.transport.is_attached(OCU))
    results: list[bool] = []
    for count in range(2000):
        payload = STATUS + count.to_bytes(2, "little") + bytes(31)
        here.transport.send(DRIVER, OCU, payload, on_result=results.append)
    wait_until(lambda: len(there.received) == len(results) == 2000, 60)
    assert set(results) == {True}
    big = os.urandom(2_000_000)
    here.transport.send(DRIVER, OCU, big, on_result=results.append)
    wait_until(lambda: len(results) == 2001, 60)
    wait_until(lambda: there.payloads[-1] == big)


def test_what_a_stuck_manager_does_not_take_is_refused_at_last(here):
    results: list[bool] = []
    while False not in results:
        for _ in range(100):
            here.transport.send(DRIVER, OCU, bytes(4079), on_result=results.append)
        wait_until(lambda: len(results) % 100 == 0)
        assert len(results) < 5000
    assert here.counter("node_manager.queue_full") == results.count(False)


def test_without_a_manager_messages_are_counted_and_it_is_found_later(client, managers):
    here = client().attach(DRIVER)
    here.transport.send(DRIVER, OCU, STATUS)
    wait_until(lambda: here.counter("node_manager.no_answer") == 1)
    assert here.result(DRIVER, OCU, STATUS) is False
    assert here.counter("node_manager.not_attached") == 1
    managers()
    wait_until(lambda: here.transport.is_attached(DRIVER))


@pytest.mark.parametrize("sends", [True, False])
def test_a_manager_that_restarts_is_attached_to_again(client, managers, sends):
    manager = managers()
    here = client().attach(DRIVER)
    wait_until(lambda: here.transport.is_attached(DRIVER))
    manager.kill()
    if sends:
        here.transport.send(DRIVER, OCU, STATUS)
    wait_until(lambda: here.counter("node_manager.lost") == 1)
    manager = managers()
    manager.expect(f"client {DRIVER.packed}")
    wait_until(lambda: here.transport.is_attached(DRIVER))


def test_a_component_takes_leave(client, managers, folder):
    manager = managers()
    here = client().attach(DRIVER, SENSOR)
    wait_until(lambda: all(map(here.transport.is_attached, (DRIVER, SENSOR))))
    here.transport.detach(DRIVER)
    manager.expect(f"gone {DRIVER.packed}")
    assert not (folder / str(DRIVER.packed)).exists()
    here.close()
    manager.expect(f"gone {SENSOR.packed}")
    assert [path.name for path in folder.iterdir()] == ["JuniorRTE"]


def test_a_component_that_another_process_runs_is_refused(client, managers):
    managers()
    client().attach(DRIVER)
    with pytest.raises(OSError, match=r"another process runs component 100\.1\.1"):
        client().attach(DRIVER)


def test_a_refusal_leaves_no_sockets_behind(client, managers, folder):
    managers()
    client().attach(DRIVER)
    settings = TransportSettings(node_manager_directory=str(folder))
    with Loop() as loop:
        transport = NodeManagerTransport(settings, loop)
        transport.attach(SENSOR, lambda *_: None)
        transport.attach(DRIVER, lambda *_: None)
        with pytest.raises(OSError, match=r"another process runs component 100\.1\.1"):
            transport.open()
        names = {path.name for path in folder.iterdir()}
        assert names == {"JuniorRTE", str(DRIVER.packed)}


def test_the_socket_of_a_crashed_process_is_replaced(client, managers, folder):
    managers()
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as crashed:
        crashed.bind(str(folder / str(DRIVER.packed)))
    here = client().attach(DRIVER)
    wait_until(lambda: here.transport.is_attached(DRIVER))


def test_foreign_and_damaged_datagrams_are_counted(client, managers, folder):
    managers()
    here = client().attach(DRIVER)
    wait_until(lambda: here.transport.is_attached(DRIVER))
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as stranger:
        for data in (
            b"junk",
            b"\x01" + bytes(20),
            bytes.fromhex("0100000012060264000201c8000101650002001a000102"),
            Packet(OCU, PEER, STATUS).encode(),
            Packet(DRIVER, BROADCAST, STATUS).encode(),
            Packet(DRIVER, PEER, STATUS, 1).encode(),
        ):
            stranger.sendto(data, str(folder / str(DRIVER.packed)))
    wait_until(lambda: here.received)
    # The manager passes datagrams of JUDP on as they are.
    reasons = ("judp.bad_version", "judp.version_1", "transport.not_for_us", "transport.bad_source")
    for reason in reasons:
        assert here.counter(reason) == 1
    assert here.counter("node_manager.bad_command") == 1


def test_what_cannot_work_is_refused(folder):
    with Loop() as loop:
        transport = NodeManagerTransport(
            TransportSettings(node_manager_directory=str(folder / "missing")), loop
        )
        with pytest.raises(OSError, match="there is no folder"):
            transport.open()
        results: list[bool] = []
        transport.send(DRIVER, OCU, STATUS, on_result=results.append)
        loop.run_once(0)
        assert results == [False]
        assert loop.counters.drops() == {"transport.not_attached": 1}
        transport.attach(DRIVER, lambda *_: None)
        with pytest.raises(ValueError, match="is attached already"):
            transport.attach(DRIVER, lambda *_: None)
        transport.close()
