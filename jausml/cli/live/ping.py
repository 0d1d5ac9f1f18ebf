"""`jausml ping`: round trips to a component."""

from __future__ import annotations

import itertools
import time
from typing import TYPE_CHECKING

import click

from jausml.cli.live.network import TARGET, Settings, operator_options, until_interrupted
from jausml.cli.shared import options
from jausml.cli.shared.files import PROBLEMS, to_json
from jausml.cli.shared.options import FiniteRange
from jausml.cli.shared.terminal import warn

if TYPE_CHECKING:
    from jausml.live.peers.measuring import Pings
    from jausml.live.peers.query_client import QueryClient
    from jausml.runtime.base.address import JausAddress

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
    show_default=True,
    help="Seconds between questions.",
)
@click.option(
    "--question",
    type=click.Choice([AUTOMATIC, *options.QUESTIONS]),
    default=AUTOMATIC,
    show_default=True,
    help="Question to ask; automatic is the first of the others that the component answers.",
)
@operator_options
def command(
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

    pings = Pings()
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
