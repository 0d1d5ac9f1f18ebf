"""Reports that the connections of a model carry, and the components that they are asked of."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.runtime.base.address import JausAddress

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.model.model import Model


def reports_of(model: Model) -> list[tuple[JausAddress, str]]:
    """Returns components of a model with the names of their reports, each once, in model order.

    A report that a bridge makes of topics is its own. Peers that are searched for by service have
    no address in the model and are left out.
    """
    return list(dict.fromkeys(_reports(model)))


def _reports(model: Model) -> Iterator[tuple[JausAddress, str]]:
    for owner in model.instances(bridge.Bridge, library=False):
        for connection in owner.bridgeConnections:
            if connection.exchange.name == "message":
                continue
            to_ros = connection.direction.name == "jausToRos"
            for component in connection.peers if to_ros else [owner]:
                yield JausAddress.parse(str(component.address)), str(connection.map.message.name)
