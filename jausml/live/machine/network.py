"""Checks of the network of JAUS: interface, multicast, ports, node managers and buffers."""

from __future__ import annotations

import errno
import secrets
import socket
from collections.abc import Iterator
from contextlib import closing
from ipaddress import IPv4Address
from pathlib import Path

from jausml.live.machine.findings import Finding, Verdict
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.transports.ports import holders, manager_folder

_PATIENCE = 1.0  # seconds that the own datagram has to come back
_BUFFER_LIMIT = Path("/proc/sys/net/core/rmem_max")


def network_checks(settings: TransportSettings) -> Iterator[Finding]:
    """Yields the findings about the network; sends one datagram to a port of its own."""
    interface = _interface(settings)
    yield interface
    manager = manager_folder(settings)
    if interface.verdict is not Verdict.ERROR:
        yield _multicast(settings)
        for protocol in ("udp", "tcp"):
            yield _port(settings, protocol, has_manager=manager is not None)
    if manager is not None:
        text = f"a node manager runs, its socket is in {manager}"
        cure = "to speak through it: --jaus-transport node-manager"
        yield Finding("network", "node manager", Verdict.NOTE, text, cure)
    else:
        yield Finding("network", "node manager", Verdict.OK, "none runs on this host")
    yield from _buffer(settings.receive_buffer)


def _interface(settings: TransportSettings) -> Finding:
    address = settings.interface
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind((address, 0))
        except OSError as error:
            cure = "name an address of this host by --interface; `ip -4 address` lists them"
            text = f"{address}: {error.strerror}"
            return Finding("network", "interface", Verdict.ERROR, text, cure)
    if IPv4Address(address).is_loopback:
        text = f"{address} is this host alone"
        cure = "name the interface of the vehicle's network by --interface"
        return Finding("network", "interface", Verdict.NOTE, text, cure)
    return Finding("network", "interface", Verdict.OK, f"{address} is an address of this host")


def _multicast(settings: TransportSettings) -> Finding:
    group = settings.multicast_group
    try:
        if _comes_back(settings):
            text = f"a datagram to {group} on {settings.interface} comes back"
            return Finding("network", "multicast", Verdict.OK, text)
        reason = f"a datagram to {group} on {settings.interface} does not come back"
    except OSError as error:
        reason = f"{group} on {settings.interface}: {error.strerror}"
    cure = (
        "look at the firewall, and at `ip link`: the interface needs MULTICAST (for loopback"
        " `ip link set lo multicast on`); without multicast name peers by --jaus-peer"
    )
    return Finding("network", "multicast", Verdict.WARNING, reason, cure)


def _comes_back(settings: TransportSettings) -> bool:
    """Whether a datagram to the multicast group, which does not leave the host, is received."""
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
                return Finding("network", name, Verdict.ERROR, str(error.strerror), cure)
            programs = " and ".join(map(str, holders(protocol, settings.port)))
            text = f"held by {programs or 'a program that cannot be seen'}"
            cure = (
                "programs of jausml share it; beside a node manager: --jaus-transport node-manager"
                if protocol == "udp" or has_manager
                else "only one program of a host can have it: --jaus-port takes another"
            )
            return Finding("network", name, Verdict.WARNING, text, cure)
    return Finding("network", name, Verdict.OK, "free")


def _buffer(wanted: int) -> Iterator[Finding]:
    try:
        limit = int(_BUFFER_LIMIT.read_text("ascii"))
    except (OSError, ValueError):
        return
    name, text = "receive buffer", f"the kernel grants {limit:,} bytes to a socket"
    if limit >= wanted:
        yield Finding("network", name, Verdict.OK, text)
        return
    cure = f"sysctl -w net.core.rmem_max={wanted}: else bursts of large messages may be lost"
    yield Finding("network", name, Verdict.NOTE, text, cure)
