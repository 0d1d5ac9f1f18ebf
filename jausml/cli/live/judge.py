"""`jausml judge`: lets a running component of any make take the tasks of a competition."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from jausml.cli.live.network import (
    ended_by_signals,
    identified_network,
    network_from,
    network_options,
    reaching,
    target_of,
    waiting_options,
)
from jausml.cli.shared.files import PROBLEMS, write_report
from jausml.cli.shared.models import open_catalogue
from jausml.cli.shared.options import COMPETITIONS, FiniteRange, format_option

if TYPE_CHECKING:
    from collections.abc import Callable

    from jausml.live.peers.judging.competition import Score

_REMEDY = (
    "Use another port and say where the component is: --port 3795 --peer ID=HOST:3794; its own "
    "model says where the judge is"
)
_IDS = 3


def _waypoints(
    _context: click.Context, _option: click.Parameter, words: tuple[str, ...]
) -> tuple[tuple[float, float], ...]:
    from math import isfinite

    found = []
    for each in words:
        try:
            x, y = (float(part) for part in each.split(","))
        except ValueError:
            raise click.BadParameter(f"{each!a} is not X,Y in metres, e.g. 2,-1.5") from None
        if not (isfinite(x) and isfinite(y) and max(abs(x), abs(y)) <= 1000):
            raise click.BadParameter(f"{each!a} is more than 1000 m away")
        found.append((x, y))
    return tuple(found)


@click.command("judge")
@click.argument("target", metavar="TARGET_ID")
@click.option(
    "--competition",
    type=click.Choice(COMPETITIONS),
    default=COMPETITIONS[0],
    show_default=True,
    help="Whose tasks are taken.",
)
@click.option(
    "--only",
    multiple=True,
    metavar="TASK",
    help="Judge only this task, or this part of one; may be repeated.",
)
@format_option("Format of what is printed.")
@click.option("-o", "--output", metavar="FILE", help="Also write the score sheet as HTML.")
@click.option(
    "--waypoint",
    "waypoints",
    multiple=True,
    callback=_waypoints,
    metavar="X,Y",
    help="A waypoint in metres, x forward and y right in the local frame of the target; may be "
    "repeated. By default, a square of two metres.",
)
@click.option(
    "--drive-time",
    type=FiniteRange(1, 3600),
    default=60.0,
    show_default=True,
    help="Seconds in which the next waypoint must be reached.",
)
@waiting_options
@network_options
def command(
    target: str,
    competition: str,
    only: tuple[str, ...],
    output_format: str,
    output: str | None,
    waypoints: tuple[tuple[float, float], ...],
    drive_time: float,
    timeout: float,
    quiet_time: float,
    own_id: str | None,
    interface: str,
    port: int,
    multicast_group: str,
    peers: tuple[str, ...],
    models: tuple[str, ...],
) -> None:
    """Let a running component, TARGET_ID, of any vendor take the tasks of a competition.

    Sends what the judges of the competition send, in their order, and gives points as the rules
    say. WITH igvc-jaus AND igvc-iop THE VEHICLE DRIVES along the waypoints, and is shut down at the
    end; Ctrl-C releases control, which must stop it. Without --id, these judges have the id 42.1.1
    of the published rules. The tool uses three ids: its own and the two after it.

    Exit status: 0 full marks, 1 points were lost, 2 the component cannot be reached or an option is
    wrong, 3 internal error.
    """
    from jausml.live.peers.judging import competitions, pages, sheets
    from jausml.live.peers.judging.driving import Course

    _check_names(only, competition)
    course = Course(waypoints or Course().waypoints, drive_time)
    rules = competitions.competition(competition, course)
    network = network_from(
        own_id or competitions.ID.get(competition), interface, port, multicast_group, peers
    )
    live = output_format == "text"
    with (
        reaching(network, _REMEDY),
        ended_by_signals(),
        identified_network(network, _IDS) as ours,
    ):
        address = target_of(target, ours)
        if live:
            click.echo(f"{rules.title}: {address}\n{rules.source}")
            click.echo("Ctrl-C ends it, and releases control")
        sheet = competitions.judged(
            ours,
            address,
            open_catalogue(models),
            rules,
            only=only,
            on_score=_shown() if live else lambda _: None,
            timeout=timeout,
            quiet=quiet_time,
        )
    if live:
        click.echo("\n".join(sheets.ending(sheet)))
    else:
        click.echo(sheets.render_json(sheet), nl=False)
    if output is not None:
        write_report(pages.render_html(sheet), output)
    if not sheet.is_full:
        raise click.exceptions.Exit(PROBLEMS)


def _check_names(only: tuple[str, ...], competition: str) -> None:
    """Refuses names that no task and no part has."""
    from jausml.live.messages.errors import did_you_mean, similar
    from jausml.live.peers.judging.competitions import task_names

    known = task_names(competition)
    for each in only:
        if each not in known and not each.startswith("codecs."):
            hint = did_you_mean(similar(each, known)) or f"; it has {', '.join(sorted(known))}"
            raise click.BadParameter(
                f"no task {each!a} in {competition}{hint}", param_hint="--only"
            )


def _shown() -> Callable[[Score], None]:
    """Returns what prints each score as it comes, under the title of its task."""
    from jausml.live.peers.judging.sheets import score_lines, task_lines

    latest = ""

    def show(score: Score) -> None:
        nonlocal latest
        lines = [*score_lines(score)]
        if score.task.name != latest:
            latest = score.task.name
            lines = ["", *task_lines(score.task), *lines]
        click.echo("\n".join(lines))

    return show
