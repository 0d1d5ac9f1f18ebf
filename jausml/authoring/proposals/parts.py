"""Parts of a system as commands: components and nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import Add, Child
from jausml.authoring.proposals.finding import service_of, type_of
from jausml.authoring.proposals.fresh import free_name, stated_or_free_address

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.authoring.proposals.elements import Scope
    from jausml.language.metamodel.classes import system


def new_component(
    scope: Scope,
    whole: system.System,
    name: str,
    *,
    provides: Iterable[str] = (),
    uses: Iterable[str] = (),
    address: str = "",
) -> Add:
    """Returns what makes a component."""
    values: dict[str, tuple[str, ...]] = {
        "name": (name,),
        "address": (stated_or_free_address(scope.model, address),),
    }
    for feature, words in (("provides", provides), ("uses", uses)):
        services = [service_of(scope, each) for each in words]
        if services:
            values[feature] = tuple(dict.fromkeys(map(scope.ref, services)))
    return Add(scope.ref(whole), "components", "jaus.Component", values)


def new_node(
    scope: Scope,
    whole: system.System,
    name: str,
    *,
    publishes: Iterable[tuple[str, str]] = (),
    subscribes: Iterable[tuple[str, str]] = (),
) -> Add:
    """Returns what makes a node of ROS."""
    ends: list[Child] = []
    for feature, kind, topics in (
        ("publishers", "ros.Publisher", publishes),
        ("subscriptions", "ros.Subscription", subscribes),
    ):
        names: list[str] = []
        for topic, word in topics:
            names.append(free_name(topic, names))
            type_ = scope.ref(type_of(scope, word))
            values = {"name": (names[-1],), "topic": (topic,), "type": (type_,)}
            ends.append(Child(feature, kind, values))
    return Add(scope.ref(whole), "nodes", "ros.Node", {"name": (name,)}, tuple(ends))
