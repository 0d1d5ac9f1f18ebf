"""What strangers on the network can take from honest operators: nothing that matters.

All is counted against what an honest operator does itself meanwhile, so that a busy computer does
not fail it. Hosts are addresses of the loopback interface, treated as if they were elsewhere.
"""

import contextlib
import threading

import pytest
from ports import free_port
from stranger import ROBOT, Stranger, event

from jausml.runtime import ComponentSettings, JausComponent
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.loop import Loop
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.component.process import create_transport
from jausml.runtime.messages import QueryStatus, ReportStatus, SetEmergency
from jausml.runtime.services.definitions import Status
from jausml.runtime.transports.udp import datagrams
from tests.live.bridge_support import wait_for
from tests.runtime.services.state_tables import V1_1, core_services

pytestmark = pytest.mark.slow

RATE = 20.0
TICKS = 60
"""What an operator counts to: three seconds at its rate."""

SERVICES = core_services(
    V1_1, "Transport", "Events", "AccessControl", "Management", "Discovery", "Liveness"
)
BEFORE, LATE = JausAddress(20, 1, 1), JausAddress(21, 1, 1)
HOSTS = {"robot": "127.0.0.1", BEFORE: "127.0.0.2", LATE: "127.0.0.3", "elsewhere": "127.0.0.9"}
IDENTITIES = [JausAddress(1000 + number, 1, 1) for number in range(255)]

ATTACKS = {
    "forged address": ("127.0.0.9", False),
    "forged address of the host of the late one": (HOSTS[LATE], False),
    "one that acknowledges": ("127.0.0.9", True),
    "one that acknowledges on the host of the late one": (HOSTS[LATE], True),
}


class Operator(JausComponent):
    """Wants the status twenty times a second, and counts as often how much it got."""

    reports = ticks = 0

    def watch(self) -> None:
        self.subscribe(ROBOT, QueryStatus(), ReportStatus, self.seen, rate=RATE)

    def seen(self, _report, _sender) -> None:
        self.reports += 1

    def count(self) -> None:
        """Begins to count, from none."""
        self.reports = self.ticks = 0
        self.loop.call_soon(self.tick)

    def tick(self) -> None:
        self.ticks += 1
        if self.ticks < TICKS:
            self.loop.call_later(1 / RATE, self.tick)


@pytest.fixture(autouse=True)
def outside(monkeypatch):
    monkeypatch.setattr(datagrams, "LOOPBACK", "nowhere")


@pytest.fixture
def port():
    return free_port()


@pytest.fixture
def start(port):
    """Starts components, each with a loop and a transport of its own."""
    with contextlib.ExitStack() as stack:

        def make(address, host, kind=JausComponent, **settings):
            loop = Loop()
            transport = create_transport(
                TransportSettings(
                    interface=host,
                    port=port,
                    address_book={} if address == ROBOT else {ROBOT: (HOSTS["robot"], port)},
                    **settings,
                ),
                loop,
            )
            transport.open()
            loop.start()
            made = kind(
                transport,
                address,
                name="tested",
                services=SERVICES,
                settings=ComponentSettings(register_services=False, refused_retry=0.5),
            )
            made.start()
            stack.callback(loop.stop)
            stack.callback(transport.close)
            stack.callback(made.stop)
            return made

        yield make


@pytest.fixture
def robot(start):
    return start(ROBOT, HOSTS["robot"])


@pytest.fixture
def stranger(port):
    with contextlib.ExitStack() as stack:

        def make(host, *, acknowledges):
            made = Stranger(port, host, acknowledges=acknowledges)
            stack.callback(made.sock.close)
            # Else the kernel throws away what there is no room for, and nobody knows how much came.
            stack.enter_context(made.taking())
            return made

        yield make


def counted(*operators):
    """Has operators count; returns the share of its reports that each one got."""
    for operator in operators:
        operator.count()
    for operator in operators:
        wait_for(lambda each=operator: each.ticks == TICKS, "end of the count", 60)
    return [operator.reports / operator.ticks for operator in operators]


def a_late_one_is_served(start, robot, before):
    """Has one come while an attack goes on: it hears as much as the other, and stops the robot."""
    late = start(LATE, HOSTS[LATE], Operator)
    late.watch()
    wait_for(lambda: late.reports, "first report of the late one", 30)
    shares = counted(before, late)
    assert min(shares) >= 0.9, shares
    late.send(SetEmergency(emergency_code=1), ROBOT, acknowledge=True)  # much is dropped
    wait_for(lambda: robot.status is Status.EMERGENCY, "stop", 30)


@pytest.mark.parametrize("attack", ATTACKS)
def test_events_of_invented_ids(robot, start, stranger, attack):
    """255 requests of the fastest event: they are a flood for nobody, and keep nobody out."""
    host, acknowledges = ATTACKS[attack]
    before = start(BEFORE, HOSTS[BEFORE], Operator)
    before.watch()
    wait_for(lambda: before.reports, "first report")
    attacker = stranger(host, acknowledges=acknowledges)
    for number, address in enumerate(IDENTITIES):
        attacker.send(address, event(1092.0), number)
    wait_for(lambda: len(robot.transport.address_book.learnt) > 200, "arrival of the attack")
    a_late_one_is_served(start, robot, before)
    if not acknowledges:
        assert 0 < attacker.received <= 3 * attacker.sent


@pytest.mark.parametrize("fixed", [False, True], ids=["newest", "fixedSources"])
def test_more_ids_than_an_address_book_holds(start, stranger, fixed):
    """Who comes late is heard, and can stop the robot, while they come again and again."""
    robot = start(ROBOT, HOSTS["robot"], fixed_sources=fixed)
    before = start(BEFORE, HOSTS[BEFORE], Operator)
    before.watch()
    wait_for(lambda: before.reports, "first report")
    attacker = stranger(HOSTS["elsewhere"], acknowledges=True)
    ended = threading.Event()

    def flood():
        number = 0
        while not ended.wait(0.05):
            for _ in range(100):
                number += 1
                address = JausAddress(1000 + number % 1100, 1, 1)
                attacker.send(address, QueryStatus().encode(), number & 0xFFFF)

    flooding = threading.Thread(target=flood)
    flooding.start()
    try:
        full = "transport.address_book_full"
        wait_for(lambda: robot.counters.snapshot().get(full), "a full address book", 60)
        a_late_one_is_served(start, robot, before)
    finally:
        ended.set()
        flooding.join()
