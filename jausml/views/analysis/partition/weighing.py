"""Weighing: what connections cost a bridge, alone and together, and what it may carry at most."""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import networkx

from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.metamodel.classes.system import Host, System
from jausml.language.semantics.connections.reports import joined_reports
from jausml.language.semantics.connections.topics import endpoints
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.hosts import host_of
from jausml.language.semantics.paths.scopes import Carrier, carriers_of, maps_of
from jausml.views.analysis.partition.ties import commands, full_name, serves, tied
from jausml.views.analysis.report import connection_report, seconds_of_message
from jausml.views.analysis.sizes import Assumptions, runtime_constants
from jausml.views.analysis.streams import Stream, Traffic, on_wire
from jausml.views.analysis.traffic import traffic_of

LARGEST_SHARE = 0.5
"""Share of a processor that a bridge may take: the other half is for what was not foreseen."""

SAFE = ("authority", "defaultAuthority", "controlTimeout", "guardian")
"""Decisions of a person about commands of a bridge: they go along; different ones stay apart."""


@dataclass(frozen=True)
class Limits:
    """The wishes of a person for a partition.

    Attributes:
        most: Connections of a bridge at most.
        load: Share of a processor that a bridge takes at most.
        wait: Seconds that a message waits at most when one of each connection comes at once.
        together: Names of connections that one bridge shall carry.
        inside: Names of connections, and of the bridges that shall carry them.
    """

    most: int = 0
    load: float = LARGEST_SHARE
    wait: float = math.inf
    together: tuple[tuple[str, ...], ...] = ()
    inside: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class Cost:
    """The costs of connections for their bridge.

    Attributes:
        connections: How many there are.
        share: Share of a processor, as `jausml report` has it.
        wait: Seconds of work when one message of each comes at once.
        datagrams: Datagrams each second, by what several connections share.
        remote: Bytes each second to and from hosts, by what several connections share.
    """

    connections: int
    share: float
    wait: float
    datagrams: Mapping[Hashable, float]
    remote: Mapping[tuple[Hashable, Host], float]

    @cached_property
    def by_host(self) -> Counter[Host]:
        """Bytes each second to and from each host."""
        octets: Counter[Host] = Counter()
        for (_, where), each_second in self.remote.items():
            octets[where] += each_second  # type: ignore[assignment]
        return octets

    def away(self, host: Host | None) -> float:
        """Returns the bytes each second that cross the network when all of it is on a host."""
        return sum(self.by_host.values()) - self.by_host[host]  # type: ignore[index]


def united(costs: Sequence[Cost]) -> Cost:
    """Returns the sum of costs in one bridge: shared ones count once."""
    first, *others = costs or [Cost(0, 0.0, 0.0, {}, {})]
    connections, share, wait = first.connections, first.share, first.wait
    datagrams, remote = dict(first.datagrams), dict(first.remote)
    for cost in others:
        connections += cost.connections
        share += cost.share
        wait += cost.wait
        for key, packets in cost.datagrams.items():
            datagrams[key] = max(packets, datagrams.get(key, 0))
        for place, octets in cost.remote.items():
            remote[place] = max(octets, remote.get(place, 0))
    return Cost(connections, share, wait, datagrams, remote)


ALWAYS_ALIKE = 4
"""So many of what `world_of` begins with hold for connections of all kinds."""


def world_of(owner: bridge.Bridge) -> tuple[tuple[str, Hashable], ...]:
    """Returns the properties that all connections of a bridge have in common."""
    return (
        ("namespace", (owner.namespace or "").strip("/")),
        ("subsystem", str(owner.address).partition(".")[0]),
        ("allowedHosts", tuple(sorted(map(str, owner.allowedHosts)))),
        ("fixedSources", bool(owner.fixedSources)),
        *((name, getattr(owner, name)) for name in SAFE),
        *(
            (f"quantity {quantity.name}", f"{quantity.value:g} {quantity.units or ''}")
            for quantity in owner.quantities
        ),
    )


@dataclass(frozen=True, eq=False)
class Group:
    """Connections that stay in one bridge.

    Attributes:
        origins: The bridge of each now.
        pin: Name of the bridge that has to carry them; empty for any.
        world: What all that a bridge carries has in common: namespace, subsystem, safety, the pin.
        unique: What no bridge can have twice.
    """

    carriers: tuple[Carrier, ...]
    origins: tuple[bridge.Bridge, ...]
    reasons: tuple[str, ...]
    cost: Cost
    pin: str
    world: frozenset[tuple[str, Hashable]]
    unique: frozenset[Hashable]


class Weighing:
    """The connections of a system that may be moved, and the costs of their partitions.

    External bridges are as somebody else has made them.
    """

    def __init__(self, system: System, assumptions: Assumptions) -> None:
        self.system = system
        self.owners = [owner for owner in system.bridges if not owner.external]
        self._assumptions = assumptions
        self._traffic: Traffic = traffic_of(system, assumptions)
        self._upkeep: dict[object, list[Stream]] = defaultdict(list)
        for stream in self._traffic.streams:
            if stream.kind == "upkeep":
                self._upkeep[stream.sender, stream.receiver].append(stream)
                self._upkeep[stream.receiver, stream.sender].append(stream)
        self._nodes: dict[str, set[Host]] = defaultdict(set)
        for end in endpoints(system.nodes):
            host = host_of(system, end.owner) if isinstance(end.owner, ros.Node) else None
            if host is not None:
                self._nodes[end.topic].add(host)
        self.costs = {
            carrier: self._cost(owner, carrier)
            for owner in self.owners
            for carrier in carriers_of(owner)
        }

    @cached_property
    def owner_of(self) -> Mapping[Carrier, bridge.Bridge]:
        """The bridge of each connection now."""
        return {carrier: owner for owner in self.owners for carrier in carriers_of(owner)}

    @cached_property
    def participants(self) -> Sequence[jaus.Component | ros.Node]:
        """The components, bridges and nodes: all that have a name and run somewhere."""
        return (*self.system.components, *self.system.bridges, *self.system.nodes)

    @cached_property
    def homes(self) -> Mapping[bridge.Bridge, Host | None]:
        """The host of each bridge."""
        return {owner: host_of(self.system, owner) for owner in self.owners}

    @cached_property
    def hosts(self) -> list[Host]:
        """The hosts on which bridges can run: where something of ROS does."""
        of_ros = (
            participant
            for participant in self.participants
            if isinstance(participant, bridge.Bridge | ros.Node)
        )
        known = [host_of(self.system, participant) for participant in of_ros]
        return list(dict.fromkeys(host for host in known if host is not None))

    def groups(self, limits: Limits, *, are_divided: bool = False) -> list[Group]:
        """Returns the groups that cannot be divided, by the model and by a person's wish."""
        graph: networkx.Graph[Carrier] = networkx.Graph()
        graph.add_nodes_from(self.costs)
        reasons: dict[Carrier, dict[str, None]] = defaultdict(dict)
        wanted = [("you want it so", self._named(names)) for names in limits.together]
        pins = self._pins(limits)
        for name in dict.fromkeys(pins.values()):
            pinned = [carrier for carrier in pins if pins[carrier] == name]
            # What commands a bridge stays in it, and so with what is to come there.
            pinned += [
                carrier
                for carrier, owner in self.owner_of.items()
                if owner.name == name and _commands(carrier)
            ]
            wanted.append((f"you want it in {name}", pinned))
        for reason, carriers in () if are_divided else (*tied(self.owners), *wanted):
            networkx.add_path(graph, carriers)
            reasons[carriers[0]][reason] = None
        order = {carrier: number for number, carrier in enumerate(self.costs)}
        parts = (
            sorted(group, key=order.__getitem__) for group in networkx.connected_components(graph)
        )
        return [
            self._group(
                carriers, pins, [reason for carrier in carriers for reason in reasons[carrier]]
            )
            for carriers in parts
        ]

    def _pins(self, limits: Limits) -> dict[Carrier, str]:
        pins: dict[Carrier, str] = {}
        for name, owner in limits.inside:
            (carrier,) = self._named((name,))
            if pins.setdefault(carrier, owner) != owner:
                raise LookupError(f"{name} cannot be in {pins[carrier]} and in {owner}")
        return pins

    def _named(self, names: Iterable[str]) -> list[Carrier]:
        carriers = []
        for name in names:
            some = [
                carrier
                for carrier, owner in self.owner_of.items()
                if name in (str(carrier.name), f"{owner.name}.{carrier.name}")
            ]
            if len(some) != 1:
                known = "no connection" if not some else "more than one connection"
                raise LookupError(f"{known} {name}" + (": write BRIDGE.NAME" if some else ""))
            carriers += some
        return carriers

    def _group(
        self, carriers: Sequence[Carrier], pins: Mapping[Carrier, str], reasons: Iterable[str]
    ) -> Group:
        owners = [self.owner_of[carrier] for carrier in carriers]
        pairs = list(zip(owners, carriers, strict=True))
        commanding = [owner for owner, carrier in pairs if commands(carrier)]
        # Who commands a bridge knows it by its JAUS id.
        commanded = [owner for owner, carrier in pairs if _commands(carrier)]
        pinned = {pins[carrier] for carrier in carriers if carrier in pins} or {
            str(owner.name) for owner in commanded
        }
        names = {str(owner.name): owner for owner in self.owners}
        world = {pair for owner in owners for pair in world_of(owner)[:ALWAYS_ALIKE]}
        for home in map(self.homes.get, owners):
            world |= {("transport", home.transport.name)} if home is not None else set()
        for owner in (*commanding, *(names[pin] for pin in pinned if pin in names)):
            world.update(world_of(owner))
        world.update(("bridge", pin) for pin in pinned)
        for owner, carrier in pairs:
            stated = dict(world_of(owner))
            for quantity in (quantity for map_ in maps_of(carrier) for quantity in map_.quantities):
                key = f"quantity {quantity.name}"
                world.add((key, stated.get(key, "what the map says")))
            if isinstance(carrier, bridge.Connection) and any(
                report.rate and not report.stated_rate for report in joined_reports(carrier)
            ):
                world.add(("frequency", owner.frequency))
        unique = frozenset(
            str(service.urn)
            for owner, carrier in pairs
            for service in owner.provides
            if isinstance(carrier, bridge.Connection) and serves(service, carrier)
        )
        cost = united([self.costs[carrier] for carrier in carriers])
        return Group(
            tuple(carriers), tuple(owners), tuple(dict.fromkeys(reasons)), cost,
            " and ".join(sorted(pinned)), frozenset(world), unique,
        )  # fmt: skip

    def _cost(self, owner: bridge.Bridge, carrier: Carrier) -> Cost:
        if not isinstance(carrier, bridge.Connection):
            return Cost(1, 0, 0, {}, {})  # nobody knows how often something is called
        report = connection_report(carrier, self._traffic, self._assumptions)
        streams = self._traffic.of(carrier)
        datagrams: dict[Hashable, float] = {}
        remote: dict[tuple[Hashable, Host], float] = {}
        for stream in (*streams, *self._kept_up(owner, carrier)):
            other = _other(owner, stream)
            key: Hashable = other, stream.message, stream.sender is owner
            if "Event" in stream.message:
                key = key, report.message
            elif stream.kind not in ("event", "upkeep"):
                key = id(stream)
            wire = stream.forth + stream.back
            datagrams[key] = wire.packets
            where = host_of(self.system, other) if other is not None else None
            if where is not None:
                remote[key, where] = wire.ethernet
        octets = on_wire(report.ros.bytes.expected, runtime_constants().largest_fragment).ethernet
        for topic in carrier.topics:
            name = full_name(owner, str(topic.name))
            # What two bridges hear is sent to both; what they publish is theirs.
            key = name if not is_to_ros(carrier) else (name, id(carrier))
            hertz = report.ros.messages_per_s / max(1, len(report.topics))
            for where in self._nodes.get(name, ()):
                remote[key, where] = octets * hertz
        return Cost(
            1,
            report.share,
            seconds_of_message(carrier, streams, report.ros.bytes),
            datagrams,
            remote,
        )

    def _kept_up(self, owner: bridge.Bridge, carrier: bridge.Connection) -> Iterator[Stream]:
        """Yields the streams that keep control of a peer, or of the bridge, and events alive."""
        streams = self._traffic.of(carrier)
        has_event = any(stream.kind == "event" for stream in streams)
        for other in dict.fromkeys(_other(owner, stream) for stream in streams):
            for stream in self._upkeep[owner, other]:
                if has_event if "Event" in stream.message else commands(carrier):
                    yield stream


def _commands(carrier: Carrier) -> bool:
    """Tells whether its bridge is commanded by a connection."""
    return is_to_ros(carrier) and commands(carrier)


def _other(owner: bridge.Bridge, stream: Stream) -> jaus.Component | None:
    """Returns the other end of a stream of a bridge."""
    return stream.receiver if stream.sender is owner else stream.sender
