"""`jausml new service-connection` and `new action-connection`: calls that a bridge carries."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from jausml.cli.authoring.new import add_to, model_option, pairs, show_open, side_option
from jausml.cli.shared.options import FiniteRange
from jausml.cli.shared.terminal import can_ask, choose_one, remark
from jausml.language.semantics.connections.limits import GREATEST_SPEED

if TYPE_CHECKING:
    from jausml.authoring.editing.commands import Command
    from jausml.authoring.projects.places import Opened
    from jausml.authoring.proposals.calls import Call, Half
    from jausml.authoring.proposals.elements import Scope
    from jausml.authoring.proposals.goals import ListWay
    from jausml.authoring.proposals.new_elements import OpenPoint
    from jausml.language.metamodel.classes import bridge as bridges
    from jausml.language.metamodel.classes import ros

_SERVICE_EXAMPLE = "drop:std_srvs/Trigger"
_ACTION_EXAMPLE = "survey:nav2_msgs/FollowWaypoints"
_VEHICLE = "vehicle"


def _bridge_option(command: Callable[..., None]) -> Callable[..., None]:
    return click.option(
        "--bridge", metavar="NAME", help="Bridge that gets the connection, if there are several."
    )(command)


_yes_option = click.option(
    "--yes", is_flag=True, help="Take the first choice where several fit, and ask nothing."
)


@click.command("service-connection")
@click.argument("word", metavar="SERVICE:TYPE")
@click.argument("message", metavar="MESSAGE")
@click.option(
    "--answer",
    metavar="MESSAGE",
    help="JAUS message that answers; by default the one that the JAUS service defines.",
)
@click.option(
    "--request",
    "requests",
    metavar="TARGET=SOURCE",
    multiple=True,
    help="Assignment of the map of the request; may be repeated.",
)
@click.option(
    "--response",
    "replies",
    metavar="TARGET=SOURCE",
    multiple=True,
    help="Assignment of the map of the response; may be repeated.",
)
@side_option
@_yes_option
@_bridge_option
@model_option
def service_connection(
    word: str,
    message: str,
    answer: str | None,
    requests: tuple[str, ...],
    replies: tuple[str, ...],
    side: str,
    yes: bool,
    bridge: str | None,
    model: Path | None,
) -> None:
    """Add a connection to a bridge that carries calls of a ROS service, asked by MESSAGE in JAUS.

    A vehicle serves the ROS service, and JAUS components ask; with --side operator, the bridge
    serves it and asks a JAUS component. Answer and rejections are those of the JAUS service of the
    message. Where fields have to be carried, a ready map is used, or one is filled as by
    `jausml new map`. It prints what is open.

    Exit status: 0 done, 2 usage or environment, 3 internal error.
    """
    from jausml.authoring.projects.adding import bridge_in
    from jausml.authoring.proposals.calls import call_of, connection_commands, halves, opens_of
    from jausml.authoring.proposals.elements import message_of, service_type_of

    name, kind = _name_and_type(word, _SERVICE_EXAMPLE)
    stated = {"request": pairs(requests, "=", "data=Lit"), "response": pairs(replies, "=", "Lit=x")}
    open_points: list[OpenPoint] = []

    def commands(at: Opened) -> Sequence[Command]:
        owner, scope = bridge_in(at, bridge or ""), at.scope
        call = call_of(
            name,
            service_type_of(scope, kind),
            message_of(scope, message),
            to_ros=side == _VEHICLE,
            answer=None if answer is None else message_of(scope, answer),
        )
        own = _free_name(owner, name)
        needed = halves(scope, call)
        _check_stated(stated, needed)
        maps = {
            half.kind: map_commands
            for half in needed
            if (map_commands := _map_of(scope, owner, half, own, stated, yes=yes)) is not None
        }
        open_points.extend(opens_of(call))
        _show_call(call)
        return connection_commands(scope, owner, call, maps, own)

    add_to(model, f"Add calls of {name}", commands, lambda: show_open(open_points))


def _check_stated(stated: dict[str, list[tuple[str, str]]], needed: Sequence[Half]) -> None:
    """Complains of assignments of a half that needs no map."""
    for kind, words in stated.items():
        if words and kind not in [half.kind for half in needed]:
            raise click.UsageError(f"--{kind}: nothing has to be carried by the {kind}")


def _map_of(
    scope: Scope,
    owner: bridges.Bridge,
    half: Half,
    name: str,
    stated: dict[str, list[tuple[str, str]]],
    *,
    yes: bool,
) -> Sequence[Command] | None:
    """Says which map a half gets, and returns the commands that make it.

    Returns None where a ready map is referred to as it is.
    """
    from jausml.authoring.proposals.calls import own_copy
    from jausml.authoring.proposals.mapping.beginning import Wish
    from jausml.authoring.proposals.new_elements import name_among
    from jausml.cli.authoring.new_map import begun_map
    from jausml.language.model.names import name_of

    words = tuple(stated[half.kind])
    if half.ready is not None and not words:
        click.echo(f"{half.kind}: map {name_of(half.ready)}")
        return own_copy(scope, owner, half.ready)
    own = name_among(f"{name}_{half.kind}", owner.maps)
    click.echo(f"{half.kind}: new map {own}")
    to_ros, to_jaus = (words, ()) if half.to_ros else ((), words)
    wish = Wish(own, half.message, half.type, to_ros, to_jaus, (half.to_ros,))
    begun = begun_map(scope, owner, wish, yes=yes)
    return [begun.add, *begun.tables]


def _show_call(call: Call) -> None:
    """Says which message asks, and which ones answer."""
    from jausml.language.model.names import name_of

    asked = name_of(call.message)
    line = f"{asked} calls it" if call.to_ros else f"a call of it is sent as {asked}"
    answers = (call.answer, *call.rejections)
    names = [name_of(message) for message in answers if message is not None]
    answered = f"; answered by {' or '.join(names)}" if names else ""
    click.echo(f"{call.service}: {line}{answered}")


@click.command("action-connection")
@click.argument("word", metavar="ACTION:TYPE")
@click.option("--driver", metavar="SERVICE", help="List driver of JAUS, if several fit.")
@click.option("--element", metavar="MAP", help="Map of an element of the list, if several fit.")
@click.option(
    "--speed",
    type=FiniteRange(0.0, GREATEST_SPEED, min_open=True),
    metavar="M/S",
    help="Speed at which JAUS components execute the lists, with --side operator.",
)
@side_option
@_yes_option
@_bridge_option
@model_option
def action_connection(
    word: str,
    driver: str | None,
    element: str | None,
    speed: float | None,
    side: str,
    yes: bool,
    bridge: str | None,
    model: Path | None,
) -> None:
    """Add a connection to a bridge that carries lists of JAUS as goals of a ROS action.

    The goal has a sequence of elements, such as poses, of which each is translated by a map.
    A vehicle serves the action, and the bridge is the list driver; with --side operator, the bridge
    serves the action and has a JAUS component execute the list.

    Exit status: 0 done, 2 usage or environment, 3 internal error.
    """
    from jausml.authoring.projects.adding import bridge_in
    from jausml.authoring.proposals.elements import action_type_of
    from jausml.authoring.proposals.goals import action_commands, opens_of, ways_for

    name, kind = _name_and_type(word, _ACTION_EXAMPLE)
    to_ros = side == _VEHICLE
    if speed is not None and to_ros:
        raise click.UsageError("--speed is for --side operator: JAUS states the speed of a vehicle")
    open_points: list[OpenPoint] = []

    def commands(at: Opened) -> Sequence[Command]:
        owner, scope = bridge_in(at, bridge or ""), at.scope
        used = action_type_of(scope, kind)
        own = _free_name(owner, name)
        candidates = _meant(ways_for(scope, used, to_ros=to_ros), driver, element)
        way = _chosen_way(candidates, used, name, to_ros=to_ros, yes=yes)
        open_points.extend(opens_of(used, way, own, to_ros=to_ros, speed=speed))
        click.echo(f"{name}: {'JAUS -> ROS' if to_ros else 'ROS -> JAUS'}, {way.says()}")
        return action_commands(scope, owner, name, used, way, to_ros=to_ros, name=own, speed=speed)

    add_to(model, f"Add goals of {name}", commands, lambda: show_open(open_points))


def _meant(candidates: list[ListWay], driver: str | None, element: str | None) -> list[ListWay]:
    """Returns the ways with a driver and a map of some names; the usual ones without names."""
    from jausml.language.model.names import name_of

    if driver is None and element is None:
        return [way for way in candidates if way.is_usual] or candidates
    matches = [
        way
        for way in candidates
        if driver in (None, name_of(way.driver), way.driver.urn)
        and element in (None, name_of(way.map))
    ]
    if candidates and not matches:
        raise click.UsageError(f"no such driver and map; there are{_listed(candidates)}")
    return matches


def _listed(candidates: Sequence[ListWay]) -> str:
    """Returns the ways as further lines of a message."""
    return "".join(f"\n  {way.says()}" for way in candidates)


def _chosen_way(
    candidates: list[ListWay], kind: ros.ActionType, name: str, *, to_ros: bool, yes: bool
) -> ListWay:
    """Returns the only way, or the first with `--yes`; else asks for one of several.

    Raises:
        UsageError: There is none, none was taken, or nobody can be asked.
    """
    from jausml.authoring.proposals.goals import why_none

    if not candidates:
        raise click.UsageError(f"{name}: {why_none(kind, to_ros=to_ros)}")
    if len(candidates) == 1:
        return candidates[0]
    if yes:
        remark(
            f"{name}: of several, {candidates[0].says()} (name others by --driver and --element)"
        )
        return candidates[0]
    if not can_ask():
        text = f"{name} fits several: say --driver and --element, or take the first by --yes"
        raise click.UsageError(text + _listed(candidates))
    number = choose_one(f"{name} fits several:", [way.says() for way in candidates])
    if number is None:
        raise click.UsageError(
            f"{name}: none of them is taken; name others by --driver and --element"
        )
    return candidates[number]


def _free_name(owner: bridges.Bridge, name: str) -> str:
    """Returns a free name for the connection of a service or action.

    Raises:
        ProjectError: The bridge carries that service or action already.
    """
    from jausml.authoring.projects.errors import ProjectError
    from jausml.authoring.proposals.new_elements import name_among
    from jausml.language.model.names import name_of

    carried = {connection.service for connection in owner.serviceConnections}
    carried |= {connection.action for connection in owner.actionConnections}
    if name in carried:
        raise ProjectError(f"{name_of(owner)} carries {name} already")
    siblings = (*owner.bridgeConnections, *owner.serviceConnections, *owner.actionConnections)
    return name_among(name, siblings)


def _name_and_type(word: str, example: str) -> tuple[str, str]:
    """Returns both parts of NAME:TYPE; UsageError: they are none of ROS."""
    from jausml.authoring.proposals.elements import plain_type
    from jausml.language.semantics.connections.topics import topic_fault

    [(name, kind)] = pairs([word], ":", example)
    if "/" not in kind:
        raise click.UsageError(f"{word!r} should be like {example}")
    if fault := topic_fault(name):
        raise click.UsageError(f"{word!r}: the name {fault}")
    return name, plain_type(kind)
