"""`jausml new partition`: which bridges a system has, and which connections each carries."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from jausml.cli.authoring.new import model_option, pairs, place_for, report, stopping
from jausml.cli.models.views import assumption_options, check_names
from jausml.cli.shared.files import EnvironmentFault, ending_at
from jausml.cli.shared.models import valid_model
from jausml.cli.shared.options import FiniteRange, format_option
from jausml.cli.shared.terminal import can_ask, remark

if TYPE_CHECKING:
    from jausml.views.analysis.sizes import Assumptions


@click.command("partition")
@click.option(
    "--most", type=click.IntRange(1), metavar="N", help="Connections of a bridge at most."
)
@click.option(
    "--load",
    type=FiniteRange(0.001, 100),
    default=50.0,
    metavar="PERCENT",
    help="Share of one processor that a bridge takes at most; 50 by default.",
)
@click.option(
    "--wait",
    type=FiniteRange(0.001, 10_000),
    metavar="MS",
    help="Longest time that a message waits in its bridge when one of each connection comes at "
    "once.",
)
@click.option(
    "--together",
    multiple=True,
    metavar="NAME,NAME,...",
    help="Connections that one bridge carries; may be repeated.",
)
@click.option(
    "--in",
    "inside",
    multiple=True,
    metavar="BRIDGE=NAME",
    help="Bridge, one of the model or a new one, that carries a connection; may be repeated.",
)
@click.option("--yes", is_flag=True, help="Write the proposal, and ask nothing.")
@click.option("--plan", "is_plan", is_flag=True, help="Show the proposal, and write nothing.")
@format_option("Format of the proposal.")
@assumption_options
@model_option
def partition(
    most: int | None,
    load: float,
    wait: float | None,
    together: Sequence[str],
    inside: Sequence[str],
    yes: bool,
    is_plan: bool,
    output_format: str,
    assumptions: Assumptions,
    model: Path | None,
) -> None:
    """Propose which bridge carries which connections, and write it.

    Of the partitions that hold the limits, proposes the one that costs least: processes, datagrams,
    and bytes between hosts. Connections stay together that share a join, a published topic, a
    service or a controlled component. Shows the bridges before and after, by the figures of
    `jausml report`, and asks whether to write them. Maps, services and placements go along;
    authority and stops stay as they are, and bridges in which these differ are not mixed. NAME is
    that of a connection, or BRIDGE.NAME.

    Exit status: 0 done, 1 errors in the model, 2 usage, environment or limits that cannot be held,
    3 internal error.
    """
    from jausml.authoring.projects.adding import add, check_name
    from jausml.authoring.projects.places import opened
    from jausml.authoring.proposals.partition import commands_of
    from jausml.views.analysis.formats import plan as formats
    from jausml.views.analysis.partition.plans import Planner
    from jausml.views.analysis.partition.weighing import Limits

    if yes and is_plan:
        raise click.UsageError("--yes and --plan exclude each other")
    named = [(connection, owner) for owner, connection in pairs(inside, "=", "arm=joint_states")]
    limits = Limits(
        most or 0,
        load / 100,
        math.inf if wait is None else wait / 1000,
        tuple(tuple(word.strip() for word in words.split(",")) for words in together),
        tuple(named),
    )
    with stopping():
        place = place_for(model)
        if not place.path.exists():
            raise EnvironmentFault(f"{place.path} does not exist, so it has no bridge")
        # Nobody knows what the connections of a model with errors cost.
        valid_model(str(place.path), outcome="nothing written")
        at = opened(place)
        check_names(assumptions, at.system)
        known = [str(owner.name) for owner in at.system.bridges if not owner.external]
        for _, owner in limits.inside:
            if owner not in known:
                check_name(owner, at.system)
        with ending_at(LookupError, kind=click.UsageError):
            plan = Planner(at.system, assumptions).propose(limits)
        if output_format == "json":
            click.echo(json.dumps(formats.plain(plan), indent=2))
        else:
            click.echo(formats.render(plan), nl=False)
        if plan.excess:
            raise EnvironmentFault("the limits cannot be held; nothing was written")
        if not plan.is_change or is_plan:
            return
        if not yes and not (can_ask() and click.confirm("Write this?", default=False, err=True)):
            remark("nothing was written; --yes writes it")
            return
        commands = commands_of(at.scope, plan)
        report(place, add(place, "Partition the bridges", lambda _: commands))
