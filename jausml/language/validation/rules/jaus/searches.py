"""Rules about peers that are found at run time, and about components that can be found."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, TypeAlias

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.connections import calls
from jausml.language.semantics.jaus.commands import is_command
from jausml.language.semantics.jaus.core_services import is_discovered
from jausml.language.validation.rule import Finding, rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.semantics.subject import Subject

_LIMITS = {"subsystem": 65534, "node": 254}


@rule("JML354", Severity.ERROR, "either named or searched for")
def named_or_searched(subject: Subject) -> Iterator[Finding]:
    """The other end of a connection is either named, or searched for by its services.

    A report of another component has a `provider` or a `search`.

    Bad: a connection with `peers="vehicle"` and a `search`

    Good: the connection with one of them
    """
    needs = ("name", "search", "peers")
    found: list[bridge.Connection | bridge.RosServiceConnection] = []
    found += subject.instances(bridge.Connection, needs=needs)
    found += subject.instances(bridge.RosServiceConnection, needs=needs)
    for connection in found:
        if connection.search is not None and connection.peers:
            message = f"'{connection.name}' names peers and searches for peers"
            yield Finding(connection, message, "search", "leave out one of them")
    for received in subject.instances(jaus.ServiceConnection, needs=("name", "search", "provider")):
        if received.search is not None and received.provider is not None:
            message = f"'{received.name}' names a provider and searches for one"
            yield Finding(received, message, "search", "leave out one of them")
        elif received.search is None and received.provider is None:
            message = f"'{received.name}' names no provider and searches for none"
            yield Finding(received, message, None, "name a provider, or search for one")


@rule("JML355", Severity.ERROR, "search that can find nothing")
def search_possible(subject: Subject) -> Iterator[Finding]:
    """A search looks where components can be: subsystem 1..65534, node 1..254, 0 for any.

    A search within its own subsystem or node does not name the number of another one.

    Bad: `<search services="..." subsystem="65535"/>`

    Good: `<search services="..." subsystem="100"/>`
    """
    for search in subject.instances(jaus.PeerSearch, needs=()):
        for feature, highest in _LIMITS.items():
            number = getattr(search, feature)
            if not 0 <= number <= highest:
                message = f"{feature} {number} is not in 0..{highest}"
                yield Finding(search, message, feature)
        if subject.is_read(search):
            yield from _elsewhere(search)


@rule("JML356", Severity.WARNING, "control of everybody who is found")
def control_of_all(subject: Subject) -> Iterator[Finding]:
    """A connection that takes control of its peers searches for one of them.

    With `choice="all"` each vehicle that appears within reach is controlled and moves by the same
    commands.

    Bad: the commands of a topic, of a ROS service or of a ROS action to
    `<search services="..." choice="all"/>`

    Good: the same with `choice="nearest"`, or with the subsystem of the vehicle
    """
    for connection in subject.instances(bridge.Connection):
        command = connection.map.message if connection.map is not None else None
        if command is not None and command.isCommand and _controls_all(connection):
            yield _control_of_all(connection)
    for called in subject.instances(bridge.RosServiceConnection):
        asking = calls.asking(called)
        if asking is not None and is_command(asking) and _controls_all(called):
            yield _control_of_all(called)
    for action in subject.instances(bridge.RosActionConnection):
        if _controls_all(action):
            yield _control_of_all(action)


@rule("JML357", Severity.INFO, "subsystem that nobody finds")
def subsystem_discovered(subject: Subject) -> Iterator[Finding]:
    """Some component of a subsystem provides Discovery, as components do by default.

    Otherwise, operator control units that use Discovery do not see the subsystem, and searches of
    other components do not find it (AS5710). The rule ignores subsystems with external components,
    since one of them may answer.

    Bad: one component, with `coreServices="none"` and without Discovery

    Good: the same without `coreServices`
    """
    for group in subject.systems():
        subsystems: dict[str, list[jaus.Component]] = defaultdict(list)
        for each in group:
            if isinstance(each, jaus.Component) and each.address:
                subsystems[each.address.split(".")[0]].append(each)
        for number, components in subsystems.items():
            if not any(each.external or is_discovered(each) for each in components):
                first = components[0]
                message = f"nobody in subsystem {number} provides Discovery, so nobody finds it"
                yield Finding(first, message, "coreServices", "let one of them provide it")


@rule("JML358", Severity.WARNING, "external component that shall do something")
def external_is_idle(subject: Subject) -> Iterator[Finding]:
    """An external component has no connections and controls nobody: nothing is generated for it.

    Its address, its type and its services tell others what is there.

    Bad: `<components name="vehicle" external="true" controls="trailer"/>`

    Good: `<components name="vehicle" external="true"/>`
    """
    for component in subject.instances(jaus.Component, needs=("name", "external")):
        if not component.external:
            continue
        if isinstance(component, bridge.Bridge):
            message = f"the bridge '{component.name}' is external: it is not generated"
            yield Finding(component, message, "external")
        for feature in ("connections", "controls"):
            if getattr(component, feature):
                message = f"'{component.name}' is external: nobody carries out its {feature}"
                yield Finding(component, message, feature)


def _elsewhere(search: jaus.PeerSearch) -> Iterator[Finding]:
    """Yields a finding about a search within the own subsystem for another one."""
    owner: EObject | None = search.eContainer()
    while owner is not None and not isinstance(owner, jaus.Component):
        owner = owner.eContainer()
    if owner is None or not owner.address or search.within.name == "system":
        return
    own = dict(zip(_LIMITS, map(int, owner.address.split(".")), strict=False))
    compared = _LIMITS if search.within.name == "node" else ("subsystem",)
    for feature in compared:
        number = getattr(search, feature)
        if number not in (0, own[feature]):
            message = f"the search is within the own {search.within.name} and asks for"
            yield Finding(search, f"{message} {feature} {number}", feature)


_Connection: TypeAlias = (
    "bridge.Connection | bridge.RosServiceConnection | bridge.RosActionConnection"
)


def _controls_all(connection: _Connection) -> bool:
    search = connection.search
    if search is None or search.choice.name != "all" or search.subsystem:
        return False
    return bool(connection.direction.name == "rosToJaus" and connection.control)


def _control_of_all(connection: _Connection) -> Finding:
    message = f"'{connection.name}' takes control of all that its search finds"
    return Finding(connection, message, "search", "search for one, or in one subsystem")
