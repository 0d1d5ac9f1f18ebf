"""Splitting: the bridges of a proposal, made of those that a model has."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, TypeVar, cast

from jausml.language.metamodel.classes import bridge, jaus, system
from jausml.language.semantics.core_services import CORE
from jausml.language.semantics.hosts import host_of
from jausml.language.semantics.services import code, lineage
from jausml.language.semantics.topics import resolve_topic
from jausml.language.semantics.used_maps import used_maps
from jausml.views.analysis.groups import carriers_of, serves

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from jausml.views.analysis.groups import Carrier
    from jausml.views.analysis.partition import Part, Proposal

Value = TypeVar("Value")

_LARGEST_COMPONENT = 254
_COPIED = (
    *("namespace", "frequency", "type", "authority", "defaultAuthority", "controlTimeout"),
    *("eventTimeout", "coreServices", "fixedSources", "guardian"),
    *("amplificationLimit", "maxPeers", "maxConnections", "idleTimeout"),
    *("maxEvents", "eventRateBudget"),
)


class AddressesExhaustedError(ValueError):
    """A node has no free component id for another bridge."""


def split(proposal: Proposal, whole: system.System) -> list[bridge.Bridge]:
    """Makes a system what a proposal says; the first part of each bridge keeps its identity.

    Args:
        whole: The system, which is changed.

    Returns:
        The bridges in the order of the parts.

    Raises:
        AddressesExhaustedError: A node has no free component id.
    """
    made = []
    for _, parts in itertools.groupby(proposal.parts, key=lambda part: part.origin):
        made += _Splitter(whole, list(parts)).split()
    return made


class _Splitter:
    """Splits one bridge."""

    def __init__(self, whole: system.System, parts: Sequence[Part]) -> None:
        self._whole = whole
        self._origin = parts[0].origin
        self._parts = parts

    def split(self) -> list[bridge.Bridge]:
        made = [self._origin]
        for part in self._parts[1:]:
            made.append(self._new_bridge(part))
        if len(made) > 1:
            self._share_maps(made)
            self._share_services(made)
            self._share_quantities(made)
            self._redirect(made)
        return made

    def _new_bridge(self, part: Part) -> bridge.Bridge:
        origin, made = self._origin, bridge.Bridge()
        made.name = self._free_name()
        made.address = self._free_address()
        made.documentation = f"Carries a part of what {origin.name} carried."
        for name in _COPIED:
            # What is stated says that somebody has decided it, be it the default.
            if origin.eIsSet(name):
                setattr(made, name, getattr(origin, name))
        for allowed in origin.allowedHosts:
            _changed(made.allowedHosts).append(allowed)
        _changed(self._whole.bridges).append(made)
        self._place(made, part.host)
        for group in part.groups:
            for carrier in group.connections:
                self._move(carrier, made)
        return made

    def _place(self, made: bridge.Bridge, host: system.Host | None) -> None:
        """Lets a bridge run on a host, by a placement that is there if possible."""
        if host is None or host_of(self._whole, made) is host:
            return  # what is placed nowhere runs on the first host
        known = [each for each in self._whole.placements if each.host is host]
        placement = known[0] if known else system.Placement()
        if not known:
            placement.host = host
            _changed(self._whole.placements).append(placement)
        _changed(placement.components).append(made)

    def _move(self, carrier: Carrier, target: bridge.Bridge) -> None:
        if isinstance(carrier, bridge.Connection):
            for topic in carrier.topics:
                if str(topic.name).startswith("~"):  # which means the name of the node
                    origin = self._origin
                    topic.name = resolve_topic(topic.name, origin.namespace or "", str(origin.name))
            _changed(target.bridgeConnections).append(carrier)
        elif isinstance(carrier, bridge.RosServiceConnection):
            _changed(target.serviceConnections).append(carrier)
        else:
            _changed(target.actionConnections).append(carrier)

    def _free_name(self) -> str:
        whole = self._whole
        taken = {str(each.name).lower() for each in (*whole.components, *whole.bridges)}
        taken |= {str(each.name).lower() for each in whole.nodes}
        names = (f"{self._origin.name}_{number}" for number in itertools.count(2))
        return next(name for name in names if name.lower() not in taken)

    def _free_address(self) -> str:
        """Returns the next free component id of the node of the bridge."""
        taken = {str(each.address) for each in (*self._whole.components, *self._whole.bridges)}
        subsystem, node, component = str(self._origin.address).split(".")
        after = range(int(component) + 1, _LARGEST_COMPONENT + 1)
        for number in (*after, *range(1, int(component))):
            address = f"{subsystem}.{node}.{number}"
            if address not in taken:
                return address
        raise AddressesExhaustedError(f"node {subsystem}.{node} has no free component id")

    # ------------------------------------------------------------------ what connections need

    def _share_maps(self, made: Sequence[bridge.Bridge]) -> None:
        """Gives each map to the bridge that uses it; what several use stays where it is."""
        for each in list(self._origin.maps):
            users = [owner for owner in made if each in _maps_of(owner)]
            if len(users) == 1 and users[0] is not self._origin:
                _changed(users[0].maps).append(each)

    def _share_services(self, made: Sequence[bridge.Bridge]) -> None:
        """Gives each service to the bridge whose messages are of it; others stay.

        Core services that the model names are of each component.
        """
        for service in list(self._origin.provides):
            serving = [each for each in made if _provides(each, service)]
            if str(service.urn).startswith(CORE):
                serving = list(made)
            _hand_out(service, [each.provides for each in made], made, serving)
        for service in list(self._origin.uses):
            using = [each for each in made if _uses(each, service)]
            _hand_out(service, [each.uses for each in made], made, using)

    def _share_quantities(self, made: Sequence[bridge.Bridge]) -> None:
        """Gives each bridge the quantities of its maps."""
        for quantity in list(self._origin.quantities):
            users = [each for each in made if quantity.name in _quantities_of(each)]
            for owner in users[1:] if self._origin in users else users:
                copy = bridge.Quantity()
                copy.name, copy.value = quantity.name, quantity.value
                for feature in ("documentation", "units"):
                    if getattr(quantity, feature):
                        setattr(copy, feature, getattr(quantity, feature))
                _changed(owner.quantities).append(copy)
            if users and self._origin not in users:
                _changed(self._origin.quantities).remove(quantity)

    def _redirect(self, made: Sequence[bridge.Bridge]) -> None:
        """Lets others speak with the part that has what they speak of."""
        for owner in (*self._whole.components, *self._whole.bridges):
            for wanted in owner.connections:
                if wanted.provider is self._origin:
                    wanted.provider = _partner(made, wanted.message)
            for carrier in carriers_of(owner) if isinstance(owner, bridge.Bridge) else ():
                self._redirect_carrier(carrier, made)

    def _redirect_carrier(self, carrier: Carrier, made: Sequence[bridge.Bridge]) -> None:
        if not isinstance(carrier, bridge.Connection):
            return
        self._redirect_peers(carrier, carrier.map.message, made)
        for source in carrier.sources:
            self._redirect_peers(source, source.join.message, made)

    def _redirect_peers(
        self,
        asking: bridge.Connection | bridge.ReportSource,
        message: jaus.MessageDef,
        made: Sequence[bridge.Bridge],
    ) -> None:
        partner = _partner(made, message)
        if self._origin in asking.peers and partner is not self._origin:
            peers = [partner if each is self._origin else each for each in asking.peers]
            for each in list(asking.peers):
                _changed(asking.peers).remove(each)
            for each in peers:
                _changed(asking.peers).append(each)


def _changed(values: Sequence[Value]) -> list[Value]:
    """Returns a feature of several values as what pyecore makes of it: it may be changed."""
    return cast("list[Value]", values)


def _hand_out(
    service: jaus.Service,
    lists: Sequence[Sequence[jaus.Service]],
    made: Sequence[bridge.Bridge],
    owners: Iterable[bridge.Bridge],
) -> None:
    """Puts a service into the lists of its owners; without any it stays with the first."""
    chosen = list(owners) or [made[0]]
    for owner, known in zip(made, lists, strict=True):
        if owner in chosen and service not in known:
            _changed(known).append(service)
        elif owner not in chosen and service in known:
            _changed(known).remove(service)


def _partner(made: Sequence[bridge.Bridge], message: jaus.MessageDef) -> bridge.Bridge:
    """Returns the part that takes or sends a message; the first when none has a connection."""
    wanted = code(message)
    for owner in made:
        if any(code(each.map.message) == wanted for each in owner.bridgeConnections):
            return owner
    return made[0]


def _provides(owner: bridge.Bridge, service: jaus.Service) -> bool:
    """Tells whether a bridge serves messages of a service."""
    calls: list[Carrier] = [*owner.serviceConnections, *owner.actionConnections]
    if any(each.direction.name == "jausToRos" for each in calls):
        return True
    return any(serves(service, each) for each in owner.bridgeConnections)


def _uses(owner: bridge.Bridge, service: jaus.Service) -> bool:
    """Tells whether a bridge asks for, or sends, messages of a service of others."""
    if owner.serviceConnections or owner.actionConnections:
        return True
    wanted = {code(each.map.message) for each in owner.bridgeConnections}
    return any(
        code(message) in wanted
        for each in lineage(service)
        for message in (*each.inputs, *each.outputs)
    )


def _maps_of(owner: bridge.Bridge) -> set[bridge.AttributeMap]:
    """Returns the maps that a bridge uses, in both directions."""
    used = [each.map for each in owner.bridgeConnections]
    for each in owner.serviceConnections:
        used += [found for found in (each.request, each.response) if found is not None]
    used += [each.element for each in owner.actionConnections]
    ways = ((each, to_ros) for each in used for to_ros in (True, False))
    return {found for each, to_ros in ways for found in used_maps(each, to_ros=to_ros)}


def _quantities_of(owner: bridge.Bridge) -> set[str]:
    return {str(quantity.name) for each in _maps_of(owner) for quantity in each.quantities}
