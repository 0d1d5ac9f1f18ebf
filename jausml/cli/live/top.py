"""`jausml top`: a running system at a glance."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from datetime import datetime, timezone
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import click

from jausml import installing
from jausml.cli.live.network import Settings, network_from, network_options, transport_options
from jausml.cli.shared.files import EnvironmentFault, in_columns
from jausml.cli.shared.models import ModelFault, optional_model_argument, readable_model
from jausml.cli.shared.options import FiniteRange

if TYPE_CHECKING:
    from jausml.live.peers.operator import Operator
    from jausml.live.systems.monitoring import Monitor
    from jausml.live.systems.ros_diagnostics import RosDiagnostics
    from jausml.live.systems.state import SystemState


@click.command("top")
@optional_model_argument
@click.option("--once", is_flag=True, help="Listen for --duration, print one table, and exit.")
@click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON object per line, every --interval."
)
@click.option(
    "--interval", type=FiniteRange(0.1, 3600), default=1.0, help="Seconds between updates."
)
@click.option(
    "--duration", type=FiniteRange(0.1, 3600), default=5.0, help="Seconds to listen with --once."
)
@network_options
@transport_options
def command(
    model: str | None,
    once: bool,
    as_json: bool,
    interval: float,
    duration: float,
    models: tuple[str, ...],
    **network: Any,
) -> None:
    """Watch a running system: connections of bridges, and JAUS components.

    Shows the connections that bridges report on /diagnostics, with rate, age, latency, losses and
    peers; this needs ROS 2 on this machine. Asks JAUS components for their states and controllers,
    and for those of their state machines where they provide MachineStates, at most once a second.
    Commands nothing and takes no control. With a MODEL, by default that of the project of the
    current folder, parts that it declares and that nobody reports are shown as "not heard", and the
    last messages of a connection can be shown.

    Keys: arrows, / filter, s or 1 to 9 sort, r reverse, enter details, q quit.

    Exit status of --once: 0 all is well, 1 something is in WARN or STALE, or could not be heard, 2
    something is in ERROR or not heard, or an option is wrong, 3 internal error.
    """
    from jausml.cli.live.network import Settings, until_interrupted

    if model is not None:
        _refuse_id(model)
    if not (once or as_json):
        _require_terminal()
    known = models if model is None else (*models, model)
    settings = Settings(network_from(**network), known, timeout=1.0, as_json=as_json)
    monitor = _expected(model)
    with ExitStack() as stack:
        stack.enter_context(until_interrupted())
        operator, ros = stack.enter_context(_sources(settings, monitor))
        if once:
            time.sleep(duration)
            _print(monitor.state(), as_json=as_json)
        elif as_json:
            while True:
                time.sleep(interval)
                _print(monitor.state(), as_json=True)
        else:
            _show(monitor, operator, ros, interval)
    if once:
        raise click.exceptions.Exit(monitor.state().weight)


def _refuse_id(model: str) -> None:
    """Refuses a JAUS id, which other live tools take."""
    from jausml.live.peers.network import component_address

    try:
        component_address(model)
    except ValueError:
        return
    others = f"'jausml ocu status {model}' and 'jausml latency {model}'"
    raise click.UsageError(f"top shows all components, or those of a MODEL; of one tell {others}")


def _require_terminal() -> None:
    without = "--once and --json do without"
    if find_spec("textual") is None:
        reason = f"the terminal view needs textual: {installing.command('top')}"
        raise EnvironmentFault(f"{reason}; {without}")
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        raise EnvironmentFault(f"this is no terminal; {without}")


def _expected(model: str | None) -> Monitor:
    """Returns the monitor of a system of which only the model is known yet."""
    from jausml.live.systems.declarations import components_of, declarations_of
    from jausml.live.systems.folding import expected
    from jausml.live.systems.monitoring import Monitor
    from jausml.live.systems.state import SystemState
    from jausml.runtime.base.standstill import steady

    if model is None:
        return Monitor(SystemState(steady()))
    try:
        read = readable_model([model], is_one=True)
    except ModelFault as error:  # 1 would say that something is in WARN
        raise EnvironmentFault(error.message) from error
    return Monitor(expected(declarations_of(read), components_of(read), steady()))


@contextmanager
def _sources(
    settings: Settings, monitor: Monitor
) -> Iterator[tuple[Operator | None, RosDiagnostics | None]]:
    """Yields the listener to ROS and the asker of JAUS; one of both is enough."""
    from jausml.live.systems.monitoring import listening, polling

    with ExitStack() as stack:
        ros = stack.enter_context(listening(monitor))
        operator = None
        try:
            operator = stack.enter_context(settings.operator())
        except EnvironmentFault as error:
            if ros is None:
                raise
            monitor.take_source("JAUS", error.message)
        else:
            stack.enter_context(polling(monitor, operator))
        yield operator, ros


def _print(state: SystemState, *, as_json: bool) -> None:
    if as_json:
        from jausml.cli.shared.files import to_json
        from jausml.live.systems.state import state_as_json

        now = datetime.now(timezone.utc).isoformat(timespec="milliseconds")
        click.echo(to_json({"time": now, **state_as_json(state)}))
        return
    from jausml.live.systems import tables

    numbers = [index for index, column in enumerate(tables.COLUMNS) if column.is_number]
    rows = [tables.row(connection) for connection in tables.arranged(state, 0)]
    components = [tables.component_row(component) for component in tables.by_address(state)]
    machines = tables.machine_rows(state)
    for line in (
        *in_columns([[column.title for column in tables.COLUMNS], *rows], numbers),
        "",
        *in_columns([tables.COMPONENT_TITLES, *components]),
        *(["", *in_columns([tables.MACHINE_TITLES, *machines])] if machines else []),
        "",
        tables.summary(state),
    ):
        click.echo(line)


def _show(
    monitor: Monitor, operator: Operator | None, ros: RosDiagnostics | None, interval: float
) -> None:
    from jausml.live.systems.inspection import Inspection
    from jausml.live.systems.terminal import SystemView

    SystemView(monitor.state, Inspection(operator, ros), interval).run()
