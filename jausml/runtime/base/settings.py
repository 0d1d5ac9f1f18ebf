"""Settings of the transport and the command line options that set them."""

from __future__ import annotations

import argparse
import ipaddress
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Any

from .address import JausAddress

JUDP_PORT = 3794  # port of JAUS over UDP (IANA; AS5669A)
JUDP_GROUP = "239.255.0.1"  # multicast group of JAUS over UDP (AS5669A)
# Largest payload of one packet in bytes; Junior's receive buffer cuts longer datagrams.
MAX_FRAGMENT_SIZE = 4079
# Least limit that lets a peer prove itself: the question, one repetition, and acknowledgements.
LEAST_AMPLIFICATION = 3
LEAST_CONNECTIONS = 4  # least number of JTCP connections with which a process can work

# Least and greatest values of settings.
LIMITS: dict[str, tuple[float, float]] = {
    "port": (1, 65535),
    "multicast_ttl": (0, 255),
    "acknowledge_retries": (0, 100),
    "fragment_size": (2, MAX_FRAGMENT_SIZE),
    "duplicate_history": (1, 32767),
    "reassembly_limit": (MAX_FRAGMENT_SIZE, 1 << 30),
    "acknowledge_timeout": (0.001, 60),
    "duplicate_window": (0, 60),
    "reassembly_timeout": (0.01, 60),
    "address_lifetime": (0.1, 86400),
    "send_buffer": (0, 1 << 30),
    "connection_timeout": (0.01, 600),
    "standstill": (0, 3600),
    "amplification_limit": (0, 1000),
    "max_peers": (16, 65535),
    "max_connections": (LEAST_CONNECTIONS, 4096),
    "idle_timeout": (0, 86400),
    "takeover_interval": (0.05, 60),
}

Endpoint = tuple[str, int]  # IPv4 address (or host name in static entries) and UDP port


class TransportKind(Enum):
    """Transports for the messages of a process (AS5669A)."""

    JUDP = "judp"  # datagrams (UDP); peers find each other by multicast
    JTCP = "jtcp"  # connections (TCP); peers are those of the address book and those that connect
    NODE_MANAGER = "node-manager"  # through the node manager of the host, which owns the port


@dataclass(frozen=True)
class TransportSettings:
    """How a process reaches its peers (AS5669A).

    Attributes:
        interface: IPv4 address of the one network interface to use.
        port: UDP or TCP port shared with every peer.
        multicast_group: IPv4 group for wildcard destinations and for discovery.
        multicast_ttl: Routers that a multicast may pass, 0 to 255.
        address_book: Endpoints of known components; one learnt from datagrams takes precedence,
            since a component may move to another host.
        acknowledge_timeout: Seconds to wait for an acknowledgement before a repetition.
        acknowledge_retries: Repetitions of an unacknowledged packet.
        fragment_size: Payload of one packet in bytes, 2 to 4079; larger only for a message of
            more than 40 packets, and for a broadcast.
        duplicate_window: Seconds in which the same packet with the same number is a repetition;
            below 2, after which a restarted component on Junior is back with the number 1.
        duplicate_history: Packets remembered for each source.
        reassembly_timeout: Seconds without progress after which fragments are discarded.
        reassembly_limit: Bytes of incomplete fragments kept of one source for one destination;
            four times as many are kept in total.
        address_lifetime: Seconds of silence after which a learnt endpoint is doubted: the next
            message is followed by a multicast query for the peer.
        takeover_interval: Seconds between two attempts to own the shared port.
        standstill: Seconds that the process may stand still; after more, the datagrams that wait
            in its UDP sockets are dropped, as their age is unknown; 0 keeps them.
        receive_buffer: Bytes that the kernel may hold for one socket.
        send_buffer: Bytes that may wait for a slow JTCP peer.
        connection_timeout: Seconds in which a JTCP connection must be made, and in which a peer
            must take some of the bytes that wait for it.
        node_manager_directory: Folder of the local sockets of a node manager and its
            components; the system's folder for temporary files when empty.
        allowed_hosts: IPv4 addresses and networks, e.g. `10.0.0.0/24`, from which packets are
            taken besides the interface itself; any when empty.
        fixed_sources: Whether packets of a component are taken from one endpoint only, until that
            was silent for `address_lifetime` (JTCP: has closed).
        amplification_limit: Bytes that are sent to a UDP endpoint for each byte from it, until it
            has acknowledged an unguessable number; 0 for no limit, and no such proof.
        max_peers: Components that are remembered, 16 to 65535, besides those of the address book
            and those in control.
        max_connections: JTCP connections at a time, 4 to 4096, and no more than the descriptors of
            the process allow. When all are taken, an unused one gives way, then one of the host
            with the most.
        idle_timeout: Seconds in which the first whole message must arrive over a JTCP connection
            that a peer has made; 0 for any time. Later, TCP itself notices a dead peer.

    Raises:
        ValueError: A value is out of its range.
    """

    interface: str = "127.0.0.1"
    port: int = JUDP_PORT
    multicast_group: str = JUDP_GROUP
    multicast_ttl: int = 16
    address_book: Mapping[JausAddress, Endpoint] = field(default_factory=dict)
    acknowledge_timeout: float = 0.1
    acknowledge_retries: int = 3
    fragment_size: int = MAX_FRAGMENT_SIZE
    duplicate_window: float = 1.5
    duplicate_history: int = 512
    reassembly_timeout: float = 3.0
    reassembly_limit: int = 4 << 20
    address_lifetime: float = 10.0
    takeover_interval: float = 1.0
    standstill: float = 2.0
    receive_buffer: int = 1 << 20
    transport: TransportKind = TransportKind.JUDP
    send_buffer: int = 1 << 20
    connection_timeout: float = 5.0
    node_manager_directory: str = ""
    allowed_hosts: tuple[str, ...] = ()
    fixed_sources: bool = False
    amplification_limit: int = 3
    max_peers: int = 1024
    max_connections: int = 256
    idle_timeout: float = 60.0

    def __post_init__(self) -> None:
        interface = _ipv4("interface", self.interface)
        if interface.is_unspecified or interface.is_multicast:
            raise ValueError(
                f"interface {self.interface} must be the IPv4 address of one network interface"
            )
        if not _ipv4("multicast group", self.multicast_group).is_multicast:
            raise ValueError(f"{self.multicast_group} is not an IPv4 multicast group")
        for name, (low, high) in LIMITS.items():
            check_range(name, getattr(self, name), low, high)
        if 0 < self.amplification_limit < LEAST_AMPLIFICATION:
            raise ValueError(
                f"amplification_limit is {self.amplification_limit}; it must be 0 or at least"
                f" {LEAST_AMPLIFICATION}, to leave room for the question and an answer"
            )
        for address, (_, port) in self.address_book.items():
            if not address.is_concrete:
                raise ValueError(f"address book entry {address} does not name one component")
            check_range(f"port of {address}", port, *LIMITS["port"])
        for allowed_host in self.allowed_hosts:
            try:
                ipaddress.IPv4Network(allowed_host)
            except ValueError as error:
                raise ValueError(f"allowed host {allowed_host!r}: {error}") from error


def _peer(text: str) -> tuple[JausAddress, Endpoint]:
    """Reads ``ID=HOST:PORT``; argparse turns the ValueError into a usage message."""
    address, _, endpoint = text.partition("=")
    host, _, port = endpoint.rpartition(":")
    if not host or not (port.isascii() and port.isdigit()):
        raise argparse.ArgumentTypeError(f"{text!r} is not ID=HOST:PORT")
    try:
        return JausAddress.parse(address), (host, int(port))
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


# Options of a command line by groups and fields, as argparse takes them.
OPTIONS: dict[str, dict[str, dict[str, Any]]] = {
    "JAUS transport": {
        "interface": {"metavar": "ADDRESS", "help": "IPv4 address of the network interface"},
        "transport": {
            "choices": [kind.value for kind in TransportKind],
            "help": "UDP, TCP, or through the node manager of this host",
        },
        "port": {"metavar": "PORT", "help": "UDP or TCP port shared with every peer"},
        "multicast_group": {"metavar": "ADDRESS", "help": "multicast group"},
        "multicast_ttl": {"metavar": "HOPS", "help": "routers that a multicast may pass"},
        "fragment_size": {
            "metavar": "BYTES",
            "help": "payload of one packet; 1400 suits lossy networks",
        },
        "peer": {
            "metavar": "ID=HOST:PORT",
            "action": "append",
            "type": _peer,
            "help": "where a component is, e.g. 100.1.2=192.168.0.7:3794; may be repeated",
        },
        "node_manager_directory": {
            "metavar": "FOLDER",
            "help": "where the node manager has its local sockets (default: that for temporary"
            " files)",
        },
        "allowed_hosts": {
            "metavar": "NETWORKS",
            "help": "IPv4 addresses and networks that packets are taken from, with commas between"
            " them, e.g. 10.0.0.0/24,10.0.1.7; empty for any (default: %(default)r)",
        },
        "fixed_sources": {
            "action": argparse.BooleanOptionalAction,
            "help": "refuse a component that is suddenly heard from elsewhere",
        },
    },
    "what strangers get": {
        "amplification_limit": {
            "metavar": "FACTOR",
            "help": "bytes to a UDP endpoint on another host for each byte from it, until it has"
            " acknowledged; 0 for no limit",
        },
        "max_peers": {
            "metavar": "NUMBER",
            "help": "components that are remembered besides stated ones",
        },
        "max_connections": {"metavar": "NUMBER", "help": "TCP connections at a time"},
        "idle_timeout": {
            "metavar": "SECONDS",
            "help": "time in which a message must come over a TCP connection",
        },
    },
}


def option_values(settings: TransportSettings) -> dict[str, Any]:
    """Returns the values of settings by options, as command lines and parameters take them."""
    values = {name: getattr(settings, name, []) for group in OPTIONS.values() for name in group}
    values["transport"] = settings.transport.value
    values["allowed_hosts"] = ",".join(settings.allowed_hosts)
    values["idle_timeout"] = float(settings.idle_timeout)
    return values


def add_arguments(
    parser: argparse.ArgumentParser, defaults: TransportSettings | None = None
) -> None:
    """Adds the ``--jaus-...`` options that ``from_arguments`` reads."""
    values = option_values(TransportSettings() if defaults is None else defaults)
    for title, options in OPTIONS.items():
        group = parser.add_argument_group(title)
        for name, option in options.items():
            keywords = {"default": values[name], **option}
            if "default" not in option["help"] and name != "peer":
                keywords["help"] += " (default %(default)s)"
            if type(values[name]) in (int, float):
                keywords["type"] = type(values[name])
            group.add_argument(f"--jaus-{name.replace('_', '-')}", **keywords)


def from_arguments(
    arguments: argparse.Namespace, defaults: TransportSettings | None = None
) -> TransportSettings:
    """Returns the settings that the options of ``add_arguments`` describe.

    Args:
        defaults: Modelled settings; ``--jaus-peer`` extends their address book.

    Raises:
        ValueError: A value is out of its range.
    """
    defaults = TransportSettings() if defaults is None else defaults
    values = {
        name: getattr(arguments, f"jaus_{name}") for option in OPTIONS.values() for name in option
    }
    values["address_book"] = {**defaults.address_book, **dict(values.pop("peer"))}
    values["transport"] = TransportKind(values["transport"])
    values["allowed_hosts"] = tuple(
        word.strip() for word in values["allowed_hosts"].split(",") if word
    )
    return replace(defaults, **values)


def peers(*texts: str) -> dict[JausAddress, Endpoint]:
    """Returns entries of an address book.

    Args:
        texts: Entries like ``100.1.2=192.168.0.7:3794``.

    Raises:
        argparse.ArgumentTypeError: A text is no entry.
    """
    return dict(map(_peer, texts))


def _ipv4(name: str, text: str) -> ipaddress.IPv4Address:
    try:
        return ipaddress.IPv4Address(text)
    except ipaddress.AddressValueError:
        hint = "; 'ip -4 address' lists those of this host" if name == "interface" else ""
        raise ValueError(f"{name} '{text}' is no IPv4 address{hint}") from None


def check_range(name: str, value: float, low: float, high: float) -> None:
    """Raises ValueError for a setting outside its limits."""
    if not low <= value <= high:
        raise ValueError(f"{name} is {value}; it must lie in {low}..{high}")
