"""What the files of a host need and the model does not say, as questions to who deploys."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.semantics.hosts import endpoint_of, host_of, is_ipv4
from jausml_generators.deployment.ports import HIGHEST_SHARED_PORT

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.language.metamodel.classes.bridge import (
        Bridge,
        Connection,
        RosActionConnection,
        RosServiceConnection,
    )
    from jausml.language.metamodel.classes.system import Host, System
    from jausml_generators.bringup.views import ProcessView

_UNKNOWN_MAINTAINER = "maintainer@example.com"


def bridges_on(system: System, host: Host) -> list[Bridge]:
    """Returns the bridges of a system that run on a host."""
    return [each for each in system.bridges if host_of(system, each) is host]


def questions(system: System, host: Host, processes: Sequence[ProcessView]) -> Iterator[str]:
    """Asks what the model leaves open, and says what stands in its place."""
    speaking = sum(each.speaks_jaus for each in processes)
    if speaking:
        yield from _of_strangers(system, host)
        yield from _of_connections(bridges_on(system, host))
    if speaking > 1 and host.transport.name == "judp" and host.port > HIGHEST_SHARED_PORT:
        yield (
            f"Which ports have the processes that do not own port {host.port}? Above"
            f" {HIGHEST_SHARED_PORT} the system picks them, and no firewall knows them: choose a"
            " lower `port`."
        )
    if speaking and host.transport.name == "nodeManager":
        yield (
            "Which node manager has this host, and who starts it? It is no part of the model; the"
            " processes wait for it, and look for its sockets in `/tmp`."
        )
    if system.maintainerEmail == _UNKNOWN_MAINTAINER:
        yield (
            "Who maintains the packages? `maintainer` and `maintainerEmail` of the system have"
            " their defaults, which bloom takes and nobody should publish."
        )
    yield (
        "Who administers this computer? The firewall lets nobody in by SSH;"
        " say in `firewall.local.nft` from where they come."
    )


def _of_strangers(system: System, host: Host) -> Iterator[str]:
    """Asks where components are that somebody else has put somewhere."""
    if any(each.allowedHosts for each in bridges_on(system, host)):
        return
    for each in (*system.components, *system.bridges):
        place = endpoint_of(system, each)
        if each.external and (place is None or not is_ipv4(place[0])):
            yield (
                f"Where is `{each.name}` ({each.address})? Place it on a host, or name its network"
                " in `allowedHosts` of a bridge: until then the firewall keeps it out."
            )


def _of_connections(bridges: Sequence[Bridge]) -> Iterator[str]:
    """Asks where the peers of connections may be that name none."""
    for each in bridges:
        connections: list[Connection | RosServiceConnection | RosActionConnection] = [
            *each.bridgeConnections,
            *each.serviceConnections,
            *each.actionConnections,
        ]
        names = [f"`{one.name}`" for one in connections if not one.peers]
        if names and not each.allowedHosts:
            yield (
                f"Where are the peers of {', '.join(names)} of `{each.name}`? No component is"
                " named; `allowedHosts` of the bridge says where they may be: until then the"
                " firewall lets in the other hosts of the system alone."
            )
