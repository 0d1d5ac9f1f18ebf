"""The JUDP port of a host, shared by its processes, and the processes that hold a taken port.

Each process joins the multicast group with a socket of its own. Only one process owns the unicast
port; the others use a port of a known range, which peers learn from their datagrams. The owner
forwards datagrams that peers send to the well-known port for components of the others.
"""

from __future__ import annotations

import errno
import socket
import struct
import sys
import tempfile
from collections.abc import Collection, Iterator
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from ..base.address import JausAddress, address_of
from ..base.counters import LOGGER
from ..base.settings import Endpoint, TransportSettings

MANAGER = "JuniorRTE"  # name of the local socket of the node managers of Junior and fkie
_PROC = Path("/proc")
_LISTENING = "0A"
_ADDRESS, _STATE, _INODE = 1, 3, 9


class Holder(NamedTuple):
    """A process that holds a port."""

    name: str
    process: int

    def __str__(self) -> str:
        return f"{self.name} (process {self.process})"


def holders(protocol: str, port: int) -> list[Holder]:
    """Returns the other processes that hold a port, if this process may see them (Linux)."""
    inodes = set(_inodes(protocol, port))
    return sorted(set(_processes(inodes))) if inodes else []


def advice(protocol: str, settings: TransportSettings) -> str:
    """Returns which processes hold the port of the settings, and how to share or change it."""
    share = "To share it with a node manager: --jaus-transport node-manager"
    text = who_holds(protocol, settings)
    return f"{text}. {share}; to use another port, as every peer then must: --jaus-port"


def who_holds(protocol: str, settings: TransportSettings) -> str:
    """Returns which processes hold the port of the settings, in words."""
    processes = holders(protocol, settings.port)
    manager = manager_folder(settings)
    if processes:
        return f"it is held by {' and '.join(map(str, processes))}"
    if manager is not None:
        return f"it is likely held by the node manager whose socket is in {manager}"
    return (
        "who holds it cannot be seen; likely a node manager (that of Junior or fkie) or a "
        "JAUS program of another user"
    )


def manager_folder(settings: TransportSettings) -> Path | None:
    """Returns the folder with the socket of a node manager that runs on this host, or None."""
    folder = Path(settings.node_manager_directory or tempfile.gettempdir())
    return folder if is_alive(folder / MANAGER) else None


def is_alive(path: Path) -> bool:
    """Returns whether a process listens at a local socket."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(str(path))
        except OSError:
            return False
    return True


def _inodes(protocol: str, port: int) -> Iterator[str]:
    try:
        lines = (_PROC / "net" / protocol).read_text(encoding="ascii").splitlines()[1:]
    except OSError:
        return
    for line in lines:
        words = line.split()
        if protocol == "tcp" and words[_STATE] != _LISTENING:
            continue
        if int(words[_ADDRESS].rpartition(":")[2], 16) == port:
            yield f"socket:[{words[_INODE]}]"


def _processes(inodes: set[str]) -> Iterator[Holder]:
    own = str(_PROC.joinpath("self").resolve().name)
    for folder in _PROC.glob("[0-9]*"):
        if folder.name == own:
            continue
        try:
            links = {str(path.readlink()) for path in (folder / "fd").iterdir()}
            if links & inodes:
                name = (folder / "comm").read_text(encoding="utf-8", errors="replace").strip()
                yield Holder(name, int(folder.name))
        except OSError:
            continue  # a process of another user, or one that has ended


# JAUS-DEVIATION: in AS5669A a port has one process. Processes of one host exchange two kinds of
# frames: forwarded datagrams, and the components of a process. They begin with 0, which is no JUDP
# version, so that other stacks drop them, and with a word that no other stack sends.
FRAME = b"\x00JAUSML"
_FORWARDED = FRAME + b"F"
_PRESENT = FRAME + b"P"
_ENDPOINT = struct.Struct("!4sH")
_FORWARDED_SIZE = len(_FORWARDED) + _ENDPOINT.size
_MAX_PRESENT = 256

_IP_MULTICAST_ALL = 49  # Linux; not in the socket module
_NEIGHBOURS_OFFSET = 50_000
_NEIGHBOURS = 32
_MAX_DATAGRAMS = 1 << 16


def neighbour_ports(port: int) -> range:
    """Returns the ports of processes that share a port without owning it, for firewalls.

    They are 32 ports from 50,000 above, where no service can be registered (RFC 6335); none if the
    port is too high for that.
    """
    first = port + _NEIGHBOURS_OFFSET
    return range(first, first + _NEIGHBOURS) if first + _NEIGHBOURS <= 0x10000 else range(0)


class SharedPort:
    """The sockets of one process on the JUDP port of its host."""

    def __init__(self, settings: TransportSettings) -> None:
        """Creates no sockets before ``open``."""
        self._settings = settings
        self.well_known: Endpoint = (settings.interface, settings.port)
        self.group: Endpoint = (settings.multicast_group, settings.port)
        self.multicast: socket.socket | None = None
        self.unicast: socket.socket | None = None
        self.former: socket.socket | None = None
        self.endpoints: frozenset[Endpoint] = frozenset()

    @property
    def is_owner(self) -> bool:
        """Whether this process owns the unicast port."""
        return self.well_known in self.endpoints

    @property
    def sockets(self) -> list[socket.socket]:
        """The open sockets; the present unicast socket is last."""
        sockets = (self.multicast, self.former, self.unicast)
        return [sock for sock in sockets if sock is not None]

    def open(self) -> None:
        """Joins the group and takes the unicast port, or another if it is taken; raises OSError."""
        try:
            self.multicast = group_socket(self._settings)
            self._take(self._well_known_or_any_socket())
        except OSError as error:
            self.close()
            raise OSError(
                error.errno,
                f"JUDP port {self._settings.port} of {self._settings.interface} with group "
                f"{self._settings.multicast_group}: {self._explain(error)}",
            ) from error

    def take_over(self) -> bool:
        """Takes the unicast port if its owner has left it; returns whether it did.

        The former socket stays open, as peers know its port until the next datagram.
        """
        try:
            unicast = self._unicast_socket(self._settings.port)
        except OSError:
            return False
        self.former = self.unicast
        self._take(unicast)
        return True

    def rejoin(self) -> bool:
        """Joins the group anew if the interface was removed and is back; returns whether it did."""
        multicast, unicast = self.multicast, self.unicast
        if multicast is None or unicast is None:
            return False
        if not join_again(multicast, self._settings):
            return False
        with suppress(OSError):  # gone again: it is joined anew when it is back
            self._send_by_interface(unicast)
        return True

    def close(self) -> None:
        """Closes all sockets."""
        for sock in self.sockets:
            sock.close()
        self.multicast = self.unicast = self.former = None
        self.endpoints = frozenset()

    def empty(self) -> int:
        """Discards the datagrams that wait in the sockets; returns their number."""
        return sum(map(_discard_waiting, self.sockets))

    def _explain(self, error: OSError) -> str:
        if error.errno != errno.EADDRINUSE:
            return str(error.strerror)
        return f"{error.strerror} and not shared; {advice('udp', self._settings)}"

    def _take(self, unicast: socket.socket) -> None:
        self.unicast = unicast
        self.endpoints |= {unicast.getsockname()}

    def _well_known_or_any_socket(self) -> socket.socket:
        try:
            return self._unicast_socket(self._settings.port)
        except OSError as error:
            if error.errno != errno.EADDRINUSE:
                raise
        owners = " and ".join(map(str, holders("udp", self._settings.port)))
        LOGGER.info(
            "UDP port %d is owned by %s; this process shares it",
            self._settings.port,
            owners or "another program",
        )
        return self._neighbour_socket()

    def _neighbour_socket(self) -> socket.socket:
        for port in neighbour_ports(self._settings.port):
            try:
                return self._unicast_socket(port)
            except OSError as error:
                if error.errno != errno.EADDRINUSE:
                    raise
        return self._unicast_socket(0)

    def _unicast_socket(self, port: int) -> socket.socket:
        sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, self._settings.receive_buffer)
            self._send_by_interface(sock)
            sock.setsockopt(
                socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, self._settings.multicast_ttl
            )
            # For other processes of this host; this one ignores its own datagrams.
            sock.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_LOOP, 1)
            sock.settimeout(0)
            sock.bind((self._settings.interface, port))
        except OSError:
            sock.close()
            raise
        return sock

    def _send_by_interface(self, sock: socket.socket) -> None:
        interface = socket.inet_aton(self._settings.interface)
        sock.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, interface)


def group_socket(settings: TransportSettings) -> socket.socket:
    """Returns a socket that hears the multicast group on an interface; raises OSError."""
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if hasattr(socket, "SO_REUSEPORT"):
            # To share the port with a node manager that allows it (fkie).
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, settings.receive_buffer)
        sock.settimeout(0)
        sock.bind((settings.multicast_group, settings.port))
        _change_membership(sock, settings, socket.IP_ADD_MEMBERSHIP)
        if sys.platform == "linux":
            # Only the group on our interface, whatever other processes have joined.
            sock.setsockopt(socket.IPPROTO_IP, _IP_MULTICAST_ALL, 0)
    except OSError:
        sock.close()
        raise
    return sock


def join_again(sock: socket.socket, settings: TransportSettings) -> bool:
    """Joins the group anew if the interface was removed and is back; returns whether it did."""
    try:
        _change_membership(sock, settings, socket.IP_ADD_MEMBERSHIP)
    except OSError as error:
        if error.errno != errno.EADDRINUSE:  # it is no member: the interface is not there
            # The kernel keeps the membership, and allows few.
            with suppress(OSError):
                _change_membership(sock, settings, socket.IP_DROP_MEMBERSHIP)
        return False
    return True


def _change_membership(sock: socket.socket, settings: TransportSettings, option: int) -> None:
    ends = (settings.multicast_group, settings.interface)
    sock.setsockopt(socket.IPPROTO_IP, option, b"".join(map(socket.inet_aton, ends)))


def _discard_waiting(sock: socket.socket) -> int:
    """Discards waiting datagrams; returns their number, which is bounded as more may come."""
    for count in range(_MAX_DATAGRAMS):
        try:
            sock.recv(1)
        except OSError:
            return count
    return _MAX_DATAGRAMS


def forwarded_frame(sender: Endpoint, datagram: bytes) -> bytes:
    """Returns the frame of a forwarded datagram and its sender."""
    return _FORWARDED + _ENDPOINT.pack(socket.inet_aton(sender[0]), sender[1]) + datagram


def read_forwarded(frame: bytes) -> tuple[Endpoint, bytes] | None:
    """Returns sender and datagram of a forwarded frame; None for another frame."""
    if not frame.startswith(_FORWARDED) or len(frame) < _FORWARDED_SIZE:
        return None
    host, port = _ENDPOINT.unpack_from(frame, len(_FORWARDED))
    return (socket.inet_ntoa(host), port), frame[_FORWARDED_SIZE:]


def present_frame(addresses: Collection[JausAddress]) -> bytes:
    """Returns the frame that announces the components of this process to the owner."""
    return _PRESENT + struct.pack(f"<{len(addresses)}I", *addresses)


def read_present(frame: bytes) -> list[JausAddress] | None:
    """Returns the components that a frame announces; None for another frame."""
    if not frame.startswith(_PRESENT):
        return None
    count = min((len(frame) - len(_PRESENT)) // 4, _MAX_PRESENT)
    packed = struct.unpack_from(f"<{count}I", frame, len(_PRESENT))
    return [address_of(value) for value in packed]
