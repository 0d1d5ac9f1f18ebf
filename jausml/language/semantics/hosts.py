"""Hosts: where the elements of a system run."""

from __future__ import annotations

import ipaddress

from jausml.language.metamodel.classes import jaus, ros
from jausml.language.metamodel.classes.system import Host, System

JAUS_PORT = 3794
"""Port of an endpoint that states none (AS5669A)."""


def host_of(system: System, element: jaus.Component | ros.Node) -> Host | None:
    """Returns the host that an element runs on, the first one without a placement, or None.

    Where an external component runs is known by its placement alone.
    """
    for placement in system.placements:
        if element in placement.components or element in placement.nodes:
            return placement.host
    if isinstance(element, jaus.Component) and element.external:
        return None  # it is wherever somebody else has put it
    return system.hosts[0] if system.hosts else None


def endpoint_of(system: System, component: jaus.Component) -> tuple[str, int] | None:
    """Returns the host and port of a component, None where they are not stated."""
    host = host_of(system, component)
    if host is not None:
        return str(host.interface), int(host.port)
    if not component.endpoint:
        return None
    name, _, port = str(component.endpoint).partition(":")
    return name, int(port or JAUS_PORT)


def is_ipv4(host: str) -> bool:
    """Tells whether a host is an IPv4 address, and not a name."""
    try:
        ipaddress.IPv4Address(host)
    except ValueError:
        return False
    return True
