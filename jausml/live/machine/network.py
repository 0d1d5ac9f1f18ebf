"""The network of JAUS on this machine: interface, multicast, port, node manager (AS5669A)."""

from __future__ import annotations

import errno
import secrets
import socket
from contextlib import closing
from ipaddress import IPv4Address
from pathlib import Path
from typing import TYPE_CHECKING

from jausml.live.machine.finding import Finding, Outcome
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.transports.ports import holders, manager_folder

if TYPE_CHECKING:
    from collections.abc import Iterator

_TOPIC = "network"
_PATIENCE = 1.0
"""Seconds that the own datagram has to come back."""
_LIMIT = Path("/proc/sys/net/core/rmem_max")


def settings_of(interface: str, port: int, multicast_group: str) -> TransportSettings:
    """Returns settings of a transport.

    Raises:
        ValueError: A value means nothing; the message says which.
    """
    return TransportSettings(interface=interface, port=port, multicast_group=multicast_group)


def checks(settings: TransportSettings) -> Iterator[Finding]:
    """Yields what is to be said of the network; sends one datagram to a port of its own."""
    interface = _interface(settings)
    yield interface
    manager = manager_folder(settings)
    if interface.verdict is not Outcome.ERROR:
        yield _multicast(settings)
        for protocol in ("udp", "tcp"):
            yield _port(settings, protocol, has_manager=manager is not None)
    if manager is not None:
        text = f"a node manager runs, its socket is in {manager}"
        cure = "to speak through it: --jaus-transport node-manager"
        yield Finding(_TOPIC, "node manager", Outcome.NOTE, text, cure)
    else:
        yield Finding(_TOPIC, "node manager", Outcome.OK, "none runs on this host")
    yield from _buffer(settings.receive_buffer)


def _interface(settings: TransportSettings) -> Finding:
    address = settings.interface
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind((address, 0))
        except OSError as error:
            cure = "name an address of this host by --interface; `ip -4 address` lists them"
            return Finding(_TOPIC, "interface", Outcome.ERROR, f"{address}: {error.strerror}", cure)
    if IPv4Address(address).is_loopback:
        text = f"{address} is this host alone"
        cure = "name the interface of the vehicle's network by --interface"
        return Finding(_TOPIC, "interface", Outcome.NOTE, text, cure)
    return Finding(_TOPIC, "interface", Outcome.OK, f"{address} is an address of this host")


def _multicast(settings: TransportSettings) -> Finding:
    group = settings.multicast_group
    try:
        came = _comes_back(settings)
    except OSError as error:
        reason = f"{group} on {settings.interface}: {error.strerror}"
    else:
        if came:
            text = f"a datagram to {group} on {settings.interface} comes back"
            return Finding(_TOPIC, "multicast", Outcome.OK, text)
        reason = f"a datagram to {group} on {settings.interface} does not come back"
    cure = (
        "look at the firewall, and at `ip link`: the interface needs MULTICAST (for loopback"
        " `ip link set lo multicast on`); without multicast name peers by --jaus-peer"
    )
    return Finding(_TOPIC, "multicast", Outcome.WARNING, reason, cure)


def _comes_back(settings: TransportSettings) -> bool:
    interface = socket.inet_aton(settings.interface)
    word = secrets.token_bytes(16)
    with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as sock:
        sock.settimeout(_PATIENCE)
        sock.bind(("", 0))
        joined = socket.inet_aton(settings.multicast_group) + interface
        sock.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, joined)
        sock.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, interface)
        sock.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        sock.sendto(word, (settings.multicast_group, sock.getsockname()[1]))
        try:
            return sock.recv(len(word)) == word
        except TimeoutError:
            return False


def _port(settings: TransportSettings, protocol: str, *, has_manager: bool) -> Finding:
    name = f"{protocol} port {settings.port}"
    kind = socket.SOCK_DGRAM if protocol == "udp" else socket.SOCK_STREAM
    with socket.socket(socket.AF_INET, kind) as probe:
        try:
            probe.bind((settings.interface, settings.port))
        except OSError as error:
            if error.errno != errno.EADDRINUSE:
                cure = "take another port by --port"
                return Finding(_TOPIC, name, Outcome.ERROR, str(error.strerror), cure)
            known = " and ".join(map(str, holders(protocol, settings.port)))
            text = f"held by {known or 'a program that cannot be seen'}"
            cure = (
                "programs of jausml share it; beside a node manager: --jaus-transport node-manager"
                if protocol == "udp" or has_manager
                else "only one program of a host can have it: --jaus-port takes another"
            )
            return Finding(_TOPIC, name, Outcome.WARNING, text, cure)
    return Finding(_TOPIC, name, Outcome.OK, "free")


def _buffer(wanted: int) -> Iterator[Finding]:
    try:
        limit = int(_LIMIT.read_text("ascii"))
    except (OSError, ValueError):
        return
    name, text = "receive buffer", f"the kernel grants {limit:,} bytes to a socket"
    if limit >= wanted:
        yield Finding(_TOPIC, name, Outcome.OK, text)
        return
    cure = f"sysctl -w net.core.rmem_max={wanted}: else bursts of large messages may be lost"
    yield Finding(_TOPIC, name, Outcome.NOTE, text, cure)
