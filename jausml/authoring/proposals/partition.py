"""Partitions as commands: connections go to other bridges, with all that is theirs alone.

What a person has decided about safety goes along as it is; nothing of it is made up here.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any

from jausml.authoring.editing.commands import (
    NEW,
    Add,
    Child,
    Command,
    Move,
    Movement,
    Remove,
    Rename,
    Set,
)
from jausml.authoring.proposals.bridging import has_message
from jausml.authoring.proposals.elements import AnswerError, Option, Scope, literal
from jausml.authoring.proposals.new_elements import free_address, free_name
from jausml.language.metamodel.classes import bridge, jaus, ros, system
from jausml.language.model.names import name_of
from jausml.language.semantics.directions import TO_JAUS, TO_ROS, is_to_ros
from jausml.language.semantics.hosts import host_of
from jausml.language.semantics.jaus.core_services import CORE
from jausml.language.semantics.jaus.services import code
from jausml.language.semantics.paths.scopes import carriers_of, maps_of
from jausml.views.analysis.partition.ties import full_name, serves

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.semantics.paths.scopes import Carrier
    from jausml.views.analysis.partition.plans import Plan, Planned, Planner

_COPIED = (
    *("namespace", "frequency", "type", "authority", "defaultAuthority", "controlTimeout"),
    *("eventTimeout", "coreServices", "guardian", "allowedHosts", "fixedSources"),
    *("amplificationLimit", "maxPeers", "maxConnections", "idleTimeout", "maxEvents"),
    "eventRateBudget",
)
"""The features that a new bridge has from the one whose connections it carries."""

_FEATURES: Mapping[type, str] = {
    bridge.Connection: "bridgeConnections",
    bridge.RosServiceConnection: "serviceConnections",
    bridge.RosActionConnection: "actionConnections",
    bridge.AttributeMap: "maps",
}


def taken_over(
    scope: Scope, planner: Planner, carriers: Sequence[Carrier], target: str = ""
) -> Option:
    """Returns the option that moves connections to a bridge, with those that have to go along.

    `target`: its name; empty for a new one. `AnswerError`: they cannot be there.
    """
    known = planner.companions(carriers)
    along = [carrier for carrier in known if carrier not in carriers]
    target = target or planner.new_name(carriers[0])
    plan = planner.assigned(dict.fromkeys(known, target), are_kept=True)
    what = ", ".join(map(name_of, known))
    why = "; ".join(dict.fromkeys(reason for carrier in along for reason in known[carrier]))
    label, commands = f"Move {what} to {target}", commands_of(scope, plan)
    return Option(label, why, commands, preview=_told(plan))


def _told(plan: Plan) -> str:
    return "\n".join(
        f"{new.name}: {len(new.carriers)} connections, {new.share:.1%} of a processor, "
        f"{new.datagrams:.0f} datagrams/s"
        for new in plan.after
    )


def commands_of(scope: Scope, plan: Plan) -> list[Command]:
    """Returns the commands by which the bridges of a system become those of a plan.

    `AnswerError`: the plan has faults.
    """
    if plan.faults:
        raise AnswerError("; ".join(plan.faults))
    return list(_Applying(scope, plan).commands())


def burden(owner: EObject, component: jaus.Component, node: EObject) -> tuple[int, int]:
    """Returns a sort key of bridges: the one that serves a component and a node best is first."""
    carried = len(owner.bridgeConnections) if isinstance(owner, bridge.Bridge) else 0
    return -len(merits_of(owner, component, node)), carried


def merits_of(owner: EObject, component: jaus.Component, node: EObject) -> list[str]:
    """Returns the reasons why a bridge suits a component and a node."""
    whole = owner.eContainer()
    if not isinstance(owner, bridge.Bridge) or not isinstance(whole, system.System):
        return []
    merits = []
    if any(component in connection.peers for connection in owner.bridgeConnections):
        merits.append(f"serves {name_of(component)} already")
    if isinstance(node, ros.Node) and len(whole.bridges) > 1:
        host = host_of(whole, node)
        if host is not None and host is host_of(whole, owner):
            merits.append(f"runs on {name_of(host)}, as {name_of(node)} does")
    return merits


class _Applying:
    """Maker of the commands of a plan; refs are those before all of them, but for new elements."""

    def __init__(self, scope: Scope, plan: Plan) -> None:
        self._scope = scope
        self._plan = plan
        self._home = {carrier: old.origin for old in plan.before for carrier in old.carriers}
        self._moved = dict(plan.moved)
        self._new = [planned for planned in plan.after if planned.owner is None]
        self._whole: system.System = plan.before[0].origin.eContainer()  # type: ignore[assignment]

    def commands(self) -> Iterator[Command]:
        """Yields the commands in an order in which the refs of each hold."""
        yield from self._new_bridges()
        for carrier, planned in self._moved.items():
            yield from self._kept(carrier, planned)
        yield from self._redirected()
        for planned in self._plan.after:
            if planned.owner is not None:
                for feature, services in self._services(planned).items():
                    if services != list(getattr(planned.owner, feature)):
                        yield self._set(planned.owner, feature, services)
        for owner in self._plan.gone:
            yield from (self._set(owner, feature, ()) for feature in ("provides", "uses"))
        going = self._going()
        yield from self._renamed(going)
        # At once: the files are read again after each command.
        if moves := tuple(self._moves(going)):
            first = moves[0]
            yield Move(first.element, first.owner, first.feature, first.position, moves[1:])
        yield from self._more_quantities()
        yield from self._placements()
        left = [owner for owner in self._plan.gone if self._is_empty(owner)]
        # The last one first: those behind one that goes have other positions.
        for owner in sorted(left, key=list(self._whole.bridges).index, reverse=True):
            yield Remove(self._scope.ref(owner))

    def _ref(self, planned: Planned) -> str:
        if planned.owner is not None:
            return self._scope.ref(planned.owner)
        return f"{NEW}{self._new.index(planned)}"

    def _set(self, element: Any, feature: str, values: Sequence[Any]) -> Set:
        refs = tuple(
            value if isinstance(value, str) else self._scope.ref(value) for value in values
        )
        return Set(self._scope.ref(element), feature, refs)

    def _new_bridges(self) -> Iterator[Command]:
        addresses: list[str] = []
        for planned in self._new:
            origin = planned.origin
            addresses.append(free_address(self._scope.model, addresses, str(origin.address)))
            values: dict[str, tuple[str, ...]] = {
                "name": (planned.name,),
                "address": (addresses[-1],),
            }
            for name in _COPIED:
                # What is stated says that somebody has decided it, be it the default.
                if origin.eIsSet(name):
                    stated = getattr(origin, name)
                    many = stated if name == "allowedHosts" else (stated,)
                    values[name] = tuple(map(literal, many))
            for feature, services in self._services(planned).items():
                if services:
                    values[feature] = tuple(map(self._scope.ref, services))
            children = tuple(self._quantities(planned))
            yield Add(self._scope.ref(self._whole), "bridges", "bridge.Bridge", values, children)

    def _quantities(self, planned: Planned) -> Iterator[Child]:
        """Yields the quantities of a bridge that maps of its new connections need."""
        known = (
            {name_of(quantity) for quantity in planned.owner.quantities} if planned.owner else set()
        )
        for carrier in planned.carriers:
            needed = {
                name_of(quantity) for map_ in maps_of(carrier) for quantity in map_.quantities
            }
            for quantity in self._home[carrier].quantities:
                if name_of(quantity) in needed - known:
                    known.add(name_of(quantity))
                    stated = {"name": (name_of(quantity),), "value": (literal(quantity.value),)}
                    if quantity.units:
                        stated["units"] = (str(quantity.units),)
                    yield Child("quantities", "bridge.Quantity", stated)

    def _kept(self, carrier: Carrier, planned: Planned) -> Iterator[Command]:
        """Yields the values that a connection has to state in a bridge that states others."""
        old, new = self._home[carrier], planned.origin
        is_elsewhere = (old.namespace or "").strip("/") != (new.namespace or "").strip("/")
        named: list[tuple[Any, str]] = [(carrier, "service"), (carrier, "action")]
        if isinstance(carrier, bridge.Connection):
            named = [(topic, "name") for topic in carrier.topics]
            is_timed = carrier.exchange.name in ("periodicEvent", "query")
            if is_timed and not carrier.rate and old.frequency != new.frequency:
                yield self._set(carrier, "rate", (literal(old.frequency),))
        for element, feature in named:
            name = str(getattr(element, feature, ""))
            if name.startswith("~") or (is_elsewhere and name and not name.startswith("/")):
                yield self._set(element, feature, (full_name(old, name),))

    def _redirected(self) -> Iterator[Command]:
        """Yields the commands that lead components to services of the bridge that now has them."""
        for owner in (*self._whole.components, *self._whole.bridges):
            for wanted in owner.connections:
                partner = self._partner(owner, wanted.provider, wanted.message, TO_JAUS)
                if partner is not None:
                    yield self._set(wanted, "provider", (self._ref(partner),))
            for carrier in carriers_of(owner) if isinstance(owner, bridge.Bridge) else ():
                # What one sends to ROS, another one has from there, and the other way round.
                way = TO_JAUS if is_to_ros(carrier) else TO_ROS
                yield from self._peers(owner, carrier, carrier, _message(carrier), way)
                for source in carrier.sources if isinstance(carrier, bridge.Connection) else ():
                    yield from self._peers(owner, carrier, source, source.join.message, TO_JAUS)

    def _peers(
        self,
        owner: jaus.Component,
        carrier: Carrier,
        asking: Any,
        message: jaus.MessageDef | None,
        way: str,
    ) -> Iterator[Command]:
        values = []
        for peer in asking.peers:
            # A bridge that is its own peer stays so.
            own = self._moved.get(carrier) if peer is owner else None
            is_other = own is None and peer is not owner
            partner = self._partner(owner, peer, message, way) if is_other else own
            values.append(self._ref(partner) if partner is not None else self._scope.ref(peer))
        if values != [self._scope.ref(peer) for peer in asking.peers]:
            yield self._set(asking, "peers", values)

    def _partner(
        self,
        owner: jaus.Component,
        peer: jaus.Component | None,
        message: jaus.MessageDef | None,
        way: str,
    ) -> Planned | None:
        """Returns the new place of the messages of a bridge to an owner; None for no change."""
        if message is None:
            return None
        homes = [
            self._moved.get(carrier)
            for carrier, home in self._home.items()
            if home is peer
            and carrier.direction.name == way
            and (not carrier.peers or owner in carrier.peers)
            and (own := _message(carrier)) is not None
            and code(own) == code(message)
        ]
        return homes[0] if homes and None not in homes else None

    def _services(self, planned: Planned) -> dict[str, list[jaus.Service]]:
        """Returns the services that a bridge provides and uses, as its connections need them."""
        known: dict[str, list[jaus.Service]] = {"provides": [], "uses": []}
        sources = [planned.owner] if planned.owner else []
        sources += [
            self._home[carrier]
            for carrier in planned.carriers
            if self._home[carrier] is not planned.owner
        ]
        for source in dict.fromkeys(sources):
            for feature, services in known.items():
                for service in getattr(source, feature):
                    is_core = feature == "provides" and str(service.urn).startswith(CORE)
                    if service in services or (is_core and planned.owner not in (None, source)):
                        continue
                    users = [
                        carrier
                        for carrier in carriers_of(source)
                        if _needs(carrier, service, feature)
                    ]
                    remains = source is planned.owner and not all(
                        carrier in self._moved for carrier in users
                    )
                    remains |= source is planned.owner and not users
                    comes = any(self._moved.get(carrier) is planned for carrier in users)
                    if remains or comes or (is_core and planned.owner is None):
                        services.append(service)
        return known

    def _going(self) -> dict[Any, Planned]:
        """Returns the elements that move: connections, and the maps that they alone use.

        A map whose users part goes with the first of them, if nothing of its bridge remains.
        """
        going: dict[Any, Planned] = dict(self._moved)
        for owner in dict.fromkeys(self._home[carrier] for carrier in self._moved):
            for map_ in owner.maps:
                users = [carrier for carrier in self._home if map_ in maps_of(carrier)]
                targets = [self._moved[carrier] for carrier in users if carrier in self._moved]
                if not targets or len(targets) < len(users):
                    continue
                if owner in self._plan.gone or all(target is targets[0] for target in targets):
                    going[map_] = targets[0]
        return going

    def _renamed(self, going: Mapping[Any, Planned]) -> Iterator[Command]:
        """Yields new names for elements whose names are taken in their new place."""
        taken: dict[tuple[str, str], list[str]] = defaultdict(list)
        for planned in self._plan.after:
            for feature in _FEATURES.values() if planned.owner is not None else ():
                kept = (
                    service for service in getattr(planned.owner, feature) if service not in going
                )
                taken[planned.name, feature] += map(name_of, kept)
        maps = self._scope.model.instances(bridge.AttributeMap)
        for element, planned in going.items():
            known, name = taken[planned.name, _FEATURES[type(element)]], name_of(element)
            if isinstance(element, bridge.AttributeMap):
                # On their way, texts of two bridges name it: there must be no other of its name.
                known += [name_of(map_) for map_ in maps if map_ is not element]
            free = free_name(name, known) if name in known else name
            known.append(free)
            if free != name:
                yield Rename(self._scope.ref(element), free)

    def _moves(self, going: Mapping[Any, Planned]) -> Iterator[Movement]:
        """Yields the movements of connections and maps; refs are those before all of it."""
        counts: dict[tuple[str, str], int] = defaultdict(int)
        lists: dict[tuple[Any, str], list[Any]] = defaultdict(list)
        for element in going:
            lists[element.eContainer(), _FEATURES[type(element)]].append(element)
        for owner, feature in lists:
            counts[name_of(owner), feature] = len(getattr(owner, feature))
        for (owner, feature), elements in lists.items():
            # The last one first, each to the same position: they arrive in order.
            order = list(getattr(owner, feature))
            for element in sorted(elements, key=order.index, reverse=True):
                planned = going[element]
                at = counts.get((planned.name, feature), len(getattr(planned.owner, feature, ())))
                yield Movement(self._scope.ref(element), self._ref(planned), feature, at)
                counts[name_of(owner), feature] -= 1

    def _more_quantities(self) -> Iterator[Command]:
        """Yields the quantities that existing bridges have to state from now on."""
        for planned in self._plan.after:
            if planned.owner is not None:
                for child in self._quantities(planned):
                    yield Add(self._ref(planned), child.feature, child.kind, child.values)

    def _placements(self) -> Iterator[Command]:
        placed: dict[system.Host, list[str]] = defaultdict(list)
        left: set[jaus.Component] = set()
        for planned in self._plan.after:
            home = host_of(self._whole, planned.owner) if planned.owner is not None else None
            first = next(iter(self._whole.hosts), None)
            if planned.host is None or planned.host is home or (not home and planned.host is first):
                continue
            placed[planned.host].append(self._ref(planned))
            left |= {planned.owner} if planned.owner is not None else set()
        for placement in self._whole.placements:
            new = placed.pop(placement.host, [])
            kept = [
                self._scope.ref(component)
                for component in placement.components
                if component not in left
            ]
            if not (new or kept or placement.nodes):
                yield Remove(self._scope.ref(placement))
            elif new or len(kept) < len(placement.components):
                yield Set(self._scope.ref(placement), "components", (*kept, *new))
        for host, some in placed.items():
            values = {"host": (self._scope.ref(host),), "components": tuple(some)}
            yield Add(self._scope.ref(self._whole), "placements", "system.Placement", values)

    def _is_empty(self, owner: bridge.Bridge) -> bool:
        """Tells whether a bridge is empty once its connections have gone."""
        kept = set(owner.maps).difference(self._going())
        is_used = any(not kept.isdisjoint(maps_of(carrier)) for carrier in self._home)
        return not (owner.connections or owner.controls or is_used)


def _message(carrier: Carrier) -> jaus.MessageDef | None:
    if isinstance(carrier, bridge.Connection):
        return carrier.map.message
    return carrier.message if isinstance(carrier, bridge.RosServiceConnection) else None


def _needs(carrier: Carrier, service: jaus.Service, feature: str) -> bool:
    """Tells whether a bridge provides or uses a service for a connection."""
    message = _message(carrier)
    if feature == "provides":
        if isinstance(carrier, bridge.Connection):
            return serves(service, carrier)
        return is_to_ros(carrier)
    if isinstance(carrier, bridge.Connection) and serves(service, carrier):
        return False
    return message is None or has_message([service], message)
