"""The last lines of verbs that make bridges of topics: what was made, and what is open."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from jausml.cli.authoring.topics import joined
from jausml.cli.shared.terminal import remark

if TYPE_CHECKING:
    from jausml.authoring.proposals.topics import Crossing, TopicEnd
    from jausml.language.metamodel.classes import bridge


def show_chosen(chosen: Sequence[Crossing], topics: Sequence[TopicEnd]) -> None:
    """Shows the connection of each topic, and which facts of the vehicle a map has assumed."""
    from jausml.language.model.names import name_of

    for crossing, joins in zip(chosen, joined(chosen, topics), strict=True):
        click.echo(_crossing_line(crossing))
        for join, topic in joins.items():
            used = name_of(crossing.map)
            click.echo(f"{topic}: ROS -> JAUS, {used}: read as {join} with {crossing.topic.name}")
    for quantity, used in _assumed(chosen):
        unit = f" {quantity.units}" if quantity.units else ""
        said = f"{name_of(quantity)} of {used} is {quantity.value:g}{unit}"
        click.echo(f"{said} unless a quantity of the bridge states that of the vehicle")


def show_undecided(chosen: Sequence[Crossing]) -> None:
    """Shows last the decisions that a person has to make before anything is generated."""
    names = [crossing for crossing in chosen if crossing.has_no_stop and not crossing.hold_reason]
    if not names:
        return
    from jausml.authoring.proposals.mapping.opens import STOPS, stops_by_zeros
    from jausml.language.model.names import name_of
    from jausml.language.semantics.jaus.commands import is_emergency

    click.echo("\nYou have to decide what happens when the source of a command is lost:", err=True)
    for name in names:
        message = name_of(name.offer.message)
        stands = f"nothing stops what {message} sets in motion"
        if is_emergency(name.offer.message):
            stands = f"nobody says what releases the emergency stop ({message}); JML500 asks for it"
        click.echo(f"  {name.topic.name}: {stands}", err=True)
        if stops_by_zeros(name.map, [name.offer.to_ros]):
            stop, used = STOPS[name.offer.to_ros], name_of(name.map)
            advice = (
                f"its numbers are all rates: if zeros stop it, give map {used} a {stop} of zeros"
            )
            click.echo(f"    {advice}", err=True)
    click.echo(
        "  validate reports JML451 until each has a stop (a safeValue, or one in its map), or a\n"
        "  reason why the last command may stand (onSilence: hold and holdReason, or --hold).\n"
        "  No tool knows what is safe for what receives them.",
        err=True,
    )


def show_unanswered(chosen: Sequence[Crossing]) -> None:
    """Shows the queries of the services of a new bridge that have no answer."""
    from jausml.authoring.proposals.topics import unanswered_queries

    for service, queries in unanswered_queries(chosen).items():
        remark(f"{service}: no connection answers {', '.join(queries)}")


def _assumed(chosen: Sequence[Crossing]) -> list[tuple[bridge.Quantity, str]]:
    """Returns the numbers of a vehicle that maps assume, each with the name of a map."""
    from jausml.language.model.names import name_of

    quantities_by_name: dict[str, tuple[bridge.Quantity, str]] = {}
    for crossing in chosen:
        for quantity in crossing.map.quantities:
            quantities_by_name.setdefault(name_of(quantity), (quantity, name_of(crossing.map)))
    return list(quantities_by_name.values())


def _crossing_line(crossing: Crossing) -> str:
    from jausml.language.semantics.jaus.commands import is_emergency

    arrow = "JAUS -> ROS" if crossing.offer.to_ros else "ROS -> JAUS"
    reason = crossing.hold_reason
    stands = "the last command stands when its source is lost"
    if is_emergency(crossing.offer.message):
        stands = "what releases it"
    held = f"; {stands}: {reason}" if reason else ""
    own = f"; joints {', '.join(crossing.names)}" if crossing.names else ""
    own += "".join(f"; the frame {old} is {new}" for old, new in crossing.frames.items())
    return f"{crossing.topic.name}: {arrow}, {crossing.says()}{own}{held}"
