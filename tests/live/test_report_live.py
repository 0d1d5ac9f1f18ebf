"""What `jausml report` tells of a system is what its sockets carry."""

import socket
import struct
import threading
import time
from collections import Counter, defaultdict
from pathlib import Path

import needs
import pytest

needs.ask("rclpy")

from jausml.generation.target import system_of
from jausml.language.model import read_models
from jausml.live.traffic.captures import CapturedFrame
from jausml.live.traffic.frames import UdpReader
from jausml.runtime.base.counters import Counters
from jausml.runtime.transports.packets.packet import AckNak, parse_datagram
from jausml.views.analysis.report import report_of
from jausml.views.analysis.sizes import Assumptions

from .bridge_support import MODEL, System, generate, wait_for

pytestmark = pytest.mark.live

VEHICLE = str(Path(__file__).resolve().parent / "bridge_vehicle.py")
ETH_P_ALL, PACKET_OUTGOING, ETHERNET = 3, 4, 1
HOST_FRAMES = b"\0"  # between the jausml processes of one host
CODES = {"ReportVelocityState": 0x4404, "ReportLocalPose": 0x4403, "QueryLocalPose": 0x2403}
PUBLISHED = 20.0


class Capture:
    """What goes over the loopback interface: time and size of datagrams by sender and message."""

    def __init__(self, port: int) -> None:
        needs.ask("capture")
        self._socket = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(ETH_P_ALL))
        self._socket.bind(("lo", 0))
        self._socket.settimeout(0.1)
        self._reader = UdpReader(port)
        self._stopped = threading.Event()
        self.seen: dict[tuple[str, str, int], list[tuple[float, int]]] = defaultdict(list)
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self) -> None:
        number = 0
        while not self._stopped.is_set():
            try:
                data, (_, _, kind, *_) = self._socket.recvfrom(65536)
            except TimeoutError:
                continue
            if kind != PACKET_OUTGOING:
                number += 1
                self._take(
                    self._reader.read(CapturedFrame(number, time.monotonic(), ETHERNET, data))
                )

    def _take(self, datagram) -> None:
        if datagram is None or datagram.data.startswith(HOST_FRAMES):
            return
        for packet in parse_datagram(datagram.data, Counters()):
            if packet.acknowledge < AckNak.NAK and len(packet.payload) >= 2:
                (code,) = struct.unpack_from("<H", packet.payload)
                if code == 0x41F1:  # an Event has the report behind its header
                    (code,) = struct.unpack_from("<H", packet.payload, 8)
                key = str(packet.source), str(packet.destination), code
                self.seen[key].append((datagram.time, len(datagram.data)))

    def close(self) -> None:
        self._stopped.set()
        self._thread.join()
        self._socket.close()


class Metronome:
    """Does something so many times each second; what is late is made up for."""

    def __init__(self, act, hertz: float) -> None:
        self._act, self._period = act, 1 / hertz
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self) -> None:
        due = time.monotonic()
        while not self._stopped.wait(max(0.0, due - time.monotonic())):
            self._act()
            due += self._period

    def close(self) -> None:
        self._stopped.set()
        self._thread.join()


@pytest.fixture(scope="module")
def capture(tmp_path_factory):
    from geometry_msgs.msg import Twist

    with System(generate(), tmp_path_factory.mktemp("logs")) as system:
        listening = Capture(system.port)
        system.start("-m", "loop_bridge.main")
        for address in ("10.1.1", "10.1.2"):
            system.start(VEHICLE, "--address", address)
        publisher = system.ros.publisher(Twist, "cmd_vel")
        metronome = Metronome(lambda: publisher.publish(Twist()), PUBLISHED)
        yield listening
        metronome.close()
        listening.close()


@pytest.fixture(scope="module")
def flows():
    """What the report foretells, by sender, receiver and message."""
    system = system_of(read_models([MODEL]).model)
    report = report_of(system, Assumptions(rates={"drive": PUBLISHED}))
    addresses = {component.name: component.address for component in report.components}
    return {
        (addresses[flow.sender], addresses[flow.receiver], flow.message): flow
        for owner in report.bridges
        for connection in owner.connections
        for flow in connection.flows
        if {flow.sender, flow.receiver} <= set(addresses)
    }


def steady(seen, rate: float):
    """Returns the datagrams of two seconds in which they came at a rate, when there are some."""
    recent = [datagram for datagram in list(seen) if datagram[0] > time.monotonic() - 2.5]
    if len(recent) < 2 or recent[-1][0] - recent[0][0] < 2.0:
        return None
    measured = (len(recent) - 1) / (recent[-1][0] - recent[0][0])
    return recent if abs(measured - rate) <= 0.05 * rate else None


@pytest.mark.parametrize(
    ("sender", "receiver", "message", "absent"),
    [
        ("10.1.1", "10.1.9", "ReportVelocityState", 4),  # of a field that it does not know
        ("10.1.9", "10.1.1", "QueryLocalPose", 0),
        ("10.1.1", "10.1.9", "ReportLocalPose", 0),
        ("10.1.9", "10.1.1", "SetWrenchEffort", 0),
        ("10.1.9", "10.1.2", "SetWrenchEffort", 0),
    ],
)
def test_rates_and_sizes_are_as_foretold(capture, flows, sender, receiver, message, absent):
    flow = flows[sender, receiver, message]
    code = {**CODES, "SetWrenchEffort": 0x0405}[message]
    seen = capture.seen[sender, receiver, code]
    datagrams = wait_for(lambda: steady(seen, flow.hertz), f"{flow.hertz} Hz of {message}", 30)
    overhead = flow.datagram_bytes - flow.size.expected
    # A stop, where the publisher was late, has fewer fields than what is carried.
    sizes = Counter(size - overhead for _, size in datagrams).most_common()
    assert sizes[0][0] == flow.size.expected - absent
    assert all(size <= flow.size.most for size, _ in sizes)
    assert flow.size.least <= flow.size.expected - absent
    assert flow.size.expected == flow.size.most
