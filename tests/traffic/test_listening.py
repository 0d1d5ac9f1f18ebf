"""Listening to multicast on loopback, without taking part."""

import socket
import sys

import pytest
from capture_files import QUERY_STATUS
from network_hosts import NetworkHost
from ports import free_port

from jausml.live.traffic.captures import TrafficError
from jausml.live.traffic.listening import MulticastListener
from jausml.runtime.base.settings import TransportSettings

pytestmark = pytest.mark.ports

GROUP, LOOPBACK = "239.255.0.1", "127.0.0.1"


@pytest.fixture
def settings():
    return TransportSettings(interface=LOOPBACK, port=free_port(), multicast_group=GROUP)


@pytest.fixture
def sender():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton(LOOPBACK))
        sock.bind((LOOPBACK, 0))
        yield sock


def test_what_is_sent_to_the_group_is_heard(settings, sender):
    with MulticastListener(settings) as first, MulticastListener(settings) as second:
        sender.sendto(QUERY_STATUS, (GROUP, settings.port))
        for listener in (first, second):
            datagram = next(listener.datagrams(duration=10))
            assert datagram.data == QUERY_STATUS
            assert datagram.source == sender.getsockname()
            assert datagram.destination == (GROUP, settings.port)
            assert datagram.time is not None


def test_the_port_remains_free_for_those_who_take_part(settings):
    with MulticastListener(settings), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as component:
        component.bind((LOOPBACK, settings.port))


def test_it_ends_after_the_duration(settings):
    with MulticastListener(settings) as listener:
        assert list(listener.datagrams(duration=0.01)) == []
        assert list(listener.datagrams(duration=0)) == []


REPLUGGED = """
import socket, subprocess, sys, threading
from jausml.live.traffic.listening import MulticastListener
from jausml.runtime.base.settings import TransportSettings

def ip(words):
    subprocess.run(["ip", *words.split()], check=True)

def plug():
    ip("link add wire type veth peer name other")
    ip("address add 192.0.2.1/24 dev wire")
    for name in ("wire", "other"):
        ip(f"link set {name} up")

def speak():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        interface = socket.inet_aton(settings.interface)
        sock.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, interface)
        while not heard.wait(0.2):
            sock.sendto(b"hello", (settings.multicast_group, settings.port))

settings, heard = TransportSettings(interface="192.0.2.1"), threading.Event()
plug()
with MulticastListener(settings) as listener:
    ip("link delete wire")
    plug()
    threading.Thread(target=speak).start()
    datagram = next(listener.datagrams(duration=60), None)
    heard.set()
sys.exit(datagram is None)
"""


@pytest.mark.needs("namespaces of networks")
def test_an_interface_that_is_removed_and_comes_back_is_heard_again():
    host = NetworkHost("192.0.2.1")
    try:
        host.run(sys.executable, "-c", REPLUGGED)
    finally:
        host.close()


def test_an_interface_that_is_not_there(settings):
    # 192.0.2.0/24 is for documentation (RFC 5737): no host has it.
    absent = TransportSettings(interface="192.0.2.1", port=settings.port, multicast_group=GROUP)
    with pytest.raises(TrafficError, match=r"cannot listen to 239\.255\.0\.1:.* 192\.0\.2\.1"):
        MulticastListener(absent)
