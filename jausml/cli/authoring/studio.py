"""`jausml studio` and `jausml language-server`: serve models to browsers and editors."""

from __future__ import annotations

import logging
import webbrowser
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jausml import installing
from jausml.cli.shared.files import EnvironmentFault
from jausml.cli.shared.options import (
    STOP_WORDS,
    FiniteRange,
    interface_option,
    multicast_group_option,
    peer_option,
    port_option,
)
from jausml.cli.shared.terminal import remark

if TYPE_CHECKING:
    from jausml.authoring.studio.operating.unit import Powers

_NEEDED = ("starlette", "uvicorn", "websockets", "watchfiles", "pygls")


@click.command("studio")
@click.argument("path", metavar="[MODEL|FOLDER]", default=".")
@click.option(
    "--host",
    default="127.0.0.1",
    metavar="ADDRESS",
    help="Address to serve at; 127.0.0.1 is reachable from this computer only, others from the "
    "network.",
)
@click.option(
    "--port",
    "page_port",
    type=click.IntRange(0, 65535),
    default=0,
    show_default=False,
    metavar="PORT",
    help="Port to serve at; by default, a free one.",
)
@click.option("--no-browser", is_flag=True, help="Print the address without opening a browser.")
@click.option(
    "--out",
    default="",
    show_default=False,
    metavar="DIR",
    help="Output folder for code generated from the page.",
)
@click.option(
    "--recording",
    "recordings",
    multiple=True,
    metavar="FILE",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    help="MCAP file of `jausml record` that the page may show, beside those of the folder. May be "
    "repeated: two are compared.",
)
@click.option(
    "--operate",
    type=click.Choice(STOP_WORDS),
    help="Let pages with a second address command components. The word is what Stop does, to those "
    "that are controlled: standby (Management), or emergency, which lasts until it is cleared.",
)
@click.option(
    "--lease",
    type=FiniteRange(0.5, 60.0),
    metavar="SECONDS",
    help="With --operate: how long the page that commands may be silent before all that it "
    "controls is stopped and released. You decide it, there is no default.",
)
@click.option(
    "--stop",
    "stops",
    multiple=True,
    metavar="'MESSAGE SECONDS FIELDS'",
    help="With --operate: the message that stops a command of the stick, and after which silence "
    "of the page. May be repeated; without it, what the model declares.",
)
@interface_option("--jaus-interface")
@port_option("--jaus-port")
@multicast_group_option("--jaus-multicast-group")
@peer_option("--jaus-peer")
def command(
    path: str,
    host: str,
    page_port: int,
    no_browser: bool,
    out: str,
    recordings: tuple[Path, ...],
    operate: str | None,
    lease: float | None,
    stops: tuple[str, ...],
    **network: Any,
) -> None:
    """Show and edit models in the browser: a file, or a folder of them.

    Serves a page to this computer only, and opens the browser. Anybody with the printed address can
    change the model files of the folder, and nothing commands a component without --operate. Needs
    the extra `studio`.

    Exit status: 0 ended by SIGINT or SIGTERM, 2 usage or environment (the port is in use, the extra
    or the page is missing), 3 internal error.
    """
    _require_extra()
    from jausml.authoring.editing.project import Project
    from jausml.authoring.studio.context import StudioContext
    from jausml.authoring.studio.serving import PageMissingError, Studio, require_page, serve
    from jausml.authoring.studio.session import Session
    from jausml.cli.live.network import network_from

    powers = _powers(operate, lease, stops)
    # Who has no page any more sees faults of the studio here.
    logging.getLogger("jausml").addHandler(logging.StreamHandler())
    if powers is not None:
        logging.getLogger("jausml.operating").setLevel(logging.INFO)
    watched = network_from(None, **network)
    try:
        project = Project(path)
    except OSError as error:
        reason = error.strerror or str(error)
        raise EnvironmentFault(f"{click.format_filename(path)}: {reason}") from error
    context = StudioContext(project, out, watched, given_recordings=recordings)
    try:
        session = Session(context, powers)
    except ValueError as error:
        raise click.UsageError(f"--stop: {error}") from error

    def opened(studio: Studio) -> None:
        click.echo(f"jausml studio: {studio.address}")
        if studio.commanding_address:
            click.echo(f"to command: {studio.commanding_address}")
        remark("Ctrl-C ends it.")
        if not no_browser:
            webbrowser.open(studio.commanding_address or studio.address)

    try:
        require_page()
        serve(session, host, page_port, opened)
    except PageMissingError as error:
        raise EnvironmentFault(str(error)) from error
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise EnvironmentFault(f"cannot serve at {host} port {page_port}: {reason}") from error


def _require_extra() -> None:
    from jausml.views.diagrams.layout import graphviz

    missing = [module for module in _NEEDED if find_spec(module) is None]
    if graphviz.program() is None:
        missing.append(graphviz.PACKAGE)
    if missing:
        raise EnvironmentFault(f"the studio needs {missing[0]}: {installing.command('studio')}")


def _powers(operate: str | None, lease: float | None, stops: tuple[str, ...]) -> Powers | None:
    """Returns what pages may command, None for nothing."""
    if (operate is None) != (lease is None):
        raise click.UsageError("--operate and --lease belong together: both say what is safe")
    if operate is None or lease is None:
        if stops:
            raise click.UsageError("--stop is for --operate")
        return None
    from jausml.authoring.studio.operating.unit import Powers

    return Powers(operate, lease, stops)


@click.command("language-server")
def language_server() -> None:
    """Serve editors that show ros2jaus text, by the Language Server Protocol on stdin and stdout.

    Editors start this command; docs/how-to/editor.md shows how. It needs the extra `editor`.

    Exit status: 0 the editor ended it or disconnected, 2 the extra is missing, 3 internal error.
    """
    if find_spec("pygls") is None:
        raise EnvironmentFault(f"the language server needs pygls: {installing.command('editor')}")
    from jausml.authoring.editor.server import serve

    serve()
