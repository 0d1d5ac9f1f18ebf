"""`jausml new map`: a map between a JAUS message and a ROS type."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from jausml.cli.authoring.new import add_to, model_option, pairs, show_open
from jausml.cli.shared.options import refuse_options
from jausml.cli.shared.terminal import can_ask, choose_one, remark

if TYPE_CHECKING:
    from jausml.authoring.editing.commands import Command
    from jausml.authoring.projects.places import Opened
    from jausml.authoring.proposals.elements import Scope
    from jausml.authoring.proposals.mapping.beginning import Begun, Doubt, Wish
    from jausml.language.metamodel.classes import bridge

_EXAMPLE = "twist.linear.x=Velocity_X"
_WAYS = {"both": (True, False), "to-ros": (True,), "to-jaus": (False,)}
_OPTIONS = {True: "to_ros", False: "to_jaus"}  # the options with the assignments of each direction


@click.command("map")
@click.argument("name", metavar="NAME")
@click.argument("message", metavar="MESSAGE")
@click.argument("kind", metavar="TYPE")
@click.option(
    "--to-ros",
    metavar="TARGET=SOURCE",
    multiple=True,
    help="Assignment to a member of the ROS type from a field of the message; may be repeated.",
)
@click.option(
    "--to-jaus",
    metavar="TARGET=SOURCE",
    multiple=True,
    help="Assignment to a field of the message from a member of the ROS type; may be repeated.",
)
@click.option(
    "--direction", type=click.Choice(list(_WAYS)), default="both", help="Directions to fill."
)
@click.option("--copy", "ready", metavar="MAP", help="Copy this ready map.")
@click.option("--fill", "fills", is_flag=True, help="Fill a new map even if a ready map exists.")
@click.option(
    "--yes", is_flag=True, help="Take the first choice where several fit, and ask nothing."
)
@click.option(
    "--zeros-stop",
    is_flag=True,
    help="Your decision that zeros stop what the command moves when its source is lost. Only where "
    "all of its numbers are rates; --yes does not include it.",
)
@click.option(
    "--joints",
    metavar="NAME,...",
    help="Names of the joints that the copy of a ready map has, in the order that JAUS has.",
)
@click.option("--bridge", metavar="NAME", help="Bridge that gets the map, if there are several.")
@model_option
def map_(
    name: str,
    message: str,
    kind: str,
    to_ros: tuple[str, ...],
    to_jaus: tuple[str, ...],
    direction: str,
    ready: str | None,
    fills: bool,
    yes: bool,
    zeros_stop: bool,
    joints: str | None,
    bridge: str | None,
    model: Path | None,
) -> None:
    """Add a map named NAME to a bridge, between MESSAGE and TYPE.

    It assigns what corresponds by name, time, unit and axis, with the conversions that the rules
    require, and ignores the rest on purpose. It prints what is open. Decisions stay in the map, and
    validate reports them, until you remove them. If several things fit, it asks. If a ready map
    has the same message and type, it offers a copy.

    A SOURCE is a member, with conversions behind a colon (Velocity_Y : negate), a constant
    ("odom" in quotes, or a number), clock, or ignore.

    What stops a command when its source is lost is yours to decide: write stopRos or stopJaus into
    the map, or say --zeros-stop. Until then the map has no stop, and validate reports JML451.

    Exit status: 0 done, 2 usage or environment, 3 internal error.
    """
    from jausml.authoring.projects.adding import bridge_in, check_map_name
    from jausml.authoring.proposals.elements import message_of, type_of
    from jausml.authoring.proposals.mapping.beginning import Wish

    of_new = ("fills", "to_ros", "to_jaus", "zeros_stop")
    if joints is not None:
        refuse_options("not with --joints, which are of a copy", *of_new)
    if ready is not None:
        refuse_options("not with --copy, which takes a map as it is", *of_new)
    unwanted = [_OPTIONS[way] for way in (True, False) if way not in _WAYS[direction]]
    refuse_options(f"not with --direction {direction}", *unwanted)
    ros, jaus = (tuple(pairs(option, "=", _EXAMPLE)) for option in (to_ros, to_jaus))

    def commands(at: Opened) -> Sequence[Command]:
        owner = bridge_in(at, bridge or "")
        check_map_name(name, owner)
        ends = message_of(at.scope, message), type_of(at.scope, kind)
        wish = Wish(name, *ends, ros, jaus, _WAYS[direction], zeros_stop=zeros_stop)
        if not (fills or ros or jaus or zeros_stop):
            copy = _copy(at.scope, owner, wish, ready, joints, yes=yes)
            if copy:
                return copy
        begun = begun_map(at.scope, owner, wish, yes=yes)
        return [begun.add, *begun.tables]

    add_to(model, f"Add map {name}", commands)


def _copy(
    scope: Scope,
    owner: bridge.Bridge,
    wish: Wish,
    wanted: str | None,
    joints: str | None,
    *,
    yes: bool,
) -> Sequence[Command]:
    """Returns the commands that copy a ready map; none where none is wanted or there is none."""
    from jausml.authoring.proposals.bridging import between, copied
    from jausml.authoring.proposals.named_elements import are_examples, copied_with_names, names_in
    from jausml.cli.authoring.topics import joints_of
    from jausml.language.model.names import name_of
    from jausml.language.semantics.assignments.named_places import named_places

    ready_maps = between(scope, wish.message, wish.type)
    names = [name_of(attribute_map) for attribute_map in ready_maps]
    if wanted is not None and wanted not in names:
        raise click.UsageError(
            f"no ready map {wanted!r} of the two; there are: {', '.join(names) or 'none'}"
        )
    if not ready_maps:
        if joints is not None:
            raise click.UsageError("--joints: no ready map of the two knows joints by names")
        return ()
    if wanted is not None:
        at: int | None = names.index(wanted)
    else:
        at = 0 if yes else _chosen_ready(names)
    if at is None:
        return ()
    map_ = ready_maps[at]
    _check_ways(map_, wish)
    place = scope.ref(owner)
    if joints is not None:
        own = joints_of(joints)
        if not names_in(map_):
            raise click.UsageError(f"--joints: {name_of(map_)} knows no joints by names")
        places = named_places(map_)
        if places is not None and len(own) != len(places.names):
            wanted = ", ".join(places.names)
            raise click.UsageError(f"--joints: {name_of(map_)} has one for each of {wanted}")
        click.echo(f"a copy of the ready map {name_of(map_)} for {', '.join(own)}")
        return copied_with_names(scope, place, map_, wish.name, own, {}, first=0)
    if are_examples(map_):
        raise click.UsageError(
            f"{name_of(map_)} knows joints by their names: state those of the robot by "
            "--joints NAME,NAME"
        )
    click.echo(f"a copy of the ready map {name_of(map_)}, with its vectors")
    remark(f"a connection can use it as it is, too: jausml new bridge NAME TOPIC:TYPE:{names[at]}")
    return copied(scope, place, map_, wish.name)


def _check_ways(map_: bridge.AttributeMap, wish: Wish) -> None:
    """Refuses a copy that would have a direction that is not wanted."""
    from jausml.language.model.names import name_of

    for way, (end, assignments) in {
        True: ("ROS", map_.toRos),
        False: ("JAUS", map_.toJaus),
    }.items():
        if assignments and way not in wish.ways:
            raise click.UsageError(
                f"--direction: {name_of(map_)} has assignments to {end}, and a copy is whole; "
                "--fill fills a map without them"
            )


def _chosen_ready(names: Sequence[str]) -> int | None:
    if not can_ask():
        raise click.UsageError(
            f"ready maps have both ends: {', '.join(names)}; `jausml show map {names[0]}` shows"
            f" one. --copy {names[0]} copies it, --fill fills a new one"
        )
    return choose_one("Ready maps have both ends. Copy one?", names)


def begun_map(scope: Scope, owner: bridge.Bridge, wish: Wish, *, yes: bool) -> Begun:
    """Returns the map that is wanted; asks where more than one thing fits."""
    from jausml.authoring.proposals.mapping.beginning import begin_map

    begun = begin_map(scope, owner, wish)
    asked: set[Doubt] = set()
    while yes or can_ask():
        doubts = [doubt for doubt in begun.doubts if doubt not in asked]
        if not doubts:
            break
        for doubt in doubts:
            wish = wish.with_first(doubt) if yes else _answered(wish, doubt)
        asked |= {*doubts}
        begun = begin_map(scope, owner, wish)
    if wish.zeros_stop and not begun.stops_by_zeros:
        raise click.UsageError(
            "--zeros-stop: zeros stop only a command that moves something and of which all numbers "
            "are rates, such as velocities; write the stop of others yourself"
        )
    if begun.stops_by_zeros and not (yes or wish.zeros_stop) and can_ask() and _zeros_stop():
        begun = begin_map(scope, owner, replace(wish, zeros_stop=True))
    _show_begun(begun)
    return begun


def _zeros_stop() -> bool:
    """Asks whether zeros stop the vehicle, which no tool knows; only a yes counts."""
    click.echo("All numbers of this command are rates, such as velocities.", err=True)
    question = "Do zeros stop what it moves, when its source is lost?"
    return click.confirm(question, default=False, err=True)


def _answered(wish: Wish, doubt: Doubt) -> Wish:
    """Returns a wish with a person's answer to a doubt, which may be none."""
    from jausml.authoring.proposals.mapping.beginning import shown

    chosen = choose_one(f"What fills {doubt.target}?", [shown(choice) for choice in doubt.choices])
    return wish if chosen is None else wish.with_answer(doubt, doubt.choices[chosen])


def _show_begun(begun: Begun) -> None:
    for table in (addition for addition in begun.tables if addition.kind == "bridge.ValueTable"):
        entries = (
            f"{child.values['jaus'][0]} <-> {child.values['ros'][0]}" for child in table.children
        )
        click.echo(f"table {table.values['name'][0]} ( {'  '.join(entries)} )")
    for to_ros, statements in begun.statements.items():
        click.echo("JAUS->ROS" if to_ros else "ROS->JAUS")
        for statement in statements:
            click.echo(f"  {statement}")
    if not begun.statements:
        click.echo("nothing corresponds by name, time, or unit and axis")
    show_open(begun.opens, begun.findings)
