"""Messages that a compiled core passes on alone, and those among them that it leaves to Python."""

import random
import re
import signal
import socket
import struct
import threading
from contextlib import suppress
from itertools import pairwise
from pathlib import Path

import needs
import pytest
from ports import free_domain, free_port
from sweeps import sweep

needs.ask("rclpy")

from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.messages import ConfirmEventRequest, CreateEvent, Event, RequestControl, Resume
from jausml.runtime.transports.packets.packet import (
    AckNak,
    DataFlags,
    Packet,
    Priority,
    parse_datagram,
)

from .bridge_support import Process, RosPeer, generate, wait_for

pytestmark = [pytest.mark.live, pytest.mark.needs("compiler"), pytest.mark.timeout(240)]

MODEL = Path(__file__).with_name("fast_path.ros2jaus")
BRIDGE, PEER = JausAddress(1, 1, 10), JausAddress(1, 1, 1)
GREETING = 0.0625
MOST = 120
"""Seconds that a script may take."""

NOT_COMPARED = ("unheard", "translation", "passed on by the core", "rate (Hz)", "age (s)")


@pytest.fixture(scope="module")
def path():
    return generate(MODEL, compiled=True)


def running(path, log, monkeypatch, compiled):
    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    return System(path, log, compiled=compiled)


LATE_END = Path(__file__).with_name("late_end.py")


def test_what_passes_while_a_bridge_ends_is_counted(path, tmp_path, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    log, may_end = tmp_path / "bridge.log", tmp_path / "may_end"
    with System(path, log, compiled=True, program=(LATE_END, may_end)) as system:
        sent = 0

        def pass_point():
            nonlocal sent
            sent += 1
            system.peer.send(point(float(sent)))
            wait_for(lambda: system.points[-1].point.x == sent, "point")

        def is_passed_by_core():  # which may take over after the first messages
            pass_point()
            return system.alone("point_up")

        wait_for(is_passed_by_core, "core")
        system.process.popen.send_signal(signal.SIGINT)
        wait_for(lambda: system.process.of_kind("ends"), "end")
        pass_point()
        may_end.touch()
    (passed,) = re.findall(r"account of point_up: .*messages passed (\d+)", log.read_text())
    assert int(passed) == system.greeted + sent


FORMS = [pytest.param(True, id="core"), pytest.param(False, id="Python")]


@pytest.fixture(scope="module", params=sweep(FORMS, every=2, rest=0))
def whole(request, path, tmp_path_factory):
    with System(path, tmp_path_factory.mktemp("fast") / "log", compiled=request.param) as made:
        yield made


@pytest.fixture
def system(whole):
    """A bridge that has served other tests; its peer has forgotten what came."""
    whole.peer.look()
    whole.peer.came.clear()
    return whole


def point(x, y=0.0, sec=5, nanosec=7):
    return struct.pack("<HiIdd", 0xD101, sec, nanosec, x, y)


def speed(vx):
    return struct.pack("<Hd", 0xD102, vx)


def report(x, y=0.0):
    return struct.pack("<Hdd", 0xD107, x, y)


class Connected:
    """A bridge, its JAUS peer on a socket of the test, and a node of the test."""

    def __init__(self, path, log, *parameters, program=("-m", "fast.main"), **environment):
        port = free_port()
        line = [*program, "--jaus-port", str(port), "--ros-args"]
        line += [word for parameter in parameters for word in ("-p", parameter.lower())]
        self.peer = RawPeer(port)
        self.process = Process(line, path, log, environment=environment)
        self.ros = RosPeer()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        assert self.process.stop() == 0, self.process.log.read_text()
        self.ros.close()
        self.peer.close()
        assert "Traceback" not in self.process.log.read_text()


class System(Connected):
    """Hears what the topics of the bridge carry."""

    def __init__(self, path, log, *, compiled, **options):
        from diagnostic_msgs.msg import DiagnosticArray
        from geometry_msgs.msg import Point, PointStamped, TwistStamped

        self.is_compiled = compiled
        parameters = (f"compiled:={compiled}", "diagnostics_frequency:=10.0")
        super().__init__(path, log, *parameters, **options)
        wait_for(lambda: " runs as " in log.read_text(), "start")
        self.points = self.ros.listen_to_publisher(PointStamped, "point_up", 1000)
        self.speeds = self.ros.listen_to_publisher(TwistStamped, "speed_up", 1000)
        self.reports = self.ros.listen_to_publisher(Point, "report_up", 1000)
        self.told = self.ros.listen_to_publisher(DiagnosticArray, "/diagnostics")
        greeted = 0

        def is_reached():  # the bridge may find the subscription later than the other way around
            nonlocal greeted
            greeted += 1
            self.peer.send(point(0.0))
            self.peer.send(speed(GREETING))
            return self.points and self.speeds

        wait_for(is_reached, "first messages")
        self.peer.send(point(0.0, 1.0))
        self.peer.send(speed(-GREETING))
        wait_for(lambda: self.points[-1].point.y == -1.0, "last point")
        wait_for(lambda: self.speeds[-1].twist.linear.x == -GREETING, "last speed")
        self.greeted = greeted + 1

    def account(self, connection):
        """The same of all messages up to now, without what depends on time and form."""
        told = len(self.told)
        wait_for(lambda: len(self.told) > told + 2, "diagnostics")
        found = {k: v for k, v in self.ros.values(connection).items() if k not in NOT_COMPARED}
        for count_name in ("messages taken", "messages passed"):
            found[count_name] = str(int(found[count_name]) - self.greeted)
        return found

    def alone(self, connection):
        """How many messages the core has passed on alone."""
        return int(self.ros.values(connection).get("passed on by the core", 0))

    def call(self, kind, name, request):
        """The answer of a service of the bridge."""
        return self.ros.call(kind, f"/fast/{name}", request)


class RawPeer:
    """A JAUS component that numbers its packets itself, and gives the event that is asked for."""

    def __init__(self, port):
        self.bridge = ("127.0.0.1", port)
        self.number, self.reports, self.event = 100, 0, 3
        self.came, self.left = [], Counters()
        self.open()

    def open(self):
        self.sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
        self.sock.bind(("127.0.0.1", 0))
        self.sock.setblocking(False)

    def send(self, payload, *, number=None, acknowledge=AckNak.NONE, damage=None):
        if number is None:
            self.number = number = self.number + 1 & 0xFFFF
        packet = Packet(BRIDGE, PEER, payload, number, Priority.STANDARD, acknowledge=acknowledge)
        data = packet.encode()
        self.sock.sendto(data if damage is None else damage(data), self.bridge)

    def send_report(self, payload, step=1):
        message = Event(self.event, self.reports & 0xFF, payload)
        self.reports += step
        self.send(message.encode())

    def look(self):
        """Takes what has come, and confirms events; returns all messages so far."""
        while True:
            try:
                data, _ = self.sock.recvfrom(65536)
            except BlockingIOError:
                return self.came
            for packet in parse_datagram(data, self.left):
                if packet.acknowledge is AckNak.REQUESTED:
                    ack = Packet(BRIDGE, PEER, b"", packet.sequence, packet.priority)
                    self.sock.sendto(ack._replace(acknowledge=AckNak.ACK).encode(), self.bridge)
                self.came.append(packet)
                if packet.payload[:2] == CreateEvent.CODE.to_bytes(2, "little"):
                    asked = CreateEvent.decode(packet.payload)
                    self.send(ConfirmEventRequest(asked.request_id, self.event, 0.0).encode())

    def of_code(self, *codes):
        """The payloads with some codes, and the number of each packet."""
        return [
            (packet.payload, packet.sequence)
            for packet in self.look()
            if int.from_bytes(packet.payload[:2], "little") in codes
        ]

    def close(self):
        self.sock.close()


def confirmed(system):
    """Waits until the bridge has its event."""

    def is_there():
        system.peer.look()
        return system.ros.values("report_up").get("peer 1.1.1") == "confirmed"

    wait_for(is_there, "event")


def script(seed):
    """Yields what a peer does, of which a part is not usual."""
    rng = random.Random(seed)
    for step in range(300):
        kind = rng.randrange(20)
        x = step + rng.random()
        if kind < 8:
            yield "point", {"payload": point(x, -x)}
        elif kind < 13:
            yield "speed", {"payload": speed(rng.uniform(-10, 10))}
        elif kind == 13:
            yield "speed", {"payload": speed(rng.choice([500.0, -21.0, float("nan")]))}
        elif kind == 14:
            yield "again", {}
        elif kind == 15:
            yield "point", {"payload": point(x)[: rng.randrange(2, 20)]}
        elif kind == 16:
            yield "point", {"payload": point(x), "acknowledge": AckNak.REQUESTED}
        elif kind == 17:
            cut = rng.randrange(1, 9)
            yield "point", {"payload": point(x), "damage": lambda data, cut=cut: data[:-cut]}
        elif kind == 18:
            yield "unknown", {"payload": b"\x77\x77" + bytes(rng.randrange(4))}
        else:
            yield "late", {"payload": point(x)}


def run(system, seed):
    """Plays a script; returns what came of it."""
    peer, latest = system.peer, None
    first = peer.number
    for what, how in script(seed):
        if what == "again" and latest is not None:
            peer.send(latest, number=peer.number)
        elif what == "late":
            peer.number = peer.number + 1 & 0xFFFF  # another one overtakes it
            late = peer.number
            peer.send(point(-1.0))
            peer.send(how["payload"], number=late)
        elif what != "again":
            peer.send(**how)
            latest = how["payload"] if "damage" not in how else None
    peer.send(point(9999.0))
    wait_for(lambda: system.points[-1].point.x == 9999.0, "end", MOST)
    speeds = [x for twist in system.speeds if abs(x := twist.twist.linear.x) != GREETING]
    points = [
        (stamped_point.header.stamp.sec, stamped_point.point.x, stamped_point.point.y)
        for stamped_point in system.points
        if stamped_point.point.x
    ]
    accounts = {connection: system.account(connection) for connection in ("point_up", "speed_up")}
    acks = [packet for packet in peer.look() if packet.acknowledge is AckNak.ACK]
    acknowledged = [ack.sequence - first & 0xFFFF for ack in acks]
    return points, [repr(velocity) for velocity in speeds], acknowledged, accounts


@pytest.mark.slow
@pytest.mark.parametrize("seed", sweep([1, 2], every=2))
def test_both_forms_do_the_same_with_whatever_comes(path, tmp_path, monkeypatch, seed):
    found = []
    for is_compiled in (False, True):
        with running(path, tmp_path / f"{is_compiled}.log", monkeypatch, is_compiled) as system:
            first = len(system.points)
            found.append(run(system, seed))
            if is_compiled:
                enough = (len(system.points) - first) / 3
                wait_for(lambda: system.alone("point_up") > enough, "messages of the core")  # noqa: B023
            else:
                assert system.alone("point_up") == 0
    assert found[0] == found[1]


@pytest.mark.slow
def test_nothing_that_was_sent_before_a_stop_is_obeyed_after_it(system):
    """The stop is acknowledged; what it must not be undone by is acknowledged, or is not."""
    from std_msgs.msg import Float64

    def send(share, **options):
        peer.send(struct.pack("<Hd", 0xD105, share), **options)

    def is_reached():
        send(0.5)
        return brakes

    peer, brakes = system.peer, system.ros.listen_to_publisher(Float64, "brake_up", 1000)
    peer.send(RequestControl(authority_code=255).encode())
    peer.send(Resume().encode())
    wait_for(is_reached, "first command")
    for step in range(10):
        send(float(step))
        late, late_too = peer.number + 1, peer.number + 2
        peer.number += 2
        send(0.0, acknowledge=AckNak.REQUESTED)
        send(19.0, number=late, acknowledge=AckNak.REQUESTED)
        send(-19.0, number=late_too)
        send(99.0)
        wait_for(lambda: brakes[-1].data == 99.0, "command")
        brakes_since = [brake.data for brake in list(brakes) if brake.data != 0.5]
        assert brakes_since == [float(step), 0.0, 99.0]
        brakes.clear()
        send(0.5)
        wait_for(lambda: brakes, "command")
    if system.is_compiled:
        wait_for(lambda: system.alone("brake_up") >= 5, "messages of the core")


def packets_of_scan(peer, size):
    """The distances of a scan, and the packets of its message."""
    ranges = [7 * at % 60000 for at in range(size)]
    payload = struct.pack(f"<HH{size}H", 0xD104, size, *ranges)
    parts = [payload[at : at + 4000] for at in range(0, len(payload), 4000)]
    places = [DataFlags.FIRST, *[DataFlags.MIDDLE] * (len(parts) - 2), DataFlags.LAST]
    first = peer.number + 1
    peer.number += len(parts)
    return [distance * 0.001 for distance in ranges], [
        Packet(BRIDGE, PEER, part, first + at, Priority.STANDARD, data_flags=places[at])
        for at, part in enumerate(parts)
    ]


def test_messages_of_several_packets(system):
    from sensor_msgs.msg import LaserScan

    def send(packets):
        for packet in packets:
            system.peer.sock.sendto(packet.encode(), system.peer.bridge)

    def is_reached():
        send(packets_of_scan(system.peer, 2500)[1])
        return scans

    scans = system.ros.listen_to_publisher(LaserScan, "scan_up", 1000)
    wait_for(is_reached, "first scan")
    send(packets_of_scan(system.peer, 2600)[1])
    wait_for(lambda: len(scans[-1].ranges) == 2600, "last of the first ones")
    first, wanted = len(scans), []
    for step in range(20):
        ranges, sent = packets_of_scan(system.peer, 3000 + 100 * step)
        if step % 4 == 1:
            sent[0], sent[1] = sent[1], sent[0]  # they overtake each other
        if step % 4 == 2:
            sent.insert(1, sent[0])
        if step % 4 == 3:
            del sent[1]
        else:
            wanted.append(ranges)
        send(sent)
        wait_for(lambda: len(scans) == first + len(wanted), "scan")
    for scan, ranges in zip(scans[first:], wanted, strict=True):
        assert list(scan.ranges) == pytest.approx(ranges, abs=1e-4)
    if system.is_compiled:
        wait_for(lambda: system.alone("scan_up") >= 3, "messages of the core")
    else:
        assert system.alone("scan_up") == 0


@pytest.mark.slow
def test_a_parameter_counts_from_the_next_message_on(system):
    from rcl_interfaces.srv import ListParameters

    def said(vx):
        before = len(system.speeds)
        system.peer.send(speed(vx))
        wait_for(lambda: len(system.speeds) > before, "speed")
        return system.speeds[-1].twist.linear.x

    assert [said(vx) for vx in (1.0, 2.0, 3.0, 25.0, 4.0)] == [1.0, 2.0, 3.0, 20.0, 4.0]
    names = system.call(ListParameters, "list_parameters", ListParameters.Request()).result.names
    (name,) = [parameter_name for parameter_name in names if parameter_name.endswith("max_speed")]
    assert system.ros.set_parameter("/fast", name, 2.5).successful
    assert [said(vx) for vx in (1.0, 3.0, 2.0, 25.0)] == [1.0, 2.5, 2.0, 2.5]
    if system.is_compiled:
        wait_for(lambda: system.alone("speed_up") >= 4, "messages of the core")


@pytest.mark.slow
def test_nothing_passes_once_the_bridge_is_inactive(system):
    from lifecycle_msgs.msg import Transition
    from lifecycle_msgs.srv import ChangeState

    sent, ended = [0], threading.Event()

    def flood():
        while not ended.wait(0.001):
            sent[0] += 1
            system.peer.send(point(float(sent[0]), sec=9))

    def change(transition):
        asked = ChangeState.Request(transition=Transition(id=transition))
        assert system.call(ChangeState, "change_state", asked).success

    def latest():
        return system.points[-1].point.x

    flooding = threading.Thread(target=flood)
    flooding.start()
    try:
        for _ in range(3):
            before = latest()
            wait_for(lambda before=before: latest() > before + 50, "points")
            change(Transition.TRANSITION_DEACTIVATE)
            last = sent[0]
            wait_for(lambda last=last: sent[0] > last + 200, "points that do not pass")
            assert latest() <= last
            change(Transition.TRANSITION_ACTIVATE)
            wait_for(lambda last=last: latest() > last + 200, "points")
    finally:
        ended.set()
        flooding.join()
    if system.is_compiled:
        wait_for(lambda: system.alone("point_up") > 100, "messages of the core")


@pytest.mark.slow
def test_a_latency_that_is_wanted_is_measured_in_python(system):
    def pass_on(count):
        for _ in range(count):
            before = len(system.points)
            system.peer.send(point(1.0))
            wait_for(lambda before=before: len(system.points) > before, "point")
        system.account("point_up")
        return system.alone("point_up")

    assert (pass_on(5) > 0) is system.is_compiled
    assert system.ros.set_parameter("/fast", "point_up.latency", value=True).successful
    alone = system.alone("point_up")
    assert pass_on(5) == alone


def numbered(packets):
    """The steps between the numbers of packets, whichever of two came first.

    A sender that moves to another processor may be overtaken by itself, on loopback too.
    """
    first = packets[0].sequence - 0x8000
    numbers = sorted(packet.sequence - first & 0xFFFF for packet in packets)
    return {later - earlier for earlier, later in pairwise(numbers)}


def test_what_is_sent_is_numbered_with_what_python_sends(system):
    from geometry_msgs.msg import PointStamped
    from sensor_msgs.msg import LaserScan

    points = system.ros.publisher(PointStamped, "point_down", 1000)
    scans = system.ros.publisher(LaserScan, "scan_down", 1000)
    system.peer.look()
    wanted = []
    for step in range(60):
        message = PointStamped()
        message.header.stamp.sec, message.point.x, message.point.y = step, step / 4, -2.0
        points.publish(message)
        wanted.append(point(step / 4, 2.0, step, 0))
        if step % 10 == 5:
            message.point.x = float("nan")  # it has no counterpart, and is not sent
            points.publish(message)
        if step % 10 == 7:
            size = (10, 20, 30, 40, 5000, 9000)[step // 10]
            scans.publish(LaserScan(ranges=[number % 60 + 0.25 for number in range(size)]))
        wait_for(lambda: len(system.peer.of_code(0xD101)) == len(wanted), "point")
    assert [payload for payload, _ in system.peer.of_code(0xD101)] == wanted
    parts = lambda: [packet for packet in system.peer.look() if packet.data_flags]  # noqa: E731
    wait_for(lambda: len(parts()) == 3 + 5, "parts")
    assert [int(part.data_flags) for part in parts()] == [1, 2, 3, 1, 2, 2, 2, 3]
    assert sum(len(part.payload) for part in parts()) == 2 * (2 + 2) + 2 * (5000 + 9000)
    assert numbered([packet for packet in system.peer.came if packet.acknowledge < AckNak.NAK]) <= {
        0,
        1,
    }
    if system.is_compiled:
        wait_for(lambda: system.alone("point_down") >= 50, "messages of the core")
        wait_for(lambda: system.alone("scan_down") >= 2, "scans of the core")
    else:
        assert system.alone("point_down") == 0


def test_reports_of_an_event_and_what_is_lost_of_them(system):
    confirmed(system)
    first = len(system.reports)
    for step in range(40):
        if step % 10 == 9:
            system.peer.reports += 2  # lost on the way
        if step % 10 == 4:
            system.peer.reports -= 1  # one comes again, as an old one
            system.peer.send_report(report(-1.0))
        system.peer.send_report(report(float(step), 1.0))
        wait_for(lambda step=step: len(system.reports) == first + step + 1, "report")
    assert [received_report.x for received_report in system.reports[first:]] == [
        float(number) for number in range(40)
    ]
    system.account("report_up")
    values = system.ros.values("report_up")
    assert values["lost on the way"] == "8"
    assert values["out of order"] == "4"
    if system.is_compiled:
        wait_for(lambda: system.alone("report_up") >= 25, "messages of the core")


@pytest.mark.slow
def test_a_peer_that_moves_is_followed(system):
    for step in range(5):
        system.peer.send(point(float(step)))
    wait_for(lambda: system.points[-1].point.x == 4.0, "points")
    former = system.peer.sock
    system.peer.open()
    system.peer.number += 1000
    for step in range(5, 10):
        system.peer.send(point(float(step)))
    wait_for(lambda: system.points[-1].point.x == 9.0, "points")
    from geometry_msgs.msg import PointStamped

    points = system.ros.publisher(PointStamped, "point_down", 1000)
    for _ in range(3):
        points.publish(PointStamped())
    wait_for(lambda: len(system.peer.of_code(0xD101)) == 3, "what is sent to its new place")
    came = []
    with suppress(BlockingIOError):
        while True:
            came.append(former.recv(65536)[13:15])
    assert b"\x01\xd1" not in came
    former.close()
