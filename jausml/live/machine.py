"""Checks of a machine that is to run bridges and components: Python, ROS 2, the JAUS network.

All is looked at without changing anything, and ROS is not started.
"""

from __future__ import annotations

import errno
import os
import platform
import secrets
import shutil
import socket
import sys
from collections.abc import Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass
from enum import Enum
from importlib import metadata
from importlib.machinery import PathFinder
from importlib.util import find_spec
from ipaddress import IPv4Address
from pathlib import Path
from urllib.parse import urlsplit

import jausml
from jausml import __version__, installing
from jausml.live.programs import PROGRAMS
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.bridge.ros.environment import (
    LARGEST_SAFE_DOMAIN,
    domain_fault,
    middleware_fault,
)
from jausml.runtime.transports.ports import holders, manager_folder
from jausml.views.diagrams.layout.sheet import LayoutError
from jausml.views.diagrams.writers import svg


class Outcome(Enum):
    """How a check ended, the gravest last."""

    OK = "ok"
    NOTE = "note"
    WARNING = "warning"
    ERROR = "error"


@dataclass(frozen=True)
class Finding:
    """A finding about one thing.

    Attributes:
        topic: What it belongs to: `python`, `programs`, `ros`, `network` or `model`.
        verdict: How it ended; an error keeps something from working, a warning may.
        cure: What to do, empty where there is nothing to do.
    """

    topic: str
    name: str
    verdict: Outcome
    text: str
    cure: str = ""


OLDEST = (3, 10)
"""The oldest Python that is promised; that of ROS 2 Jazzy is 3.12."""

_EXTRAS = (
    ("diagram", "graphviz-pure", "pictures of `jausml diagram`"),
    ("studio", "starlette", "`jausml studio`"),
    ("editor", "pygls", "`jausml language-server`"),
    ("top", "textual", "the view of `jausml top`"),
    ("record", "mcap", "`jausml record`"),
)
_PAGE = Path(jausml.__file__).parent / "authoring" / "studio" / "page" / "index.html"
"""The page of the studio; it is built, and a wheel may have been made without."""


def python_checks() -> Iterator[Finding]:
    """Yields the findings about Python."""
    description = f"Python {platform.python_version()} at {sys.executable}, jausml {__version__}"
    if sys.version_info < OLDEST:
        oldest = ".".join(map(str, OLDEST))
        yield Finding(
            "python", "version", Outcome.ERROR, description, f"use Python {oldest} or newer"
        )
    else:
        yield Finding("python", "version", Outcome.OK, description)
    for extra, package, purpose in _EXTRAS:
        if not _is_installed(package):
            cure = installing.command(extra)
            yield Finding("python", extra, Outcome.NOTE, f"{purpose} is not installed", cure)
        elif extra == "studio" and not _PAGE.is_file():
            cure = "run `make studio` in the checkout of jausml, or install its `make wheel`"
            yield Finding("python", extra, Outcome.NOTE, f"{purpose} has no page", cure)
        else:
            yield Finding("python", extra, Outcome.OK, f"{purpose} is installed")


def program_checks() -> Iterator[Finding]:
    """Yields the findings about programs that need not be there."""
    for program in PROGRAMS:
        path = program.path()
        if path is not None:
            text = f"{path} is there for {program.purpose}"
            yield Finding("programs", program.name, Outcome.OK, text)
        else:
            text = f"{program.fault}, which is for {program.purpose}"
            yield Finding("programs", program.name, Outcome.NOTE, text, program.cure)
    yield _fonts()


def _fonts() -> Finding:
    try:
        text = f"{svg.installed_font()} is there for pictures in PNG"
    except LayoutError as error:
        cure = svg.FONT_CURE if find_spec("resvg_py") else installing.command("diagram")
        return Finding("programs", "fonts", Outcome.NOTE, str(error), cure)
    return Finding("programs", "fonts", Outcome.OK, text)


_NETWORK = "network"
_PATIENCE = 1.0
"""Seconds that the own datagram has to come back."""
_LIMIT = Path("/proc/sys/net/core/rmem_max")


def network_checks(settings: TransportSettings) -> Iterator[Finding]:
    """Yields the findings about the network; sends one datagram to a port of its own."""
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
        yield Finding(_NETWORK, "node manager", Outcome.NOTE, text, cure)
    else:
        yield Finding(_NETWORK, "node manager", Outcome.OK, "none runs on this host")
    yield from _buffer(settings.receive_buffer)


def _interface(settings: TransportSettings) -> Finding:
    address = settings.interface
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind((address, 0))
        except OSError as error:
            cure = "name an address of this host by --interface; `ip -4 address` lists them"
            return Finding(
                _NETWORK, "interface", Outcome.ERROR, f"{address}: {error.strerror}", cure
            )
    if IPv4Address(address).is_loopback:
        text = f"{address} is this host alone"
        cure = "name the interface of the vehicle's network by --interface"
        return Finding(_NETWORK, "interface", Outcome.NOTE, text, cure)
    return Finding(_NETWORK, "interface", Outcome.OK, f"{address} is an address of this host")


def _multicast(settings: TransportSettings) -> Finding:
    group = settings.multicast_group
    try:
        came = _comes_back(settings)
    except OSError as error:
        reason = f"{group} on {settings.interface}: {error.strerror}"
    else:
        if came:
            text = f"a datagram to {group} on {settings.interface} comes back"
            return Finding(_NETWORK, "multicast", Outcome.OK, text)
        reason = f"a datagram to {group} on {settings.interface} does not come back"
    cure = (
        "look at the firewall, and at `ip link`: the interface needs MULTICAST (for loopback"
        " `ip link set lo multicast on`); without multicast name peers by --jaus-peer"
    )
    return Finding(_NETWORK, "multicast", Outcome.WARNING, reason, cure)


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
                return Finding(_NETWORK, name, Outcome.ERROR, str(error.strerror), cure)
            known = " and ".join(map(str, holders(protocol, settings.port)))
            text = f"held by {known or 'a program that cannot be seen'}"
            cure = (
                "programs of jausml share it; beside a node manager: --jaus-transport node-manager"
                if protocol == "udp" or has_manager
                else "only one program of a host can have it: --jaus-port takes another"
            )
            return Finding(_NETWORK, name, Outcome.WARNING, text, cure)
    return Finding(_NETWORK, name, Outcome.OK, "free")


def _buffer(wanted: int) -> Iterator[Finding]:
    try:
        limit = int(_LIMIT.read_text("ascii"))
    except (OSError, ValueError):
        return
    name, text = "receive buffer", f"the kernel grants {limit:,} bytes to a socket"
    if limit >= wanted:
        yield Finding(_NETWORK, name, Outcome.OK, text)
        return
    cure = f"sysctl -w net.core.rmem_max={wanted}: else bursts of large messages may be lost"
    yield Finding(_NETWORK, name, Outcome.NOTE, text, cure)


_ROS = "ros"
_RANGES = ("SUBNET", "LOCALHOST", "OFF", "SYSTEM_DEFAULT")
_DISTRIBUTIONS = ("jazzy", "kilted")
_DEFAULT_MIDDLEWARE = "rmw_fastrtps_cpp"
_PROFILES = ("FASTDDS_DEFAULT_PROFILES_FILE", "FASTRTPS_DEFAULT_PROFILES_FILE", "CYCLONEDDS_URI")
_SHARED_BY_A_NODE = 4 << 20
"""Bytes of shared memory without which a node does not start surely; it takes about 1 MiB."""

_SHARED_MEMORY = Path("/dev/shm")  # noqa: S108 - where Fast DDS puts what it shares


def ros_checks(packages: Mapping[str, bool]) -> Iterator[Finding]:
    """Yields the findings about ROS.

    Args:
        packages: Packages of messages that are needed, and whether each is the user's own.
    """
    if find_spec("rclpy") is None:
        cure = f"source the setup.bash of a ROS 2 installation, or {installing.command('ros')}"
        text = "Python finds no rclpy: bridges do not start; JAUS alone works"
        yield Finding(_ROS, "rclpy", Outcome.WARNING, text, cure)
    else:
        yield _rclpy()
        yield _middleware()
    yield _domain()
    yield from _discovery()
    yield from _profiles()
    yield from _security()
    yield _shared_memory()
    yield from _packages(packages)


def distribution() -> str:
    """Returns the release of ROS 2 that is sourced, or that has its wheels installed."""
    sourced = os.environ.get("ROS_DISTRO")
    if sourced in _DISTRIBUTIONS:
        return sourced
    installed = (codename for codename in _DISTRIBUTIONS if _is_installed(f"ros-{codename}-rclpy"))
    return next(installed, _DISTRIBUTIONS[0])


def _is_installed(package: str) -> bool:
    try:
        metadata.distribution(package)
    except metadata.PackageNotFoundError:
        return False
    return True


def package_cure(name: str) -> str:
    """Returns how a package of messages of ROS 2 is installed."""
    package = f"ros-{distribution()}-{name.replace('_', '-')}"
    return f"apt install {package}, or pip install {package} (few packages have wheels)"


def _rclpy() -> Finding:
    sourced = os.environ.get("ROS_DISTRO", "")
    named = f"rclpy is installed{f', ROS_DISTRO is {sourced}' if sourced else ''}"
    if sourced in ("", *_DISTRIBUTIONS):
        return Finding(_ROS, "rclpy", Outcome.OK, named)
    cure = f"source /opt/ros/{distribution()}/setup.bash: bridges are for ROS 2 Jazzy and Kilted"
    return Finding(_ROS, "rclpy", Outcome.WARNING, named, cure)


def _middleware() -> Finding:
    name = os.environ.get("RMW_IMPLEMENTATION") or _DEFAULT_MIDDLEWARE
    fault = middleware_fault(name, distribution())
    if fault is None:
        return Finding(_ROS, "middleware", Outcome.OK, f"{name} is installed")
    return Finding(_ROS, "middleware", Outcome.ERROR, *fault)


def _domain() -> Finding:
    text = os.environ.get("ROS_DOMAIN_ID", "")
    if not text:
        cure = "set ROS_DOMAIN_ID where several robots share a network"
        return Finding(_ROS, "domain", Outcome.NOTE, "ROS_DOMAIN_ID is not set: it is 0", cure)
    fault = domain_fault()
    if fault is not None:
        return Finding(_ROS, "domain", Outcome.ERROR, *fault)
    number = int(text)
    if number > LARGEST_SAFE_DOMAIN:
        text = f"ROS_DOMAIN_ID is {number}: its ports may be among those that Linux gives away"
        return Finding(
            _ROS, "domain", Outcome.WARNING, text, f"set one up to {LARGEST_SAFE_DOMAIN}"
        )
    return Finding(_ROS, "domain", Outcome.OK, f"ROS_DOMAIN_ID is {number}")


def _discovery() -> Iterator[Finding]:
    name = "ROS_AUTOMATIC_DISCOVERY_RANGE"
    text = os.environ.get(name, "")
    if text and text not in _RANGES:
        cure = f"set one of {', '.join(_RANGES)}"
        yield Finding(_ROS, "discovery", Outcome.ERROR, f"{name} is {text!r}", cure)
    elif text == "OFF":
        cure = "set SUBNET, or name the hosts in ROS_STATIC_PEERS"
        yield Finding(_ROS, "discovery", Outcome.WARNING, f"{name} is OFF: nodes do not meet", cure)
    else:
        yield Finding(_ROS, "discovery", Outcome.OK, f"{name} is {text or 'not set: SUBNET'}")
    if os.environ.get("ROS_LOCALHOST_ONLY"):
        yield Finding(
            _ROS,
            "discovery",
            Outcome.WARNING,
            f"ROS_LOCALHOST_ONLY is set, which overrides {name}",
            f"unset it, and use {name}=LOCALHOST",
        )


def _profiles() -> Iterator[Finding]:
    for name in _PROFILES:
        text = os.environ.get(name, "")
        if not text or text.lstrip().startswith("<"):
            continue
        path = Path(urlsplit(text).path if text.startswith("file:") else text)
        if path.is_file():
            yield Finding(_ROS, "middleware settings", Outcome.OK, f"{name} is {path}")
        else:
            yield Finding(
                _ROS,
                "middleware settings",
                Outcome.ERROR,
                f"{name} names {path}, which is no file",
                "correct it or unset it: the middleware may not start",
            )


def _security() -> Iterator[Finding]:
    """Yields the findings about the settings of SROS 2; a node checks its keys at its start."""
    name = "security"
    if os.environ.get("ROS_SECURITY_ENABLE", "").lower() != "true":
        return
    keystore = os.environ.get("ROS_SECURITY_KEYSTORE", "")
    enclaves = Path(keystore) / "enclaves"
    if not keystore:
        text = "ROS_SECURITY_ENABLE is true, but ROS_SECURITY_KEYSTORE is not set"
        yield Finding(_ROS, name, Outcome.ERROR, text, "set it to the folder of the keys")
    elif not os.access(enclaves, os.R_OK | os.X_OK):
        text = f"ROS_SECURITY_KEYSTORE has no folder {enclaves} that can be read"
        cure = "correct it, or let the user of the processes read the keys"
        yield Finding(_ROS, name, Outcome.ERROR, text, cure)
    elif os.environ.get("ROS_SECURITY_STRATEGY") != "Enforce":
        text = "ROS_SECURITY_STRATEGY is not Enforce: nodes without keys run unprotected"
        yield Finding(_ROS, name, Outcome.WARNING, text, "set ROS_SECURITY_STRATEGY=Enforce")
    else:
        yield Finding(_ROS, name, Outcome.OK, f"keys are in {keystore}")


def _shared_memory() -> Finding:
    name = "shared memory"
    if os.access(_SHARED_MEMORY, os.W_OK):
        left = shutil.disk_usage(_SHARED_MEMORY).free
        if left >= _SHARED_BY_A_NODE:
            return Finding(_ROS, name, Outcome.OK, f"{_SHARED_MEMORY} can be written")
        text = f"{_SHARED_MEMORY} has {left >> 10} KiB left: a node that starts may crash (SIGBUS)"
        cure = "fastdds shm clean, or remove what is not used there; in a container: --shm-size"
        return Finding(_ROS, name, Outcome.WARNING, text, cure)
    text = f"{_SHARED_MEMORY} cannot be written: nodes of one host speak by UDP"
    return Finding(_ROS, name, Outcome.NOTE, text, "in a container: --ipc=host")


def _packages(packages: Mapping[str, bool]) -> Iterator[Finding]:
    for name, is_own in packages.items():
        spec = PathFinder.find_spec(name)
        # Without an __init__ it is a folder that happens to be there.
        if spec is not None and spec.origin is not None:
            yield Finding("model", name, Outcome.OK, "its messages are installed")
            continue
        cure = package_cure(name)
        if is_own:
            cure = "no library has it: colcon build it, and source install/setup.bash"
        text = "Python finds no such package of messages"
        yield Finding("model", name, Outcome.ERROR, text, cure)
