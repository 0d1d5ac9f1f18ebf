"""Hosts: where the elements of a system run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.metamodel.classes import jaus

if TYPE_CHECKING:
    from jausml.metamodel.classes import ros
    from jausml.metamodel.classes.system import Host, System


def host_of(system: System, element: jaus.Component | ros.Node) -> Host | None:
    """Returns the host that an element runs on, the first one without a placement, or None.

    Where an external component runs is known by its placement alone.

    Args:
        system: The system.
        element: A component, bridge or node of the system.
    """
    for placement in system.placements:
        if element in (*placement.components, *placement.nodes):
            return placement.host
    if isinstance(element, jaus.Component) and element.external:
        return None  # it is wherever somebody else has put it
    return system.hosts[0] if system.hosts else None
