"""`jausml conformance`: checks a running component of any make over the wire."""

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
from jausml.cli.shared.options import CONFORMANCE_FORMATS, format_option

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.live.peers.conformance.check import CheckResult, ConformanceReport
    from jausml.live.peers.conformance.groups import CheckFilter, CheckGroup
    from jausml.live.peers.conformance.session import Session

_REMEDY = (
    "Use another port and say where the target is, which also holds for one behind a node manager: "
    "--port 3795 --peer ID=HOST:3794"
)

CLIENTS = 3
"""Ids that the checks use."""


def _checks(
    _context: click.Context, _option: click.Parameter, names: tuple[str, ...]
) -> tuple[str, ...]:
    """Refuses names that no group and no check has."""
    from jausml.live.messages.errors import did_you_mean, similar
    from jausml.live.peers.conformance.groups import known_names, unknown

    for name in unknown(names):
        hint = did_you_mean(similar(name, known_names())) or "; --list names the checks"
        raise click.BadParameter(f"no check {name!a}{hint}")
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
    own_id: str | None,
    interface: str,
    port: int,
    multicast_group: str,
    peers: tuple[str, ...],
    models: tuple[str, ...],
) -> None:
    """Check the conformance of the running component TARGET_ID, from any vendor, over the wire.

    Tests its transport, its core services by the state tables of AS5710, and the messages of every
    service that it announces. Sends no command that moves anything. Control and emergencies that
    the checks cause are undone, also after Ctrl-C. The tool uses three ids: its own and the two
    after it. Checks that a fragile target may not survive come last; when the target is started
    again, testing continues.

    Exit status: 0 no check failed, 1 checks failed, 2 the target cannot be reached or an option is
    wrong, 3 internal error.
    """
    from jausml.live.peers.conformance.groups import CheckFilter
    from jausml.live.peers.conformance.run import opened
    from jausml.live.peers.conformance.session import Limits

    selection = CheckFilter(frozenset(only), frozenset(skip))
    if list_checks:
        _list_checks(selection)
        return
    if target is None:
        raise click.UsageError("Missing argument 'TARGET_ID', e.g. 100.1.1.")
    network = network_from(own_id, interface, port, multicast_group, peers)
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
    if report.interrupted or not report.passed:
        raise click.exceptions.Exit(PROBLEMS)


def _checked(session: Session, groups: Sequence[CheckGroup], *, live: bool) -> ConformanceReport:
    """Runs the checks and, on a terminal, shows each result as it comes."""
    from jausml.live.peers.conformance.formats import heading, result_lines
    from jausml.live.peers.conformance.run import run

    latest = ""

    def show(result: CheckResult) -> None:
        nonlocal latest
        if not live:
            return
        if result.check.group != latest:
            latest = result.check.group
            click.echo(f"\n{latest}")
        for line in result_lines(result):
            click.echo(line)

    if live:
        host, port = session.probe.endpoint or ("", 0)
        services = tuple(f"{each.urn} {each.major}.{each.minor}" for each in session.services)
        for line in heading(str(session.probe.target), f"{host}:{port}", services):
            click.echo(line)
    return run(session, groups, show)


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
    from jausml.live.peers.conformance.groups import fixed_checks

    for check in fixed_checks():
        if not selection.takes(check.id):
            continue
        mark = " (only with --destructive)" if check.destructive else ""
        mark = " (late: a target may not survive it)" if check.risky else mark
        click.echo(f"{check.id:44} {check.title}{mark}")
    if selection.takes("codecs"):
        click.echo(f"{'codecs.SERVICE.QUERY':44} One for each query of the announced services")
