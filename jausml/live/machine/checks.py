"""All checks of a machine. They change nothing and do not start ROS."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from jausml.live.machine.findings import Finding
from jausml.live.machine.network import network_checks
from jausml.live.machine.programs import program_checks
from jausml.live.machine.python import python_checks
from jausml.live.machine.ros import ros_checks
from jausml.runtime.base.settings import TransportSettings


def machine_checks(packages: Mapping[str, bool], settings: TransportSettings) -> Iterator[Finding]:
    """Yields the findings about this machine.

    Args:
        packages: As of `ros_checks`.
        settings: The interface and the port that JAUS is to have.
    """
    yield from python_checks()
    yield from program_checks()
    yield from ros_checks(packages)
    yield from network_checks(settings)
