"""`jausml studio` and `jausml language-server`: serve models to browsers and editors."""

from __future__ import annotations

import logging
import webbrowser
from importlib.util import find_spec
from typing import Any

import click

from jausml.cli.shared.files import EnvironmentFault
from jausml.cli.shared.options import (
    interface_option,
    multicast_group_option,
    peer_option,
    port_option,
)
from jausml.cli.shared.terminal import remark

_NEEDED = ("starlette", "uvicorn", "websockets", "watchfiles", "pygraphviz", "pygls")


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
    **network: Any,
) -> None:
    """Show and edit models in the browser: a file, or a folder of them.

    Serves a page to this computer only, and opens the browser. Anybody with the printed address can
    change the model files of the folder. Needs the extra `studio`.

    Exit status: 0 ended by SIGINT or SIGTERM, 2 usage or environment (the port is in use, the extra
    or the page is missing), 3 internal error.
    """
    missing = [each for each in _NEEDED if find_spec(each) is None]
    if missing:
        raise EnvironmentFault(f"the studio needs {missing[0]}: pip install 'jausml[studio]'")
    from jausml.authoring.editing.project import Project
    from jausml.authoring.studio.context import StudioContext
    from jausml.authoring.studio.serving import PageMissingError, require_page, serve
    from jausml.authoring.studio.session import Session
    from jausml.cli.live.network import network_from

    # Who has no page any more sees faults of the studio here.
    logging.getLogger("jausml").addHandler(logging.StreamHandler())
    watched = network_from(None, **network)
    try:
        session = Session(StudioContext(Project(path), out, watched))
    except OSError as error:
        reason = error.strerror or str(error)
        raise EnvironmentFault(f"{click.format_filename(path)}: {reason}") from error

    def opened(address: str) -> None:
        click.echo(f"jausml studio: {address}")
        remark("Ctrl-C ends it.")
        if not no_browser:
            webbrowser.open(address)

    try:
        require_page()
        serve(session, host, page_port, opened)
    except PageMissingError as error:
        raise EnvironmentFault(str(error)) from error
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise EnvironmentFault(f"cannot serve at {host} port {page_port}: {reason}") from error


@click.command("language-server")
def language_server() -> None:
    """Serve editors that show ros2jaus text, by the Language Server Protocol on stdin and stdout.

    Editors start this command; docs/how-to/editor.md shows how. It needs the extra `editor`.

    Exit status: 0 the editor ended it or disconnected, 2 the extra is missing, 3 internal error.
    """
    if find_spec("pygls") is None:
        raise EnvironmentFault("the language server needs pygls: pip install 'jausml[editor]'")
    from jausml.authoring.editor.server import serve

    serve()
