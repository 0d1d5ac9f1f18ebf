"""`jausml operate`: command components from a page, in a process of its own."""

from __future__ import annotations

import logging
import webbrowser
from contextlib import closing, contextmanager
from importlib.util import find_spec
from logging.handlers import QueueHandler, QueueListener
from pathlib import Path
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any

import click

from jausml import installing
from jausml.cli.live.network import network_from, serve_page
from jausml.cli.shared.files import EnvironmentFault, ending_at
from jausml.cli.shared.options import STOP_WORDS, FiniteRange, page_network_options, page_options
from jausml.cli.shared.terminal import remark

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.live.operating.serving import OperatorSite
    from jausml.live.operating.unit import Powers

_NEEDED = ("starlette", "uvicorn", "websockets", "watchfiles")


@click.command("operate")
@click.argument(
    "path",
    metavar="[MODEL|FOLDER]",
    default=".",
    type=click.Path(exists=True, resolve_path=True, path_type=Path),
)
@page_options
@click.option(
    "--stop-all",
    type=click.Choice(STOP_WORDS),
    help="Let pages with a second address command components. The word is what Stop does, to those "
    "that are controlled: standby (Management), or emergency, which lasts until it is cleared.",
)
@click.option(
    "--lease",
    type=FiniteRange(0.5, 60.0),
    metavar="SECONDS",
    help="With --stop-all: how long the page that commands may be silent before all that it "
    "controls is stopped and released. You decide it, there is no default.",
)
@click.option(
    "--stop",
    "stops",
    multiple=True,
    metavar="'MESSAGE SECONDS FIELDS'",
    help="With --stop-all: the message that stops a command of the stick, and after which silence "
    "of the page. May be repeated; without it, what the model declares.",
)
@page_network_options
def command(
    path: Path,
    host: str,
    page_port: int,
    no_browser: bool,
    stop_all: str | None,
    lease: float | None,
    stops: tuple[str, ...],
    **network: Any,
) -> None:
    """Watch and command components in the browser: those of a model, or of a folder of them.

    Serves a page to this computer only, and opens the browser to look. Nothing is commanded without
    --stop-all, which prints the address to do so. A guardian process says the stops when this one
    is killed or stands still. Needs the extra `studio`.

    Exit status: 0 ended by SIGINT, SIGTERM or SIGHUP, 2 usage or environment (the port is in use,
    the extra or the page is missing, the model cannot be read), 3 internal error.
    """
    missing = next((module for module in _NEEDED if find_spec(module) is None), None)
    if missing is not None:
        raise EnvironmentFault(f"operating needs {missing}: {installing.command('studio')}")
    from jausml.live.messages import MessageError
    from jausml.live.operating import serving
    from jausml.live.operating.knowledge import Learning, ReadingError

    powers = _powers(stop_all, lease, stops)
    if powers is not None:
        logging.getLogger("jausml.operating").setLevel(logging.INFO)
    watched = network_from(None, **network)
    with closing(Learning(path)) as learning, ending_at(ReadingError):
        knowledge = learning.first()
        if knowledge.fault:
            # The stops of a model are those of the start: it must be there to be read.
            raise EnvironmentFault(knowledge.fault)
        with ending_at(MessageError, ValueError, kind=click.UsageError, about="--stop: "):
            site = serving.OperatorSite(knowledge, learning, watched, powers)
        with _logged():
            serve_page(host, page_port, site, lambda: _opened(site, no_browser))


@contextmanager
def _logged() -> Iterator[None]:
    """Lets a thread write the log, which has faults and the journal also without a page."""
    # A terminal that takes nothing, as after Ctrl-S, would hold up the stop that is noted.
    lines: SimpleQueue[logging.LogRecord] = SimpleQueue()
    listener = QueueListener(lines, logging.StreamHandler())
    handler = QueueHandler(lines)
    logger = logging.getLogger("jausml")
    logger.addHandler(handler)
    listener.start()
    try:
        yield
    finally:
        logger.removeHandler(handler)
        listener.stop()


def _opened(site: OperatorSite, no_browser: bool) -> None:
    click.echo(f"jausml operate: {site.address}")
    if site.commanding_address:
        click.echo(f"to command: {site.commanding_address}")
    remark("Ctrl-C ends it.")
    if not no_browser:
        # The other one would stand among the processes, which every user of the computer sees.
        webbrowser.open(site.address)


def _powers(stop_all: str | None, lease: float | None, stops: tuple[str, ...]) -> Powers | None:
    """Returns the commands that pages may give, None for none."""
    if (stop_all is None) != (lease is None):
        raise click.UsageError("--stop-all and --lease belong together: both say what is safe")
    if stop_all is None or lease is None:
        if stops:
            raise click.UsageError("--stop is for --stop-all")
        return None
    from jausml.live.operating.unit import Powers

    return Powers(stop_all, lease, stops)
