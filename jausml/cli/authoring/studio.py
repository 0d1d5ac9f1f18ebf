"""`jausml studio` and `jausml language-server`: serve models to browsers and editors."""

from __future__ import annotations

import logging
import webbrowser
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import click

from jausml import installing
from jausml.cli.shared.files import EnvironmentFault, ending_at
from jausml.cli.shared.options import page_network_options, page_options
from jausml.cli.shared.terminal import remark

_NEEDED = ("starlette", "uvicorn", "websockets", "watchfiles", "pygls")


@click.command("studio")
@click.argument("path", metavar="[MODEL|FOLDER]", default=".")
@page_options
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
@page_network_options
def command(
    path: str,
    host: str,
    page_port: int,
    no_browser: bool,
    out: str,
    recordings: tuple[Path, ...],
    **network: Any,
) -> None:
    """Show and edit models in the browser: a file, or a folder of them.

    Serves a page to this computer only, and opens the browser. Anybody with the printed address can
    change the model files of the folder; nothing here commands a component, which `jausml operate`
    is for. Needs the extra `studio`.

    Exit status: 0 ended by SIGINT, SIGTERM or SIGHUP, 2 usage or environment (the port is in use,
    the extra or the page is missing), 3 internal error.
    """
    _require_extra()
    from jausml.authoring.editing.project import Project
    from jausml.authoring.studio import serving
    from jausml.authoring.studio.context import StudioContext
    from jausml.authoring.studio.session import Session
    from jausml.cli.live.network import network_from, serve_page

    # Who has no page any more sees faults of the studio here.
    logging.getLogger("jausml").addHandler(logging.StreamHandler())
    watched = network_from(None, **network)
    with ending_at(OSError, about=f"{click.format_filename(path)}: "):
        project = Project(path)
    context = StudioContext(project, out, watched, given_recordings=recordings)
    studio = serving.Studio(Session(context))

    def opened() -> None:
        click.echo(f"jausml studio: {studio.address}")
        remark("Ctrl-C ends it.")
        if not no_browser:
            webbrowser.open(studio.address)

    serve_page(host, page_port, studio, opened)


def _require_extra() -> None:
    from jausml.views.diagrams.layout import graphviz

    missing = [module for module in _NEEDED if find_spec(module) is None]
    if graphviz.program() is None:
        missing.append(graphviz.PACKAGE)
    if missing:
        raise EnvironmentFault(f"the studio needs {missing[0]}: {installing.command('studio')}")


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
