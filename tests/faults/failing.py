"""Faults: what fails, for how long, and what is seen of it."""

import random
import signal
import struct
import time
from collections.abc import Callable
from contextlib import contextmanager
from dataclasses import dataclass, field
from socket import AF_INET, SOCK_DGRAM, socket

from ports import free_port

from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.clients.control_state import ControlState
from jausml.runtime.component.component import JausComponent
from jausml.runtime.component.process import running_transport
from jausml.runtime.messages import ClearEmergency, SetEmergency
from jausml.runtime.transports.packets.packet import Packet
from tests.live.bridge_support import wait_for

from .accounts import adds_up, books
from .rover_system import COMMANDS, STALE, System

BRIDGE, VEHICLE, RIVAL = JausAddress(10, 1, 9), JausAddress(10, 1, 1), JausAddress(30, 1, 1)


@dataclass(frozen=True)
class Fault:
    """Something that fails.

    Attributes:
        name: What the table calls it.
        during: A context in which it lasts.
        seconds: How long, once all stops stand.
        stops: Connections on whose other side a stop stands meanwhile.
        flows: Whether all connections go on meanwhile.
        unread: The role that threw away what it had not read, once it was no longer halted.
        is_forged: Whether others use the ids of peers, so that the account of these means nothing.
    """

    name: str
    during: Callable[[System], object]
    seconds: float = 1.0
    stops: tuple[str, ...] = ()
    flows: bool = False
    unread: str = ""
    is_forged: bool = False
    marks: tuple[object, ...] = field(default=())


@contextmanager
def killed(system, role):
    system.kill(role)
    yield
    system.start(role)


@contextmanager
def ended(system, role):
    system.end(role)
    yield
    system.start(role)


@contextmanager
def halted(system, role):
    system.signal(role, signal.SIGSTOP)
    yield
    system.signal(role, signal.SIGCONT)


@contextmanager
def network(system, **fate):
    system.network.fare(**fate)
    yield
    system.network.fare()


class Rival(JausComponent):
    """Takes over, and sets emergencies."""

    def __init__(self, transport):
        super().__init__(transport, RIVAL, name="rival", services=())


@contextmanager
def rival(system):
    places = {
        BRIDGE: ("127.0.0.1", system.network.ports["bridge"]),
        VEHICLE: ("127.0.0.1", system.network.ports["vehicle"]),
    }
    settings = TransportSettings(port=free_port(), address_book=places)
    with running_transport(settings) as transport:
        component = Rival(transport)
        component.start()
        yield component
        component.stop()


@contextmanager
def preempted(system, peer):
    with rival(system) as component:
        with component.loop.lock:
            session = component.control(peer, authority=250)
        wait_for(lambda: session.state is ControlState.READY, "control")
        yield
        with component.loop.lock:
            session.release()


@contextmanager
def emergency(system, peer):
    with rival(system) as component:
        component.send(SetEmergency(emergency_code=1), peer)
        yield
        component.send(ClearEmergency(emergency_code=1), peer)
        time.sleep(0.2)


@contextmanager
def nonsense(system):
    """Sends to all what nobody understands, from a stranger and in the name of the peers."""
    rng = random.Random(11)
    names = (VEHICLE, JausAddress(20, 1, 1), JausAddress(99, 9, 9))
    with socket(AF_INET, SOCK_DGRAM) as sock:
        for number in range(1000):
            body = rng.randbytes(rng.randrange(40))
            good = Packet(BRIDGE, rng.choice(names), body, number).encode()
            codes = struct.pack("<H", rng.choice((0x0D00, 0x2402, 0x0405, 0x41F1, 0x41F2, 0x00F0)))
            known = Packet(BRIDGE, names[2], codes + body, number).encode()
            version = bytes([good[0] ^ rng.randrange(1, 255)]) + good[1:]
            for data in (rng.randbytes(rng.randrange(1, 200)), good, known, version, good[:9]):
                sock.sendto(data, ("127.0.0.1", rng.choice(list(system.network.ports.values()))))
    yield


def suffer(system, fault):
    """Lets a fault happen; returns seconds until stop and recovery by connection."""
    system.flows(time.monotonic())
    before = None if fault.is_forged else books(system)
    system.flows(time.monotonic())
    began = time.monotonic()
    with fault.during(system):
        lasts = time.monotonic() + fault.seconds
        stopped = {stop: system.stops(stop, began) for stop in fault.stops}
        if fault.flows:
            system.flows(time.monotonic())
        time.sleep(max(0.0, lasts - time.monotonic()))
        standing = [stop for stop in fault.stops if system.arrivals(stop)[-1]["value"]]
        assert not standing, "moves again while the fault lasts"
    ended_at = time.monotonic()
    recovered = system.flows(ended_at)
    stale = {command: system.oldest(command, began) for command in COMMANDS}
    assert max(stale.values()) < STALE, stale
    after = None if before is None else books(system)
    packets = {} if before is None or after is None else adds_up(before, after, fault.unread)
    return {
        "packets": packets,
        "oldest": {command: round(system.oldest(command, began), 2) for command in COMMANDS},
        "stopped": {connection: round(seconds, 2) for connection, seconds in stopped.items()},
        "recovered": {connection: round(seconds, 2) for connection, seconds in recovered.items()},
    }
