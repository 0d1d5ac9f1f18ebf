"""`jausml ping` and `jausml latency`: round trips, and rate and age of reports."""

from __future__ import annotations

import itertools
import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jausml.cli.live.network import TARGET, Settings, operator_options, until_interrupted
from jausml.cli.shared import options
from jausml.cli.shared.files import PROBLEMS, ending_at, in_columns, to_json
from jausml.cli.shared.models import or_only_system, readable_model
from jausml.cli.shared.options import FiniteRange
from jausml.cli.shared.terminal import warn

if TYPE_CHECKING:
    from jausml.live.peers.measuring import Pings, ReportTimes, Spread
    from jausml.live.peers.query_client import QueryClient
    from jausml.live.systems.state import ConnectionState
    from jausml.runtime.base.address import JausAddress

_HEAD = ("component", "report", "reports", "Hz", "jitter", "", "age", "", "query", "", "lost")
_UNDER_HEAD = ("", "", "", "", "median", "p99", "median", "p99", "median", "p99", "")

_PLACES, _WORDS = ("in the bridge", "source to bridge"), ("p50", "p99", "max")
_BRIDGE_FIGURES = tuple(f"{place} {word}" for place in _PLACES for word in _WORDS)
_BRIDGE_HEAD = ("bridge", "connection", _PLACES[0], "", "", _PLACES[1], "", "")
_BRIDGE_UNDER_HEAD = ("", "", *_WORDS, *_WORDS)


@click.command("latency")
@click.argument("source", metavar="[ID|MODEL]", required=False, callback=or_only_system("ID|MODEL"))
@click.argument("messages", metavar="[MESSAGE]...", nargs=-1)
@click.option("--duration", type=FiniteRange(0.1, 3600), default=10.0, help="Seconds to measure.")
@click.option(
    "--rate",
    type=FiniteRange(min=0, max=1092, min_open=True),
    metavar="HZ",
    help="Request this number of reports per second; by default, one at every change.",
)
@click.option(
    "--interval",
    type=FiniteRange(0.01, 3600),
    default=0.5,
    help="Seconds between queries for a report.",
)
@operator_options
def latency(
    settings: Settings,
    source: str,
    messages: tuple[str, ...],
    duration: float,
    rate: float | None,
    interval: float,
) -> None:
    """Measure the reports of the component ID, or those of all connections of a MODEL.

    Without either, MODEL is that of the project of the current folder.

    Subscribes to each report, and also queries it. Shows how many reports arrive per second, how
    much the intervals between them deviate from their median (jitter), how old they are on arrival
    by their TimeStamp, which requires synchronized clocks, and how long an answer to the query
    takes. Times are in milliseconds.

    MESSAGE is a report, its query, or the common part of their names: VelocityState. Without it,
    measures every report in the services of the component, except for the core services.

    With a MODEL, also shows what its bridges measure themselves, if ROS 2 is available and their
    parameter `latency` is on.

    Exit status: 0 measured, 1 a report did not arrive at all or a model has errors, 2 nobody
    answers or an option is wrong, 3 internal error.
    """
    from jausml.live.peers.measuring import measure, offered_reports
    from jausml.live.systems.monitoring import Monitor, listening
    from jausml.live.systems.state import SystemState

    model, target = _meant(source)
    if model and messages:
        raise click.UsageError("MESSAGE goes with an ID; a MODEL says by itself what it carries")
    if model:
        settings = replace(settings, models=(*settings.models, source))
    streams: list[ReportTimes] = []
    monitor = Monitor(SystemState())
    with ExitStack() as stack:
        operator = stack.enter_context(settings.operator())
        stack.enter_context(until_interrupted())
        if model:
            stack.enter_context(listening(monitor))
        if target is not None:
            names = messages or offered_reports(operator, target)
            wanted = [(target, name) for name in names]
        else:
            wanted = model
        if not wanted:
            raise click.UsageError(f"{source} has no report that could be measured")
        streams = measure(operator, wanted, duration=duration, rate=rate, interval=interval)
    connections = [
        connection for connection in monitor.state().connections.values() if connection.latency
    ]
    _show(streams, connections, as_json=settings.as_json)
    if any(not stream.arrivals and stream.answers is None for stream in streams) or not streams:
        raise click.exceptions.Exit(PROBLEMS)


def _meant(source: str) -> tuple[list[tuple[JausAddress, str]], JausAddress | None]:
    """Returns the reports that the model carries, or the named component."""
    from jausml.live.peers.measuring import reports_of
    from jausml.live.peers.network import component_address

    if not Path(source).is_file():
        why = f"{source} is no file, and no JAUS id: "
        with ending_at(ValueError, kind=click.UsageError, about=why):
            return [], component_address(source)
    return reports_of(readable_model([source], is_one=True)), None


def _show(
    streams: Sequence[ReportTimes], connections: Sequence[ConnectionState], *, as_json: bool
) -> None:
    for stream in streams:
        if stream.fault:
            warn(f"{stream.component} {stream.report.name}: no event: {stream.fault}")
    if as_json:
        bridges = [_bridge_as_json(connection) for connection in connections]
        reports = [_as_json(stream) for stream in streams]
        click.echo(to_json({"reports": reports, "bridges": bridges}))
        return
    numbers = range(2, len(_HEAD))
    lines = [*in_columns([_HEAD, _UNDER_HEAD, *map(_row, streams)], numbers)]
    if connections:
        rows = [_BRIDGE_HEAD, _BRIDGE_UNDER_HEAD, *map(_bridge_row, connections)]
        lines += ["", *in_columns(rows, numbers)]
    for line in lines:
        click.echo(line)


def _row(stream: ReportTimes) -> tuple[str, ...]:
    rate = "-" if stream.rate is None else f"{stream.rate:.2f}"
    lost = sum(round_trip is None for round_trip in stream.round_trips)
    return (
        str(stream.component),
        stream.report.name,
        str(len(stream.arrivals)),
        rate,
        *_cells(stream.jitter),
        *_cells(stream.ages),
        *_cells(stream.answers),
        f"{lost}/{len(stream.round_trips)}",
    )


def _bridge_row(connection: ConnectionState) -> tuple[str, ...]:
    from jausml.live.peers.rendering import printable

    figures = (connection.latency.get(name) for name in _BRIDGE_FIGURES)
    cells = ("-" if figure is None else f"{figure / 1e3:.3f}" for figure in figures)
    return (printable(connection.bridge), printable(connection.name), *cells)


def _bridge_as_json(connection: ConnectionState) -> dict[str, Any]:
    return {
        "bridge": connection.bridge,
        "connection": connection.name,
        "milliseconds": {name: round(value / 1e3, 6) for name, value in connection.latency.items()},
    }


def _cells(spread: Spread | None) -> tuple[str, str]:
    if spread is None:
        return "-", "-"
    return f"{spread.median * 1e3:.3f}", f"{spread.p99 * 1e3:.3f}"


def _as_json(stream: ReportTimes) -> dict[str, Any]:
    spreads = {"jitter": stream.jitter, "age": stream.ages, "query": stream.answers}
    return {
        "component": str(stream.component),
        "report": stream.report.name,
        "reports": len(stream.arrivals),
        "rate": None if stream.rate is None else round(stream.rate, 4),
        "queries": len(stream.round_trips),
        "unanswered": sum(round_trip is None for round_trip in stream.round_trips),
        "milliseconds": {
            name: None if spread is None else spread.milliseconds()
            for name, spread in spreads.items()
        },
        "fault": stream.fault or None,
    }


AUTOMATIC = "automatic"


@click.command("ping")
@TARGET
@click.option(
    "-c",
    "--count",
    type=click.IntRange(min=1),
    help="End after this number of questions; by default, at Ctrl-C.",
)
@click.option(
    "-i",
    "--interval",
    type=FiniteRange(min=0.001, max=3600),
    default=1.0,
    help="Seconds between questions.",
)
@click.option(
    "--question",
    type=click.Choice([AUTOMATIC, *options.QUESTIONS]),
    default=AUTOMATIC,
    help="Question to ask; automatic is the first of the others that the component answers.",
)
@operator_options
def ping(
    settings: Settings, target: JausAddress, count: int | None, interval: float, question: str
) -> None:
    """Ask a component repeatedly, and show how long each answer takes.

    A round trip includes the network in both directions and the time in both programs. Only one
    question is open at a time. An answer that arrives after --timeout counts for the next question,
    because JAUS queries have no number.

    Exit status: 0 answers came, 1 none came, 2 the network cannot be used or an option is wrong, 3
    internal error.
    """
    from jausml.live.peers.measuring import Pings, answered_question

    pings, chosen = Pings(), None
    with settings.operator() as operator:
        with until_interrupted():
            chosen = answered_question(operator, target) if question == AUTOMATIC else question
            if chosen is None:
                warn(str(operator.unanswered(target, "any question")))
            else:
                _ping(operator, target, chosen, pings, count, interval, as_json=settings.as_json)
        _summarize(target, chosen, pings, as_json=settings.as_json)
    if not pings.answered:
        raise click.exceptions.Exit(PROBLEMS)


def _ping(
    client: QueryClient,
    target: JausAddress,
    question: str,
    pings: Pings,
    count: int | None,
    interval: float,
    *,
    as_json: bool,
) -> None:
    from jausml.live.peers.measuring import QUESTIONS

    query, report = QUESTIONS[question]
    if not as_json:
        click.echo(f"{target}: {query.NAME} every {interval:g} s")
    due = time.monotonic()
    for number in itertools.count(1) if count is None else range(1, count + 1):
        time.sleep(max(0.0, due - time.monotonic()))
        # A late answer delays the next question; what was missed is not caught up.
        due = max(due + interval, time.monotonic())
        seconds = client.round_trip(target, query, report)
        pings.round_trips.append(seconds)
        milliseconds = None if seconds is None else round(seconds * 1e3, 3)
        if as_json:
            click.echo(to_json({"question": number, "milliseconds": milliseconds}))
        elif milliseconds is None:
            click.echo(f"{target}: question {number}: no answer within {client.timeout:g} s")
        else:
            click.echo(f"{target}: question {number}: {milliseconds:.3f} ms")


def _summarize(target: JausAddress, question: str | None, pings: Pings, *, as_json: bool) -> None:
    from jausml.live.peers.measuring import QUESTIONS

    spread = pings.spread
    figures = None if spread is None else spread.milliseconds()
    if as_json:
        summary = {
            "component": str(target),
            "message": None if question is None else QUESTIONS[question][0].NAME,
            "sent": pings.sent,
            "answered": pings.answered,
            "loss": round(pings.loss, 4),
            "milliseconds": figures,
        }
        click.echo(to_json(summary))
        return
    click.echo(f"{pings.sent} asked, {pings.answered} answered, {pings.loss:.1%} lost")
    if figures is not None:
        click.echo(
            "round trip in ms: "
            + ", ".join(f"{name} {value:.3f}" for name, value in figures.items())
        )
