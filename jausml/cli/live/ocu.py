"""`jausml ocu`: an operator control unit for components of any make."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Iterator
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from jausml.cli.live.network import (
    FIELDS,
    MESSAGE,
    TARGET,
    Settings,
    operator_options,
    until_interrupted,
)
from jausml.cli.shared.files import PROBLEMS
from jausml.cli.shared.options import AUTHORITY, FiniteRange
from jausml.cli.shared.terminal import remark, warn

if TYPE_CHECKING:
    from jausml.live.messages import MessageEntry
    from jausml.live.peers.console import Console
    from jausml.runtime.base.address import JausAddress

LOST = 4
"""Exit status when Ready or control was lost while commanding."""

_LONGEST_PAUSE = 0.1

_LATE_REPORTS = 3  # periodic reports that may be missing before it is told


@click.group("ocu", invoke_without_command=True)
@click.pass_context
@operator_options
def command(context: click.Context, settings: Settings) -> None:
    """Operate running JAUS components from any vendor: find, query, watch and control them.

    Without a command, starts a session that reads commands from the terminal or from a pipe; the
    command 'help' of the session lists them. At the end, also after Ctrl-C, control is released and
    events are cancelled.

    Exit status: 0 done, 1 a component refused or a command of a session failed, 2 nobody answers or
    an option is wrong, 3 internal error, 4 a component was lost while it was commanded.
    """
    if context.invoked_subcommand is None:
        _run_session(settings)
        return
    parameters = {
        name: value
        for name, value in context.params.items()
        if context.get_parameter_source(name) is ParameterSource.COMMANDLINE
    }
    context.default_map = dict.fromkeys(command.commands, parameters)


@command.command("session", short_help="Read commands from the terminal or a pipe.")
@operator_options
def session(settings: Settings) -> None:
    """Read commands from the terminal or from a pipe; 'help' lists them."""
    _run_session(settings)


@command.command("discover")
@click.option("--duration", type=FiniteRange(0.05, 3600), default=2.0, help="Seconds to listen.")
@operator_options
def discover(settings: Settings, duration: float) -> None:
    """Show subsystems, nodes, components and their services."""
    from jausml.live.peers import rendering
    from jausml.live.peers.query_client import NoAnswer

    with settings.operator() as operator:
        subsystems = operator.survey.take(duration)
        if settings.as_json:
            click.echo(rendering.subsystems_json(subsystems))
        else:
            for line in rendering.subsystem_lines(subsystems):
                click.echo(line)
        if not subsystems:
            raise NoAnswer(operator.nothing_heard)


@command.command("services")
@TARGET
@operator_options
def services(settings: Settings, target: JausAddress) -> None:
    """Show the services that the component ID provides."""
    from jausml.live.peers import rendering

    with settings.operator() as operator:
        provided_services = operator.services(target)
        if not provided_services:
            raise operator.unanswered(target, "QueryServices", "ReportServices")
        if settings.as_json:
            click.echo(rendering.services_json(target, provided_services))
        else:
            for line in rendering.service_lines(provided_services):
                click.echo(line)


@command.command("status")
@TARGET
@operator_options
def status(settings: Settings, target: JausAddress) -> None:
    """Show the state of the component ID and who controls it."""
    from jausml.live.peers import rendering

    with settings.operator() as operator:
        state, control = operator.status(target)
        is_controlled = control is not None and bool(control.subsystem_id)
        timeout = operator.control_timeout(target) if is_controlled else None
        if settings.as_json:
            click.echo(rendering.status_json(target, state, control, timeout))
        else:
            words = (rendering.status_line(state, control), rendering.lapse_words(timeout))
            click.echo(f"{target} {'; '.join(filter(None, words))}")


@command.command("query")
@TARGET
@MESSAGE
@FIELDS
@operator_options
def query(
    settings: Settings, target: JausAddress, message: str, fields: dict[str, Any] | None
) -> None:
    """Query the component ID for a report and show it.

    MESSAGE is the query, its report, or the common part of their names: VelocityState. FIELDS is a
    JSON object with the fields of the query; without it, the query asks for everything.
    """
    with settings.operator() as operator:
        settings.show(target, *operator.query(target, message, fields))


@command.command("watch")
@TARGET
@MESSAGE
@click.option(
    "--rate",
    type=FiniteRange(min=0, max=1092, min_open=True),
    metavar="HZ",
    help="Reports per second.",
)
@click.option(
    "--every-change", is_flag=True, help="Request a report at every change (the default)."
)
@click.option("--count", type=click.IntRange(min=1), help="End after this number of reports.")
@click.option(
    "--duration", type=FiniteRange(min=0, min_open=True), help="End after this number of seconds."
)
@operator_options
def watch(
    settings: Settings,
    target: JausAddress,
    message: str,
    rate: float | None,
    every_change: bool,
    count: int | None,
    duration: float | None,
) -> None:
    """Subscribe to a report of the component ID and show it live.

    MESSAGE is the query, its report, or the common part of their names: VelocityState. Ends after
    --count reports, after --duration seconds, or with Ctrl-C.
    """
    if rate is not None and every_change:
        raise click.UsageError("--rate and --every-change exclude each other")
    with settings.operator() as operator, until_interrupted():
        reports: SimpleQueue[tuple[MessageEntry, dict[str, Any]]] = SimpleQueue()
        operator.watch(target, message, rate, lambda entry, fields: reports.put((entry, fields)))
        heard = time.monotonic()
        end = None if duration is None else heard + duration
        patience = math.inf if rate is None else max(settings.timeout, _LATE_REPORTS / rate)
        shown = 0
        while count is None or shown < count:
            if end is not None and time.monotonic() >= end:
                break
            try:
                entry, fields = reports.get(timeout=_LONGEST_PAUSE)
            except Empty:
                if time.monotonic() - heard > patience:
                    warn(f"warning: no report of {target} for {patience:g} s")
                    heard, patience = time.monotonic(), patience * 2
                continue
            heard = time.monotonic()
            settings.show(target, entry, fields)
            shown += 1


_AUTHORITY = click.option(
    "--authority",
    type=click.IntRange(0, 255),
    default=AUTHORITY,
    help="Authority with which to request control.",
)
_NO_RESUME = click.option("--no-resume", is_flag=True, help="Leave the component in Standby.")


@command.command("request", short_help="Send a message and show what comes back.")
@TARGET
@MESSAGE
@FIELDS
@_AUTHORITY
@_NO_RESUME
@operator_options
def request_answer(
    settings: Settings,
    target: JausAddress,
    message: str,
    fields: dict[str, Any] | None,
    authority: int,
    no_resume: bool,
) -> None:
    """Send MESSAGE to the component ID and show what comes back within --timeout.

    That is the message by which its service confirms it; after SetX without a confirmation, ReportX
    as soon as it has what was set; after a command such as Standby, the state. If the component
    obeys its controller alone, control is requested before, and released afterwards. FIELDS is a
    JSON object with the fields of the message.

    The exit status is 1 if the component rejects the message or it has no effect, and 2 if nothing
    comes.
    """
    from jausml.live.peers.console import Console
    from jausml.live.peers.requesting import request

    with settings.operator() as operator, until_interrupted():
        is_controlled = operator.needs_control(target, message)
        if is_controlled:
            operator.control(target, authority)
        try:
            if is_controlled and not no_resume:
                Console(operator, remark).resume(target)
            settings.show(target, *request(operator, target, message, fields))
        finally:
            if is_controlled:
                operator.release(target)


@command.command("command", short_help="Control a component, send it a message, and release it.")
@TARGET
@MESSAGE
@FIELDS
@_AUTHORITY
@click.option(
    "--rate",
    type=FiniteRange(min=0, max=1000, min_open=True),
    metavar="HZ",
    help="Repeat the message at this rate for --duration.",
)
@click.option(
    "--duration",
    type=FiniteRange(min=0),
    default=0.0,
    show_default=False,
    metavar="SECONDS",
    help="Keep control for this time after the first message.",
)
@_NO_RESUME
@click.option(
    "--keep-sending",
    is_flag=True,
    help="Continue for --duration when the component leaves Ready or is taken over.",
)
@operator_options
def send_command(
    settings: Settings,
    target: JausAddress,
    message: str,
    fields: dict[str, Any] | None,
    authority: int,
    rate: float | None,
    duration: float,
    no_resume: bool,
    keep_sending: bool,
) -> None:
    """Control the component ID, resume it, send MESSAGE, and release control.

    FIELDS is a JSON object with the fields of the message. The component leaves Ready when it is
    released. Use --duration to keep control, and --rate to repeat the message if the component
    stops without fresh commands.

    Sending ends at once when the component leaves Ready (for example, in an emergency), is taken
    over by a higher authority, or no longer answers. The exit status is 4 then, also with
    --keep-sending.
    """
    from jausml.live.peers.console import Console
    from jausml.live.peers.requesting import Course, outcome
    from jausml.live.peers.requesting import command as send

    if rate is not None and not duration:
        raise click.UsageError("--rate needs a --duration")
    with settings.operator() as operator, until_interrupted():
        entry = operator.find(target, message)
        ready = operator.message(entry, fields or {})
        console = Console(operator, remark)
        operator.survey.ask(target)
        hold = operator.control(target, authority)
        remark(f"{target} is controlled")
        try:
            if not no_resume:
                console.resume(target)
            course = Course(rate, duration, keep_sending=keep_sending)
            send(operator, hold, ready, course, warn)
        finally:
            # What the user reads and the exit status say the same, whatever happens meanwhile.
            is_lost = hold.is_lost
            if hold.sent:
                (warn if is_lost else remark)(outcome(entry.name, hold))
            if not is_lost or hold.is_held:
                console.release(target)
            # Looked up last: it takes time in which nothing should be controlled.
            if hold.sent and (lack := operator.lack(target, entry.name)):
                warn(f"warning: {target} may ignore {entry.name}: {lack}")
        if is_lost:
            raise click.exceptions.Exit(LOST)


def _run_session(settings: Settings) -> None:
    from jausml.live.peers.console import Console

    with settings.operator() as operator, until_interrupted():
        console = Console(operator, click.echo)
        if sys.stdin.isatty():
            remark("'help' lists the commands, 'quit' ends")
            _complete_with(console)
            console.run(_typed())
            return
        console.run(sys.stdin)
        if console.failures or console.has_doubts:
            raise click.exceptions.Exit(PROBLEMS if console.failures else LOST)


def _complete_with(console: Console) -> None:
    """Lets the tab key complete words, where Python can."""
    try:
        import readline
    except ImportError:
        return

    def complete(_word: str, index: int) -> str | None:
        completions = console.completions(readline.get_line_buffer()[: readline.get_endidx()])
        return completions[index] if index < len(completions) else None

    readline.set_completer_delims(" ")
    readline.set_completer(complete)
    readline.parse_and_bind("tab: complete")


def _typed() -> Iterator[str]:
    """Yields the lines that the user types, until the end of input."""
    while True:
        try:
            yield input("ocu> ")
        except EOFError:
            return
