"""Checks of ROS 2: rclpy, its settings in the environment, and the packages of messages."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator, Mapping
from importlib.machinery import PathFinder
from importlib.util import find_spec
from pathlib import Path
from urllib.parse import urlsplit

from jausml import installing
from jausml.live.machine.findings import Finding, Verdict
from jausml.live.machine.python import is_installed
from jausml.runtime.bridge.ros.environment import (
    LARGEST_SAFE_DOMAIN,
    domain_fault,
    middleware_fault,
)

_RANGES = ("SUBNET", "LOCALHOST", "OFF", "SYSTEM_DEFAULT")
_DISTRIBUTIONS = ("jazzy", "kilted")
_DEFAULT_MIDDLEWARE = "rmw_fastrtps_cpp"
_PROFILES = ("FASTDDS_DEFAULT_PROFILES_FILE", "FASTRTPS_DEFAULT_PROFILES_FILE", "CYCLONEDDS_URI")
# Bytes of shared memory without which a node does not start surely; it takes about 1 MiB.
_SHARED_BY_A_NODE = 4 << 20
_SHARED_MEMORY = Path("/dev/shm")  # noqa: S108 - where Fast DDS puts what it shares


def ros_checks(packages: Mapping[str, bool]) -> Iterator[Finding]:
    """Yields the findings about ROS.

    Args:
        packages: Packages of messages that are needed, and whether each is the user's own.
    """
    if find_spec("rclpy") is None:
        cure = f"source the setup.bash of a ROS 2 installation, or {installing.command('ros')}"
        text = "Python finds no rclpy: bridges do not start; JAUS alone works"
        yield Finding("ros", "rclpy", Verdict.WARNING, text, cure)
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
    installed = (codename for codename in _DISTRIBUTIONS if is_installed(f"ros-{codename}-rclpy"))
    return next(installed, _DISTRIBUTIONS[0])


def package_cure(name: str) -> str:
    """Returns how a package of messages of ROS 2 is installed."""
    package = f"ros-{distribution()}-{name.replace('_', '-')}"
    return f"apt install {package}, or pip install {package} (few packages have wheels)"


def _rclpy() -> Finding:
    sourced = os.environ.get("ROS_DISTRO", "")
    text = f"rclpy is installed{f', ROS_DISTRO is {sourced}' if sourced else ''}"
    if sourced in ("", *_DISTRIBUTIONS):
        return Finding("ros", "rclpy", Verdict.OK, text)
    cure = f"source /opt/ros/{distribution()}/setup.bash: bridges are for ROS 2 Jazzy and Kilted"
    return Finding("ros", "rclpy", Verdict.WARNING, text, cure)


def _middleware() -> Finding:
    name = os.environ.get("RMW_IMPLEMENTATION") or _DEFAULT_MIDDLEWARE
    fault = middleware_fault(name, distribution())
    if fault is None:
        return Finding("ros", "middleware", Verdict.OK, f"{name} is installed")
    return Finding("ros", "middleware", Verdict.ERROR, *fault)


def _domain() -> Finding:
    text = os.environ.get("ROS_DOMAIN_ID", "")
    if not text:
        cure = "set ROS_DOMAIN_ID where several robots share a network"
        return Finding("ros", "domain", Verdict.NOTE, "ROS_DOMAIN_ID is not set: it is 0", cure)
    fault = domain_fault()
    if fault is not None:
        return Finding("ros", "domain", Verdict.ERROR, *fault)
    number = int(text)
    if number > LARGEST_SAFE_DOMAIN:
        text = f"ROS_DOMAIN_ID is {number}: its ports may be among those that Linux gives away"
        cure = f"set one up to {LARGEST_SAFE_DOMAIN}"
        return Finding("ros", "domain", Verdict.WARNING, text, cure)
    return Finding("ros", "domain", Verdict.OK, f"ROS_DOMAIN_ID is {number}")


def _discovery() -> Iterator[Finding]:
    name = "ROS_AUTOMATIC_DISCOVERY_RANGE"
    text = os.environ.get(name, "")
    if text and text not in _RANGES:
        cure = f"set one of {', '.join(_RANGES)}"
        yield Finding("ros", "discovery", Verdict.ERROR, f"{name} is {text!r}", cure)
    elif text == "OFF":
        cure = "set SUBNET, or name the hosts in ROS_STATIC_PEERS"
        text = f"{name} is OFF: nodes do not meet"
        yield Finding("ros", "discovery", Verdict.WARNING, text, cure)
    else:
        yield Finding("ros", "discovery", Verdict.OK, f"{name} is {text or 'not set: SUBNET'}")
    if os.environ.get("ROS_LOCALHOST_ONLY"):
        text = f"ROS_LOCALHOST_ONLY is set, which overrides {name}"
        cure = f"unset it, and use {name}=LOCALHOST"
        yield Finding("ros", "discovery", Verdict.WARNING, text, cure)


def _profiles() -> Iterator[Finding]:
    for name in _PROFILES:
        text = os.environ.get(name, "")
        if not text or text.lstrip().startswith("<"):
            continue
        path = Path(urlsplit(text).path if text.startswith("file:") else text)
        if path.is_file():
            yield Finding("ros", "middleware settings", Verdict.OK, f"{name} is {path}")
        else:
            text = f"{name} names {path}, which is no file"
            cure = "correct it or unset it: the middleware may not start"
            yield Finding("ros", "middleware settings", Verdict.ERROR, text, cure)


def _security() -> Iterator[Finding]:
    """Yields the findings about the settings of SROS 2; a node checks its keys at its start."""
    name = "security"
    if os.environ.get("ROS_SECURITY_ENABLE", "").lower() != "true":
        return
    keystore = os.environ.get("ROS_SECURITY_KEYSTORE", "")
    enclaves = Path(keystore) / "enclaves"
    if not keystore:
        text = "ROS_SECURITY_ENABLE is true, but ROS_SECURITY_KEYSTORE is not set"
        yield Finding("ros", name, Verdict.ERROR, text, "set it to the folder of the keys")
    elif not os.access(enclaves, os.R_OK | os.X_OK):
        text = f"ROS_SECURITY_KEYSTORE has no folder {enclaves} that can be read"
        cure = "correct it, or let the user of the processes read the keys"
        yield Finding("ros", name, Verdict.ERROR, text, cure)
    elif os.environ.get("ROS_SECURITY_STRATEGY") != "Enforce":
        text = "ROS_SECURITY_STRATEGY is not Enforce: nodes without keys run unprotected"
        yield Finding("ros", name, Verdict.WARNING, text, "set ROS_SECURITY_STRATEGY=Enforce")
    else:
        yield Finding("ros", name, Verdict.OK, f"keys are in {keystore}")


def _shared_memory() -> Finding:
    name = "shared memory"
    if os.access(_SHARED_MEMORY, os.W_OK):
        left = shutil.disk_usage(_SHARED_MEMORY).free
        if left >= _SHARED_BY_A_NODE:
            return Finding("ros", name, Verdict.OK, f"{_SHARED_MEMORY} can be written")
        text = f"{_SHARED_MEMORY} has {left >> 10} KiB left: a node that starts may crash (SIGBUS)"
        cure = "fastdds shm clean, or remove what is not used there; in a container: --shm-size"
        return Finding("ros", name, Verdict.WARNING, text, cure)
    text = f"{_SHARED_MEMORY} cannot be written: nodes of one host speak by UDP"
    return Finding("ros", name, Verdict.NOTE, text, "in a container: --ipc=host")


def _packages(packages: Mapping[str, bool]) -> Iterator[Finding]:
    for name, is_own in packages.items():
        spec = PathFinder.find_spec(name)
        # Without an __init__ it is a folder that happens to be there.
        if spec is not None and spec.origin is not None:
            yield Finding("model", name, Verdict.OK, "its messages are installed")
            continue
        cure = package_cure(name)
        if is_own:
            cure = "no library has it: colcon build it, and source install/setup.bash"
        text = "Python finds no such package of messages"
        yield Finding("model", name, Verdict.ERROR, text, cure)
