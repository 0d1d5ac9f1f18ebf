"""A network, shared memory and a ROS domain of its own for each process that runs tests.

Tests bind fixed ports, join multicast groups and start rclpy, which meets others in shared memory.
In Linux namespaces of its own a process has all ports to itself, so workers run side by side.
Where namespaces need a privilege that is lacking, a user namespace gives it, and its capabilities
are kept for the workers that are started from it (capabilities(7), "Ambient").

Nobody returns from a namespace, so another process tries all of it first: where a mount is refused
after the network has been given, which happens in a chroot, the tests keep the network they have.
"""

import ctypes
import errno
import fcntl
import functools
import os
import socket
import struct
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

# <sched.h>, <sys/mount.h>, <linux/sockios.h>, <net/if.h>, <net/route.h>, <linux/capability.h>
CLONE_NEWNS, CLONE_NEWUSER, CLONE_NEWNET = 0x20000, 0x10000000, 0x40000000
MS_REC, MS_PRIVATE = 0x4000, 0x40000
SIOCADDRT, SIOCGIFFLAGS, SIOCSIFFLAGS = 0x890B, 0x8913, 0x8914
IFF_UP, IFF_MULTICAST, RTF_UP = 0x1, 0x1000, 0x1
MNT_DETACH = 0x2
CAP_NET_ADMIN, CAP_NET_RAW, CAP_SYS_ADMIN, CAPABILITY_VERSION_3 = 12, 13, 21, 0x20080522
PR_CAP_AMBIENT, PR_CAP_AMBIENT_RAISE = 47, 2

_KEPT = (CAP_NET_ADMIN, CAP_NET_RAW, CAP_SYS_ADMIN)
"""What tests need: to make networks, to capture frames, to mount."""

PROFILES = ("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE")
"""Where Fast DDS is told its settings: that of Jazzy, and that of Kilted."""


@functools.cache
def isolate() -> str:
    """Gives this process a network and shared memory of its own; returns why not, or nothing.

    Asked again, it says so again.

    Raises:
        OSError: Another process was given them, and this one is not.
    """
    tried = subprocess.run([sys.executable, "-SE", __file__], capture_output=True, text=True)
    if tried.returncode:
        lines = tried.stderr.splitlines()
        return lines[-1] if lines else f"the trial ended with {tried.returncode}"
    _enter()
    return ""


def _enter() -> None:
    """Enters the namespaces.

    Raises:
        OSError: One is refused, or a mount; the namespaces before it are entered.
    """
    try:
        _call("unshare", CLONE_NEWNET | CLONE_NEWNS)
    except PermissionError:
        _enter_user_namespace()
    _own_shared_memory()
    _loopback()


def own_domain(number: int) -> None:
    """Sets the ROS domain of this process and of those it starts."""
    os.environ["ROS_DOMAIN_ID"] = str(1 + number)
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"


def announce_often() -> None:
    """Lets nodes that are started from now on find each other at once, and not after 3 s."""
    for name in PROFILES:
        os.environ[name] = str(Path(__file__).with_name("discovery.xml"))


@contextmanager
def small_folder(path: Path, size: int) -> Iterator[None]:
    """Makes a folder with room for so many bytes, which has gone after the block.

    Args:
        path: The folder, which does not exist yet.
        size: Bytes.

    Raises:
        OSError: Nothing can be mounted here.
    """
    path.mkdir()
    try:
        _call("mount", b"tmpfs", bytes(path), b"tmpfs", 0, f"size={size}".encode("ascii"))
        try:
            yield
        finally:
            _call("umount2", bytes(path), MNT_DETACH)
    finally:
        path.rmdir()


def _call(name: str, *arguments: object) -> None:
    """Calls a function of the C library that returns 0, or raises OSError."""
    function = getattr(ctypes.CDLL(None, use_errno=True), name, None)
    if function is None:
        raise OSError(errno.ENOSYS, f"{name}: there is no such call outside Linux")
    if function(*arguments) != 0:
        number = ctypes.get_errno()
        raise OSError(number, f"{name}: {os.strerror(number)}")


def _enter_user_namespace() -> None:
    """Becomes privileged over new namespaces as the same user, and lets children be so."""
    user, group = os.getuid(), os.getgid()
    _call("unshare", CLONE_NEWUSER | CLONE_NEWNET | CLONE_NEWNS)
    for name, text in (
        ("setgroups", "deny"),
        ("uid_map", f"{user} {user} 1"),
        ("gid_map", f"{group} {group} 1"),
    ):
        Path("/proc/self", name).write_text(text, encoding="ascii")
    header = struct.pack("Ii", CAPABILITY_VERSION_3, 0)
    kept = ctypes.create_string_buffer(24)  # two times effective, permitted, inheritable
    _call("capget", header, kept)
    effective, permitted, _, *high = struct.unpack("6I", kept.raw)
    inherited = sum(1 << capability for capability in _KEPT)
    _call("capset", header, struct.pack("6I", effective, permitted, inherited, *high))
    for capability in _KEPT:
        _call("prctl", PR_CAP_AMBIENT, PR_CAP_AMBIENT_RAISE, capability, 0, 0)


def _own_shared_memory() -> None:
    _call("mount", b"none", b"/", None, MS_REC | MS_PRIVATE, None)
    _call("mount", b"tmpfs", b"/dev/shm", b"tmpfs", 0, None)


def _loopback() -> None:
    """Brings the loopback interface up, for multicast too."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:
        answer = fcntl.ioctl(control, SIOCGIFFLAGS, struct.pack("16sH14x", b"lo", 0))
        (flags,) = struct.unpack_from("H", answer, 16)
        flags |= IFF_UP | IFF_MULTICAST
        fcntl.ioctl(control, SIOCSIFFLAGS, struct.pack("16sH14x", b"lo", flags))
        device = ctypes.create_string_buffer(b"lo")
        route = struct.pack(
            "L16s16s16sHhLPhPLLH",
            *(0, _address(224), _address(0), _address(240)),
            *(RTF_UP, 0, 0, 0, 0, ctypes.addressof(device), 0, 0, 0),
        )
        fcntl.ioctl(control, SIOCADDRT, route)


def _address(first: int) -> bytes:
    """A `struct sockaddr_in` without a port, of an address whose other three bytes are 0."""
    return struct.pack("HHB11x", socket.AF_INET, 0, first)


if __name__ == "__main__":  # the trial
    try:
        _enter()
    except OSError as error:
        sys.exit(str(error))
