"""Rules about peers that are found at run time, and about components that can be found."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.metamodel.classes import bridge, jaus
from jausml.model.diagnostics import Severity
from jausml.validation.rule import Finding, rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.metamodel.classes.ecore import EObject
    from jausml.semantics.subject import Subject

_LIMITS = {"subsystem": 65534, "node": 254}


@rule("JML354", Severity.ERROR, "either named or searched for")
def named_or_searched(subject: Subject) -> Iterator[Finding]:
    """The other end of a connection is named, or searched for by its services; not both.

    A report of another component has a `provider` or a `search`.

    Bad: a connection with `peers="vehicle"` and a `search`

    Good: the connection with one of them
    """
    for connection in subject.instances(bridge.Connection):
        if connection.search is not None and connection.peers:
            message = f"'{connection.name}' names peers and searches for peers"
            yield Finding(connection, message, "search", "leave out one of them")
    for received in subject.instances(jaus.ServiceConnection):
        if received.search is not None and received.provider is not None:
            message = f"'{received.name}' names a provider and searches for one"
            yield Finding(received, message, "search", "leave out one of them")
        elif received.search is None and received.provider is None:
            message = f"'{received.name}' names no provider and searches for none"
            yield Finding(received, message, None, "name a provider, or search for one")


@rule("JML355", Severity.ERROR, "search that can find nothing")
def search_possible(subject: Subject) -> Iterator[Finding]:
    """A search looks where components can be: subsystem 1..65534, node 1..254, 0 for any.

    One within the own subsystem or node does not ask for the number of another.

    Bad: `<search services="..." subsystem="65535"/>`

    Good: `<search services="..." subsystem="100"/>`
    """
    for search in subject.instances(jaus.PeerSearch):
        for feature, highest in _LIMITS.items():
            number = getattr(search, feature)
            if not 0 <= number <= highest:
                message = f"{feature} {number} is not in 0..{highest}"
                yield Finding(search, message, feature)
        yield from _elsewhere(search)


@rule("JML356", Severity.WARNING, "control of everybody who is found")
def control_of_all(subject: Subject) -> Iterator[Finding]:
    """A connection that takes control of its peers searches for one of them.

    With `choice="all"` each vehicle that appears within reach is controlled and moves by the same
    commands.

    Bad: the commands of a topic to `<search services="..." choice="all"/>`

    Good: the same with `choice="nearest"`, or with the subsystem of the vehicle
    """
    for connection in subject.instances(bridge.Connection):
        search = connection.search
        if search is None or search.choice.name != "all" or search.subsystem:
            continue
        commands = connection.map is not None and connection.map.message is not None
        is_sent = connection.direction.name == "rosToJaus" and connection.control
        if commands and is_sent and connection.map.message.isCommand:
            message = f"'{connection.name}' takes control of all that its search finds"
            hint = "search for one, or in one subsystem"
            yield Finding(connection, message, "search", hint)


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
