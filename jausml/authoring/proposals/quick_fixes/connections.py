"""Quick fixes of what is wrong with connections: stops, peers, services, times."""

from __future__ import annotations

import ipaddress
import re
from collections.abc import Iterator, Mapping

from jausml.authoring.editing.commands import Add, Child, Remove, Set
from jausml.authoring.proposals.quick_fixes.found import (
    Fixer,
    Found,
    QuickFix,
    removed,
    unset,
    unset_where,
)
from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.model.names import name_of
from jausml.language.semantics.assignments.rates import fills_rates_alone
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.jaus.services import find_same, inputs, outputs
from jausml.language.semantics.paths.attributes import NUMBER, Attribute
from jausml.language.semantics.paths.jaus_paths import JausPlace
from jausml.language.semantics.paths.ros_paths import RosPlace
from jausml.language.semantics.paths.scopes import outer_scope, target_paths

_PERIODS = 3  # how many messages may be lost before a source counts as silent


def stop(finding: Found) -> Iterator[QuickFix]:
    """Adds a stop, where zeros can be one: all numbers that commands fill are rates."""
    connection = finding.element
    to_ros = is_to_ros(connection)
    map_ = connection.map
    feature = "stopRos" if to_ros else "stopJaus"
    if getattr(map_, feature) is not None or not fills_rates_alone(map_, to_ros=to_ros):
        return
    kind = "bridge.ConstantAssignment"
    zeros = [{"target": (path,), "value": ("0",)} for path in _filled(map_, to_ros=to_ros)]
    if not finding.scope.model.is_library(map_) and (to_ros or zeros):
        # Of ROS all is zero that a stop does not name.
        inner = () if to_ros else tuple(Child("values", kind, zero) for zero in zeros)
        add = Add(finding.scope.ref(map_), feature, "bridge.Stop", {}, inner)
        yield QuickFix(f"give the map a {feature} of zeros", (add,))
    elif zeros:
        adds = tuple(Add(finding.ref, "safeValue", kind, zero) for zero in zeros)
        yield QuickFix("give it a safe value of zeros", adds)


def _filled(map_: bridge.AttributeMap, *, to_ros: bool) -> Iterator[str]:
    """Yields the members that assignments fill with numbers, where 0 is legal."""
    scope = outer_scope(map_, to_ros=to_ros)
    for assignment in map_.toRos if to_ros else map_.toJaus:
        for path in (
            target_paths(assignment) if isinstance(assignment, bridge.FieldAssignment) else ()
        ):
            place = scope.find_target(path)
            if isinstance(place, JausPlace | RosPlace) and _has_zero(place.attribute()):
                yield path


def _has_zero(attribute: Attribute) -> bool:
    lower = attribute.lower if attribute.lower is not None else 0
    upper = attribute.upper if attribute.upper is not None else 0
    return attribute.kind == NUMBER and lower <= 0 <= upper


def silence(finding: Found) -> Iterator[QuickFix]:
    """Sets the silence timeout of a safe value, longer than the period of messages."""
    rate = _rate(finding.element)
    seconds = max(1.0, round(_PERIODS / rate, 3)) if rate else 1.0
    yield finding.set(f"after {seconds:g} s of silence", "silenceTimeout", f"{seconds:g}")


def _rate(connection: bridge.Connection) -> float:
    if connection.rate > 0:
        return float(connection.rate)
    owner = connection.eContainer()
    is_timed = connection.exchange.name in ("periodicEvent", "query")
    return float(owner.frequency) if is_timed and isinstance(owner, bridge.Bridge) else 0.0


def freshness(finding: Found) -> Iterator[QuickFix]:
    """Says for how long a report is fresh."""
    yield finding.set("fresh for 1 s", "freshness", "1.0")


def control(finding: Found) -> Iterator[QuickFix]:
    """Removes the control of a message that needs none."""
    if 'control="false"' in finding.hint or "control: false" in finding.hint:
        yield finding.set("send without control", "control", "false")


def service(finding: Found) -> Iterator[QuickFix]:
    """Lets the component that is named provide the service that has the message."""
    match = re.search(r"add (\w+) to what it provides", finding.hint)
    owner = next(
        (
            component
            for component in _components(finding)
            if name_of(component) in finding.quoted[:1]
        ),
        None,
    )
    message = _message(finding)
    offered = message.eContainer() if message is not None else None
    if match is None or owner is None or offered is None or offered.name != match[1]:
        return
    known = tuple(finding.scope.ref(provide) for provide in owner.provides)
    commands = (Set(finding.scope.ref(owner), "provides", (*known, finding.scope.ref(offered))),)
    yield QuickFix(f"let {name_of(owner)} provide {match[1]}", commands)


def peer(finding: Found) -> Iterator[QuickFix]:
    """Names the only component with the message, or searches for its service."""
    message, connection = _message(finding), finding.element
    if message is None or connection.peers or connection.search is not None:
        return
    to_ros = is_to_ros(connection)
    fits = [
        component
        for component in _components(finding)
        if not isinstance(component, bridge.Bridge)
        and find_same(message, outputs(component) if to_ros else inputs(component)) is not None
    ]
    if len(fits) == 1:
        name = name_of(fits[0])
        yield finding.set(f"name {name} as its peer", "peers", finding.scope.ref(fits[0]))
    elif not fits and isinstance(offered := message.eContainer(), jaus.Service):
        values = {"services": (finding.scope.ref(offered),)}
        add = Add(finding.ref, "search", "jaus.PeerSearch", values)
        yield QuickFix(f"search for {offered.name}", (add,))


def published_twice(finding: Found) -> Iterator[QuickFix]:
    """Removes the topic or the connection that repeats a publisher."""
    noun = "topic" if isinstance(finding.element, bridge.Topic) else "connection"
    yield QuickFix(f"take this {noun} away", (Remove(finding.ref),))


def success(finding: Found) -> Iterator[QuickFix]:
    """Names the one bool of a response that can tell of a failure."""
    response = finding.element.type.response if finding.element.type is not None else None
    fields = response.fields if response is not None else ()
    bools = [
        field
        for field in fields
        if getattr(getattr(field, "type", None), "name", "") == "bool"
        and field.arrayKind.name == "single"
    ]
    if len(bools) == 1:
        name = name_of(bools[0])
        yield finding.set(f"tell it in {name}", "successMember", name)


def allowed_hosts(finding: Found) -> Iterator[QuickFix]:
    """Writes the network in which an address lies."""
    hosts = list(finding.element.allowedHosts)
    for wrong in finding.quoted[:1]:
        if "not the network" in finding.message and wrong in hosts:
            network = str(ipaddress.ip_network(wrong, strict=False))
            values = [network if host == wrong else host for host in hosts]
            yield finding.set(f"write {network}", "allowedHosts", *values)


def _components(finding: Found) -> list[jaus.Component]:
    return finding.scope.model.instances(jaus.Component, library=False)


def _message(finding: Found) -> jaus.MessageDef | None:
    element = finding.element
    if isinstance(element, jaus.ServiceConnection):
        return element.message
    if isinstance(element, bridge.Connection):
        return element.map.message if element.map is not None else None
    return None


_LEFT_OUT = unset_where(lambda finding: "leave" in finding.hint or not finding.hint)

QUICK_FIXES: Mapping[str, Fixer] = {
    "JML304": service,
    "JML422": service,
    "JML423": peer,
    "JML426": silence,
    "JML427": control,
    "JML451": stop,
    "JML452": unset_where(lambda finding: "carries no command" in finding.message),
    "JML453": unset,
    "JML454": silence,
    "JML455": freshness,
    "JML456": unset_where(
        lambda finding: "is no time" in finding.message or "makes no report" in finding.message
    ),
    "JML463": unset,
    "JML464": published_twice,
    "JML467": unset_where(lambda finding: finding.hint == "leave it out"),
    "JML471": control,
    "JML473": success,
    "JML474": unset,
    "JML477": allowed_hosts,
    "JML478": unset,
    "JML490": unset,
    "JML491": _LEFT_OUT,
    "JML492": unset,
    "JML493": _LEFT_OUT,
    "JML498": removed("decided: take the open decision away"),
}
"""The quick fixes by rule."""
