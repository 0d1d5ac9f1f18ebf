"""`jausml conformance`, `judge` and `peer`: test a running component, and have one to try with."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

import click

from jausml.cli.live.network import (
    ended_by_signals,
    identified_network,
    network_from,
    network_options,
    parsed_address,
    reaching,
    target_of,
    until_interrupted,
    waiting_options,
)
from jausml.cli.shared.files import PROBLEMS, write_report
from jausml.cli.shared.models import open_catalogue
from jausml.cli.shared.options import (
    COMPETITIONS,
    CONFORMANCE_FORMATS,
    MAKES,
    FiniteRange,
    format_option,
    multicast_group_option,
    port_option,
)
from jausml.cli.shared.terminal import ResultT

if TYPE_CHECKING:
    from jausml.live.messages import MessageEntry
    from jausml.live.peers.conformance.check import ConformanceReport
    from jausml.live.peers.conformance.run import CheckFilter, CheckGroup
    from jausml.live.peers.conformance.session import Session
    from jausml.runtime.base.address import JausAddress

_REMEDY = (
    "Use another port and say where the target is, which also holds for one behind a node manager: "
    "--port 3795 --peer ID=HOST:3794"
)

CLIENTS = 3
"""Ids that the tests use."""


def _checks(
    _context: click.Context, _option: click.Parameter, names: tuple[str, ...]
) -> tuple[str, ...]:
    """Refuses names that no group and no check has."""
    from jausml.live.messages.errors import did_you_mean, similar
    from jausml.live.peers.conformance.run import known_names, unknown

    for name in unknown(names):
        hint = did_you_mean(similar(name, known_names())) or "; --list names the checks"
        raise click.BadParameter(f"no check {name!r}{hint}")
    return names


@click.command("conformance")
@click.argument("target", metavar="TARGET_ID", required=False)
@format_option("Format of the report.", CONFORMANCE_FORMATS)
@click.option("--output", metavar="FILE", help="Write the report to a file instead of stdout.")
@click.option(
    "--only",
    multiple=True,
    callback=_checks,
    metavar="NAME",
    help="Run only this check or group of checks; may be repeated.",
)
@click.option(
    "--skip",
    multiple=True,
    callback=_checks,
    metavar="NAME",
    help="Skip this check or group of checks; may be repeated.",
)
@click.option("--list", "list_checks", is_flag=True, help="List the checks and exit.")
@click.option("--slow", is_flag=True, help="Also wait for timeouts that take minutes.")
@click.option("--destructive", is_flag=True, help="Also shut the target down at the end.")
@waiting_options
@network_options
def command(
    target: str | None,
    output_format: str,
    output: str | None,
    only: tuple[str, ...],
    skip: tuple[str, ...],
    list_checks: bool,
    slow: bool,
    destructive: bool,
    timeout: float,
    quiet_time: float,
    models: tuple[str, ...],
    **options: Any,
) -> None:
    """Check the conformance of the running component TARGET_ID, from any vendor, over the wire.

    Tests its transport, its core services by the state tables of AS5710, and the messages of every
    service that it announces. Sends no command that moves anything. Control and emergencies that
    the checks cause are undone, also after Ctrl-C. The tool uses three ids: its own and the two
    after it. Checks that a fragile target may not survive come last; when the target is started
    again, testing continues.

    Exit status: 0 no check failed, 1 checks failed or there were none, 2 the target cannot be
    reached or an option is wrong, 3 internal error.
    """
    from jausml.live.peers.conformance.run import CheckFilter, opened
    from jausml.live.peers.conformance.session import Limits

    selection = CheckFilter(frozenset(only), frozenset(skip))
    if list_checks:
        _list_checks(selection)
        return
    if target is None:
        raise click.UsageError("Missing argument 'TARGET_ID', e.g. 100.1.1.")
    network = network_from(**options)
    limits = Limits(slow=slow, destructive=destructive)
    with (
        reaching(network, _REMEDY),
        ended_by_signals(),
        identified_network(network, CLIENTS) as ours,
        opened(
            ours,
            target_of(target, ours),
            open_catalogue(models),
            limits=limits,
            timeout=timeout,
            quiet=quiet_time,
        ) as session,
    ):
        live = output is None and output_format == "text"
        report = _checked(session, selection.groups(), live=live)
    _write(report, output_format, output, live=live)
    if not report.passed:
        raise click.exceptions.Exit(PROBLEMS)


def _checked(session: Session, groups: Sequence[CheckGroup], *, live: bool) -> ConformanceReport:
    """Runs the checks and, on a terminal, shows each result as it comes."""
    from jausml.live.peers.conformance.formats import heading, result_lines
    from jausml.live.peers.conformance.run import begun, run

    if not live:
        return run(session, groups, lambda _: None)
    click.echo("\n".join(heading(begun(session))))
    return run(session, groups, _shown(lambda result: [result.check.group], result_lines))


def _shown(
    title: Callable[[ResultT], Iterable[str]], lines: Callable[[ResultT], Iterable[str]]
) -> Callable[[ResultT], None]:
    """Returns the function that prints each result as it comes, those of one title under it."""
    latest: list[str] = []

    def show(result: ResultT) -> None:
        nonlocal latest
        before, latest = latest, [*title(result)]
        above = ["", *latest] if latest != before else []
        click.echo("\n".join([*above, *lines(result)]))

    return show


def _write(
    report: ConformanceReport, output_format: str, output: str | None, *, live: bool
) -> None:
    from jausml.live.peers.conformance.formats import RENDERERS, summary

    if live:
        click.echo(f"\n{summary(report)}")
        return
    write_report(RENDERERS[output_format](report), output)
    if output is not None:
        click.echo(summary(report), err=True)


def _list_checks(selection: CheckFilter) -> None:
    from jausml.live.peers.conformance.run import fixed_checks

    for check in fixed_checks():
        if not selection.takes(check.id):
            continue
        mark = " (only with --destructive)" if check.destructive else ""
        mark = " (late: a target may not survive it)" if check.risky else mark
        click.echo(f"{check.id:44} {check.title}{mark}")
    if selection.takes("codecs"):
        click.echo(f"{'codecs.SERVICE.QUERY':44} One for each query of the announced services")


_REMEDY_OF_JUDGE = (
    "Use another port and say where the component is: --port 3795 --peer ID=HOST:3794; its own "
    "model says where the judge is"
)


def _waypoints(
    _context: click.Context, _option: click.Parameter, words: tuple[str, ...]
) -> tuple[tuple[float, float], ...]:
    from math import isfinite

    points = []
    for word in words:
        try:
            x, y = (float(part) for part in word.split(","))
        except ValueError:
            raise click.BadParameter(f"{word!r} is not X,Y in metres, e.g. 2,-1.5") from None
        if not (isfinite(x) and isfinite(y) and max(abs(x), abs(y)) <= 1000):
            raise click.BadParameter(f"{word!r} is more than 1000 m away")
        points.append((x, y))
    return tuple(points)


@click.command("judge")
@click.argument("target", metavar="TARGET_ID")
@click.option(
    "--competition",
    type=click.Choice(COMPETITIONS),
    default=COMPETITIONS[0],
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
    help="Seconds in which the next waypoint must be reached.",
)
@waiting_options
@network_options
def judge(
    target: str,
    competition: str,
    only: tuple[str, ...],
    output_format: str,
    output: str | None,
    waypoints: tuple[tuple[float, float], ...],
    drive_time: float,
    timeout: float,
    quiet_time: float,
    models: tuple[str, ...],
    **options: Any,
) -> None:
    """Let a running component, TARGET_ID, of any vendor take the tasks of a competition.

    Sends what the judges of the competition send, in their order, and gives points as the rules
    say. WITH igvc-jaus AND igvc-iop THE VEHICLE DRIVES along the waypoints, and is shut down at the
    end; Ctrl-C releases control, which must stop it. Without --id, these judges have the id 42.1.1
    of the published rules. The tool uses three ids: its own and the two after it.

    Exit status: 0 full marks, 1 points were lost, 2 the component cannot be reached or an option is
    wrong, 3 internal error.
    """
    from jausml.live.peers.judging import competitions, sheets
    from jausml.live.peers.judging.driving import Course

    _check_names(only, competition)
    course = Course(waypoints or Course().waypoints, drive_time)
    rules = competitions.competition(competition, course)
    options["own_id"] = options["own_id"] or competitions.ID.get(competition)
    network = network_from(**options)
    live = output_format == "text"
    with (
        reaching(network, _REMEDY_OF_JUDGE),
        ended_by_signals(),
        identified_network(network, CLIENTS) as ours,
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
            on_score=_shown(lambda score: sheets.task_lines(score.task), sheets.score_lines)
            if live
            else lambda _: None,
            timeout=timeout,
            quiet=quiet_time,
        )
    if live:
        click.echo("\n".join(sheets.ending(sheet)))
    else:
        click.echo(sheets.render_json(sheet), nl=False)
    if output is not None:
        write_report(sheets.render_html(sheet), output)
    if not sheet.is_full:
        raise click.exceptions.Exit(PROBLEMS)


def _check_names(only: tuple[str, ...], competition: str) -> None:
    """Refuses names that no task and no part has."""
    from jausml.live.messages.errors import did_you_mean, similar
    from jausml.live.peers.judging.competitions import task_names

    known = task_names(competition)
    for name in only:
        if name not in known and not name.startswith("codecs."):
            hint = did_you_mean(similar(name, known)) or f"; it has {', '.join(sorted(known))}"
            raise click.BadParameter(
                f"no task {name!r} in {competition}{hint}", param_hint="--only"
            )


_OTHER_ADDRESS = "Give the peer an address of its own: --interface 127.0.0.3"


@click.command("peer")
@click.argument("make", type=click.Choice(MAKES))
@click.option(
    "--id",
    "address",
    callback=parsed_address,
    default="152.1.1",
    metavar="ID",
    help="JAUS id of the rover.",
)
@format_option("Format of the commands that it obeys.")
@click.option(
    "--interface",
    default="127.0.0.2",
    metavar="ADDRESS",
    help="IPv4 address that the rover has; by default, a host of its own on this computer.",
)
@port_option()
@multicast_group_option()
def peer(
    make: str,
    address: JausAddress,
    output_format: str,
    interface: str,
    port: int,
    multicast_group: str,
) -> None:
    """Start a rover of MAKE, to try a bridge or an operator unit with.

    It has the habits of its make on the wire, those that trouble others too: junior is a rover on
    Junior, jts one as the JAUS Tool Set generates it, jaus++ one on JAUS++ 5. It takes
    SetWrenchEffort and reports VelocityState, at 2 m/s for an effort of 100 percent, and prints
    each command that it obeys, until Ctrl-C.

    Exit status: 0 done, 2 the network cannot be used or an option is wrong, 3 internal error.
    """
    from jausml.live.peers import rendering
    from jausml.live.peers.makes.rover import MAKES as MAKERS
    from jausml.live.peers.makes.rover import Rover
    from jausml.live.peers.makes.vehicle import Place

    render = rendering.report_json if output_format == "json" else rendering.report_line

    def obeyed(source: JausAddress, entry: MessageEntry, fields: dict[str, Any]) -> None:
        click.echo(render(source, entry, fields))

    network = network_from(None, interface, port, multicast_group, [])
    rover = Rover(open_catalogue([]), obeyed)
    with reaching(network, _OTHER_ADDRESS):
        peer = MAKERS[make](address, rover, Place(interface, port, multicast_group))
    click.echo(f"{make} rover {address} at {interface}:{port}", err=True)
    try:
        with until_interrupted():
            threading.Event().wait()
    finally:
        peer.close()
