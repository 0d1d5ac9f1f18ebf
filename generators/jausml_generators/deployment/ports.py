"""Ports of JAUS and of ROS 2, for firewalls."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jausml.language.metamodel.classes.system import Host

NEIGHBOURS_OFFSET = 50_000
"""How far above the port of a host those of processes are that do not own it."""

NEIGHBOURS = 32
"""How many such ports there are."""

HIGHEST_SHARED_PORT = 0xFFFF - NEIGHBOURS_OFFSET - NEIGHBOURS + 1
"""Above it the system picks the ports of such processes."""

# RTPS 2.5, section 9.6.2.3: PB, DG and d1; the unicast ports of a domain fill the rest of it.
_DDS_BASE, _DDS_DOMAIN, _DDS_UNICAST = 7400, 250, 10


def jaus_ports(host: Host, processes: int) -> tuple[str, ...]:
    """Returns the ports at which the JAUS processes of a host are reached, ranges as `1-2`.

    Over UDP each process but the one that owns the port has one of its neighbours.
    """
    port = int(host.port)
    if host.transport.name != "judp" or processes < 2 or port > HIGHEST_SHARED_PORT:
        return (str(port),)
    first = port + NEIGHBOURS_OFFSET
    return (str(port), f"{first}-{first + NEIGHBOURS - 1}")


def dds_ports(domain: int) -> str:
    """Returns the unicast ports of a ROS domain, as `7410-7649`."""
    first = _DDS_BASE + _DDS_DOMAIN * domain
    return f"{first + _DDS_UNICAST}-{first + _DDS_DOMAIN - 1}"
