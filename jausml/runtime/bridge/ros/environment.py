"""Checks of the environment before ROS starts, whose C libraries would end the process."""

from __future__ import annotations

import os
from importlib.util import find_spec
from pathlib import Path

from ...base.counters import LOGGER
from ...base.process import configure_log

LARGEST_DOMAIN = 232  # greatest ROS_DOMAIN_ID whose ports are below 65536
LARGEST_SAFE_DOMAIN = 101  # greatest ROS_DOMAIN_ID whose ports Linux does not assign to others


def domain_fault() -> tuple[str, str] | None:
    """Returns the fault of ROS_DOMAIN_ID and its cure; None for a valid one."""
    text = os.environ.get("ROS_DOMAIN_ID", "")
    if not text or (text.isascii() and text.isdigit() and int(text) <= LARGEST_DOMAIN):
        return None
    return f"ROS_DOMAIN_ID is {text!a}", f"set a number from 0 to {LARGEST_SAFE_DOMAIN}"


def middleware_fault(name: str, distribution: str) -> tuple[str, str] | None:
    """Returns the fault of a middleware that is not installed, and its cure; None otherwise.

    Args:
        distribution: Release of ROS 2, such as `jazzy`, for the name of the package.
    """
    if find_spec(name) is not None:
        return None
    shares = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    libraries = os.environ.get("LD_LIBRARY_PATH", "").split(os.pathsep)
    places = [Path(share, "share", name) for share in shares if share]
    places += [Path(library, f"lib{name}.so") for library in libraries if library]
    if any(place.exists() for place in places):
        return None
    package = f"ros-{distribution}-{name.replace('_', '-')}"
    return f"{name} is not installed", f"apt install {package}, or unset RMW_IMPLEMENTATION"


def environment_fault() -> str:
    """Returns all faults of the environment with their cures; empty without any."""
    name = os.environ.get("RMW_IMPLEMENTATION", "")
    release = os.environ.get("ROS_DISTRO", "jazzy")
    faults = (domain_fault(), middleware_fault(name, release) if name else None)
    return "; ".join(f"{text}: {cure}" for text, cure in filter(None, faults))


def permits_ros(who: str) -> bool:
    """Returns whether the environment permits ROS; logs the faults for `who` if not."""
    fault = environment_fault()
    if fault:
        configure_log("error")  # the wanted level is not known yet
        LOGGER.error("%s cannot run: %s", who, fault)
    return not fault
