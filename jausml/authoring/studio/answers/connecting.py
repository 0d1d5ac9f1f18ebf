"""Connecting: what can flow from one end of the system view to another, and how."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from jausml.authoring.proposals.options import Options
from jausml.authoring.studio.answers.crossing import bridged, carried, further_peer, through
from jausml.authoring.studio.answers.linking import asked, topics_between
from jausml.authoring.studio.answers.spots import all_spots
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.model.names import name_of
from jausml.language.semantics.ways import TO_JAUS, TO_ROS

if TYPE_CHECKING:
    from jausml.authoring.proposals.elements import Scope
    from jausml.authoring.studio.answers.spots import Spot


def connect(scope: Scope, source: Spot, target: Spot) -> Options:
    """Returns the ways to connect two ends of the system view, the best first."""
    if source.owner is target.owner:
        return Options(refusal=f"both ends are of {name_of(source.owner)}; draw to another box")
    found = _ways(scope, source, target)
    if found.options:
        first, *others = found.options
        return Options((replace(first, is_best=True), *others))
    return found


def _ways(scope: Scope, source: Spot, target: Spot) -> Options:
    match source.owner, target.owner:
        case ros.Node(), ros.Node():
            return topics_between(scope, source, target)
        case bridge.Bridge(), ros.Node():
            return through(scope, source.owner, source, target, TO_ROS)
        case ros.Node(), bridge.Bridge():
            return through(scope, target.owner, target, source, TO_JAUS)
        case jaus.Component(), ros.Node():
            return bridged(scope, source, target, TO_ROS)
        case ros.Node(), jaus.Component():
            return bridged(scope, target, source, TO_JAUS)
        case jaus.Component(), jaus.Component():
            return _among_components(scope, source, target)
    return Options(refusal="only components, bridges and nodes are connected")


def _among_components(scope: Scope, source: Spot, target: Spot) -> Options:
    if isinstance(target.element, bridge.Connection):
        return further_peer(scope, source, target, TO_ROS)
    if isinstance(source.element, bridge.Connection):
        return further_peer(scope, target, source, TO_JAUS)
    across = _through_bridge(scope, source, target)
    if across is None:
        return asked(scope, source, target)
    # Bridges are components too: what they ask for themselves comes after what they carry.
    return Options((*across.options, *asked(scope, source, target).options), across.refusal)


def _through_bridge(scope: Scope, source: Spot, target: Spot) -> Options | None:
    """Returns what a bridge as a whole may carry for a component, None for other pairs."""
    match source.owner, target.owner:
        case bridge.Bridge(), bridge.Bridge():
            return None
        case _, bridge.Bridge() if target.element is None:
            return carried(scope, target.owner, source, TO_ROS)
        case bridge.Bridge(), _ if source.element is None:
            return carried(scope, source.owner, target, TO_JAUS)
    return None


def ends(scope: Scope, start: Spot) -> list[tuple[Spot, str]]:
    """Returns the ends to which a line can be drawn from one, each with why."""
    found = []
    for other in all_spots(scope):
        answer = connect(scope, start, other)
        if answer.options:
            found.append((other, answer.options[0].why))
    return found
