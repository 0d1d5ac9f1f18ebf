"""ROS 2 on this machine, as a bridge would find it: looked at, not started."""

from __future__ import annotations

import os
from importlib.machinery import PathFinder
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from jausml.language.interfaces.parsing import Installation
from jausml.live.machine.finding import Finding, Outcome

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

_TOPIC = "ros"
_LARGEST_DOMAIN, _LARGEST_SAFE_DOMAIN = 232, 101
_RANGES = ("SUBNET", "LOCALHOST", "OFF", "SYSTEM_DEFAULT")
_DISTRIBUTION = "jazzy"
_DEFAULT_MIDDLEWARE = "rmw_fastrtps_cpp"
_PROFILES = (
    "FASTDDS_DEFAULT_PROFILES_FILE",
    "FASTRTPS_DEFAULT_PROFILES_FILE",
    "CYCLONEDDS_URI",
)
_SHARED_MEMORY = Path("/dev/shm")  # noqa: S108 - where Fast DDS puts what it shares


def checks(packages: Mapping[str, bool]) -> Iterator[Finding]:
    """Yields what is to be said of ROS.

    Args:
        packages: Packages of messages that are needed, and whether each is the user's own.
    """
    if find_spec("rclpy") is None:
        cure = "source the setup.bash of a ROS 2 installation, or pip install 'jausml[ros]'"
        text = "Python finds no rclpy: bridges do not start; JAUS alone works"
        yield Finding(_TOPIC, "rclpy", Outcome.WARNING, text, cure)
    else:
        yield _rclpy()
        yield _middleware()
    yield _domain()
    yield from _discovery()
    yield from _profiles()
    yield from _security()
    yield _shared_memory()
    yield from _packages(packages)


def _rclpy() -> Finding:
    distribution = os.environ.get("ROS_DISTRO", "")
    named = f"rclpy is installed{f', ROS_DISTRO is {distribution}' if distribution else ''}"
    if distribution in ("", _DISTRIBUTION):
        return Finding(_TOPIC, "rclpy", Outcome.OK, named)
    cure = f"source /opt/ros/{_DISTRIBUTION}/setup.bash: bridges are made for ROS 2 Jazzy"
    return Finding(_TOPIC, "rclpy", Outcome.WARNING, named, cure)


def _middleware() -> Finding:
    name = os.environ.get("RMW_IMPLEMENTATION") or _DEFAULT_MIDDLEWARE
    installation = Installation()
    if any((share / name).is_dir() for share in installation.shares) or find_spec(name):
        return Finding(_TOPIC, "middleware", Outcome.OK, f"{name} is installed")
    debian = name.replace("_", "-")
    cure = f"apt install ros-jazzy-{debian}, or unset RMW_IMPLEMENTATION"
    return Finding(_TOPIC, "middleware", Outcome.ERROR, f"{name} is not installed", cure)


def _domain() -> Finding:
    text = os.environ.get("ROS_DOMAIN_ID", "")
    if not text:
        cure = "set ROS_DOMAIN_ID where several robots share a network"
        return Finding(_TOPIC, "domain", Outcome.NOTE, "ROS_DOMAIN_ID is not set: it is 0", cure)
    number = int(text) if text.isascii() and text.isdigit() else -1
    if not 0 <= number <= _LARGEST_DOMAIN:
        return Finding(
            _TOPIC,
            "domain",
            Outcome.ERROR,
            f"ROS_DOMAIN_ID is {text!a}",
            f"set a number from 0 to {_LARGEST_SAFE_DOMAIN}",
        )
    if number > _LARGEST_SAFE_DOMAIN:
        text = f"ROS_DOMAIN_ID is {number}: its ports may be among those that Linux gives away"
        return Finding(
            _TOPIC, "domain", Outcome.WARNING, text, f"set one up to {_LARGEST_SAFE_DOMAIN}"
        )
    return Finding(_TOPIC, "domain", Outcome.OK, f"ROS_DOMAIN_ID is {number}")


def _discovery() -> Iterator[Finding]:
    name = "ROS_AUTOMATIC_DISCOVERY_RANGE"
    text = os.environ.get(name, "")
    if text and text not in _RANGES:
        cure = f"set one of {', '.join(_RANGES)}"
        yield Finding(_TOPIC, "discovery", Outcome.ERROR, f"{name} is {text!a}", cure)
    elif text == "OFF":
        cure = "set SUBNET, or name the hosts in ROS_STATIC_PEERS"
        yield Finding(
            _TOPIC, "discovery", Outcome.WARNING, f"{name} is OFF: nodes do not meet", cure
        )
    else:
        yield Finding(_TOPIC, "discovery", Outcome.OK, f"{name} is {text or 'not set: SUBNET'}")
    if os.environ.get("ROS_LOCALHOST_ONLY"):
        yield Finding(
            _TOPIC,
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
            yield Finding(_TOPIC, "middleware settings", Outcome.OK, f"{name} is {path}")
        else:
            yield Finding(
                _TOPIC,
                "middleware settings",
                Outcome.ERROR,
                f"{name} names {path}, which is no file",
                "correct it or unset it: the middleware may not start",
            )


def _security() -> Iterator[Finding]:
    """Looks at what SROS 2 is told; whether the keys fit, it says itself when a node starts."""
    name = "security"
    if os.environ.get("ROS_SECURITY_ENABLE", "").lower() != "true":
        return
    keystore = os.environ.get("ROS_SECURITY_KEYSTORE", "")
    enclaves = Path(keystore) / "enclaves"
    if not keystore:
        text = "ROS_SECURITY_ENABLE is true, but ROS_SECURITY_KEYSTORE is not set"
        yield Finding(_TOPIC, name, Outcome.ERROR, text, "set it to the folder of the keys")
    elif not os.access(enclaves, os.R_OK | os.X_OK):
        text = f"ROS_SECURITY_KEYSTORE has no folder {enclaves} that can be read"
        cure = "correct it, or let the user of the processes read the keys"
        yield Finding(_TOPIC, name, Outcome.ERROR, text, cure)
    elif os.environ.get("ROS_SECURITY_STRATEGY") != "Enforce":
        text = "ROS_SECURITY_STRATEGY is not Enforce: nodes without keys run unprotected"
        yield Finding(_TOPIC, name, Outcome.WARNING, text, "set ROS_SECURITY_STRATEGY=Enforce")
    else:
        yield Finding(_TOPIC, name, Outcome.OK, f"keys are in {keystore}")


def _shared_memory() -> Finding:
    name = "shared memory"
    if os.access(_SHARED_MEMORY, os.W_OK):
        return Finding(_TOPIC, name, Outcome.OK, f"{_SHARED_MEMORY} can be written")
    text = f"{_SHARED_MEMORY} cannot be written: nodes of one host speak by UDP"
    return Finding(_TOPIC, name, Outcome.NOTE, text, "in a container: --ipc=host")


def _packages(packages: Mapping[str, bool]) -> Iterator[Finding]:
    for name, is_own in packages.items():
        found = PathFinder.find_spec(name)
        # Without an __init__ it is a folder that happens to be there.
        if found is not None and found.origin is not None:
            yield Finding("model", name, Outcome.OK, "its messages are installed")
            continue
        debian = name.replace("_", "-")
        cure = f"apt install ros-jazzy-{debian}, or pip install ros-jazzy-{debian}"
        if is_own:
            cure = "no library has it: colcon build it, and source install/setup.bash"
        text = "Python finds no such package of messages"
        yield Finding("model", name, Outcome.ERROR, text, cure)
