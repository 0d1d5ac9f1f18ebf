"""Who of a deployed system exchanges what with whom over which ports, and what is left open."""

from __future__ import annotations

import ipaddress
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from jausml.generation.errors import GenerationError
from jausml.generation.target import system_of
from jausml.language.metamodel.classes import jaus
from jausml.language.metamodel.classes.bridge import Bridge
from jausml.language.metamodel.classes.system import Host, System
from jausml.language.model.model import Model
from jausml.language.semantics.hosts import endpoint_of, host_of, is_ipv4
from jausml.language.semantics.paths.scopes import carriers_of
from jausml_generators.bringup.processes import ProcessView


@dataclass(frozen=True)
class Peer:
    """A JAUS component of another host."""

    name: str
    address: str
    endpoint: str


@dataclass(frozen=True)
class Deployed:
    """A host of processes of the system, and its network traffic."""

    host: Host
    processes: tuple[ProcessView, ...]
    peers: tuple[Peer, ...]
    jaus_hosts: tuple[str, ...]
    ros_hosts: tuple[str, ...]
    questions: tuple[str, ...]

    @property
    def transport(self) -> str:
        """How its JAUS messages travel: `judp`, `jtcp` or `nodeManager`."""
        return str(self.host.transport.name)

    @property
    def finds_by_multicast(self) -> bool:
        """Whether components of other hosts are found by multicast."""
        return _finds_by_multicast(self.host)

    @property
    def speaks_jaus(self) -> bool:
        """Whether some process is a JAUS component."""
        return any(process.speaks_jaus for process in self.processes)

    @property
    def speaks_ros(self) -> bool:
        """Whether some process is a ROS 2 node."""
        return any(process.speaks_ros for process in self.processes)

    @property
    def jaus_ports(self) -> tuple[str, ...]:
        """Ports at which its JAUS processes are reached: single ones, and ranges."""
        speaking = sum(process.speaks_jaus for process in self.processes)
        return jaus_ports(self.host, speaking)


def deployed_hosts(model: Model, processes: Sequence[ProcessView]) -> tuple[Deployed, ...]:
    """Returns the hosts that processes of a system run on, in the order of the model.

    Raises:
        GenerationError: The model has no host, or one that the others cannot reach.
    """
    system = system_of(model)
    faults = list(_faults(system))
    if faults:
        located = (
            f"{model.location(element, feature)}: {text}" for element, feature, text in faults
        )
        raise GenerationError("; ".join(located))
    by_host = {host: _of_host(processes, host) for host in system.hosts}
    return tuple(_deployed(system, host, by_host) for host in system.hosts if by_host[host])


def _faults(system: System) -> Iterator[tuple[System | Host, str, str]]:
    """Yields the obstacles for several hosts to hear each other: element, feature and fault."""
    if not system.hosts:
        fault = f"system '{system.name}' has no host to deploy on; add one,"
        yield system, "hosts", f'{fault} for example: host onboard {{ interface: "192.168.0.7" }}'
        return
    first, *others = system.hosts
    if others:
        yield from _unreachable(system.hosts)
    for other in others:
        if not (_finds_by_multicast(other) and _finds_by_multicast(first)):
            continue
        for feature in ("port", "multicastGroup"):
            here, there = getattr(other, feature), getattr(first, feature)
            if here != there:
                fault = f"host '{other.name}' has {feature} {here} and '{first.name}' {there}"
                yield other, feature, f"{fault}, so that they do not find each other"


def _unreachable(hosts: Iterable[Host]) -> Iterator[tuple[Host, str, str]]:
    """Yields the hosts with an interface that others cannot reach, or that another one has."""
    owners: dict[ipaddress.IPv4Address, Host] = {}
    for host in hosts:
        address = ipaddress.IPv4Address(host.interface)
        fault = f"host '{host.name}' has the interface {address}"
        if address.is_loopback:
            yield host, "interface", f"{fault}, which no other host reaches"
        elif (owner := owners.setdefault(address, host)) is not host:
            yield host, "interface", f"{fault}, which is that of '{owner.name}'"


def _finds_by_multicast(host: Host) -> bool:
    return host.transport.name != "jtcp" and host.multicastTtl > 0


def _of_host(processes: Iterable[ProcessView], host: Host) -> tuple[ProcessView, ...]:
    return tuple(process for process in processes if process.host == host.name)


def _deployed(system: System, host: Host, by_host: dict[Host, tuple[ProcessView, ...]]) -> Deployed:
    elsewhere = [
        (component, where)
        for component in (*system.components, *system.bridges)
        if (where := host_of(system, component)) is not None and where is not host
    ]
    allowed = [text for bridge in bridges_on(system, host) for text in bridge.allowedHosts]
    allowed += _stated_addresses(system)
    speaks_jaus = any(process.speaks_jaus for process in by_host[host])
    speaks_ros = any(process.speaks_ros for process in by_host[host])
    return Deployed(
        host=host,
        processes=by_host[host],
        peers=tuple(
            Peer(component.name, str(component.address), f"{where.interface}:{where.port}")
            for component, where in sorted(elsewhere, key=lambda pair: _key(pair[0]))
        ),
        # A host on which the model runs nothing is there for what others run on it.
        jaus_hosts=_networks(
            [*(str(other.interface) for other in system.hosts if other is not host), *allowed]
        )
        if speaks_jaus
        else (),
        ros_hosts=_networks(
            other.interface
            for other, those in by_host.items()
            if speaks_ros and other is not host and any(process.speaks_ros for process in those)
        ),
        questions=tuple(questions(system, host, by_host[host])),
    )


def _stated_addresses(system: System) -> list[str]:
    """Returns the IPv4 addresses that are stated of components on no host of the system."""
    places = (
        endpoint_of(system, component)
        for component in (*system.components, *system.bridges)
        if host_of(system, component) is None
    )
    return [place[0] for place in places if place is not None and is_ipv4(place[0])]


def _key(component: jaus.Component) -> tuple[int, ...]:
    return tuple(int(part) for part in str(component.address).split("."))


def _networks(texts: Iterable[str]) -> tuple[str, ...]:
    """Returns addresses and networks, sorted, none within another."""
    all_of_them = {ipaddress.IPv4Network(text) for text in texts}
    networks = [
        network
        for network in sorted(all_of_them)
        if not any(network != other and network.subnet_of(other) for other in all_of_them)
    ]
    return tuple(str(network).removesuffix("/32") for network in networks)


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


_UNKNOWN_MAINTAINER = "maintainer@example.com"


def bridges_on(system: System, host: Host) -> list[Bridge]:
    """Returns the bridges of a system that run on a host."""
    return [bridge for bridge in system.bridges if host_of(system, bridge) is host]


def questions(system: System, host: Host, processes: Sequence[ProcessView]) -> Iterator[str]:
    """Yields the open questions of the model, and the values used instead."""
    speaking = sum(process.speaks_jaus for process in processes)
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
    """Yields the questions for the places of components of other makers."""
    if any(bridge.allowedHosts for bridge in bridges_on(system, host)):
        return
    for component in (*system.components, *system.bridges):
        place = endpoint_of(system, component)
        if component.external and (place is None or not is_ipv4(place[0])):
            yield (
                f"Where is `{component.name}` ({component.address})? Place it on a "
                "host, or name its network in `allowedHosts` of a bridge: until then the "
                "firewall keeps it out."
            )


def _of_connections(bridges: Sequence[Bridge]) -> Iterator[str]:
    """Asks where the peers of connections may be that name none."""
    for bridge in bridges:
        names = [f"`{carrier.name}`" for carrier in carriers_of(bridge) if not carrier.peers]
        if names and not bridge.allowedHosts:
            yield (
                f"Where are the peers of {', '.join(names)} of `{bridge.name}`? No component is"
                " named; `allowedHosts` of the bridge says where they may be: until then the"
                " firewall lets in the other hosts of the system alone."
            )
