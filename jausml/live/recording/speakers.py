"""Bridges that speak to JAUS alone, made of those of a model: what recordings go through."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.generation.system import system_of
from jausml.language.semantics.topics import endpoints, resolve_topic
from jausml.language.semantics.ways import MESSAGE, TO_JAUS
from jausml.live.recording.definitions import full_name
from jausml_generators.bridge.views import bridge_views
from jausml_generators.common.components import own_bridges

if TYPE_CHECKING:
    from jausml.language.metamodel.classes import bridge
    from jausml.language.model import Model


@dataclass(frozen=True)
class Speakers:
    """Bridges that have connections to JAUS alone."""

    model: Model
    bridges: tuple[tuple[str, str, str], ...]
    topics: dict[str, str]
    commands: tuple[str, ...]


def speakers_of(model: Model, *, allow_commands: bool) -> Speakers:
    """Returns the bridges of a model as far as they speak.

    Args:
        model: A model without errors, of which nobody makes anything else: its bridges are changed.

    Raises:
        NoSystemError: It has no system, or several.
    """
    whole = system_of(model)
    commands: list[str] = []
    for owner in own_bridges(whole):
        commands += _quieted(owner, allow_commands=allow_commands)
    editable: Any = whole
    for owner in own_bridges(whole):
        if not owner.bridgeConnections:
            editable.bridges.remove(owner)
    views = bridge_views(model)
    ends = endpoints([each.bridge for each in views])
    return Speakers(
        model,
        tuple((each.package, each.class_name, _node(each.bridge)) for each in views),
        {end.topic: full_name(end.type) for end in ends},
        tuple(commands),
    )


def _quieted(owner: bridge.Bridge, *, allow_commands: bool) -> list[str]:
    """Leaves a bridge what speaks to JAUS; returns what does so unasked."""
    editable: Any = owner  # its collections are those of pyecore
    editable.serviceConnections.clear()
    editable.actionConnections.clear()
    commands = []
    for each in list(owner.bridgeConnections):
        is_spoken = each.direction.name == TO_JAUS
        is_command = is_spoken and each.exchange.name == MESSAGE
        if is_command:
            commands.append(f"{owner.name}.{each.name} ({each.map.message.name})")
        if not is_spoken or (is_command and not allow_commands):
            editable.bridgeConnections.remove(each)
    return commands


def _node(owner: bridge.Bridge) -> str:
    return resolve_topic(str(owner.name), owner.namespace or "", "")
