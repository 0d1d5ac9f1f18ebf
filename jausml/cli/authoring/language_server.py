"""`jausml language-server`: serves editors of ros2jaus text."""

from __future__ import annotations

from importlib.util import find_spec

import click

from jausml.cli.shared.files import EnvironmentFault


@click.command("language-server")
def command() -> None:
    """Serve editors that show ros2jaus text, by the Language Server Protocol on stdin and stdout.

    Editors start this command; docs/how-to/editor.md shows how. It needs the extra `editor`.

    Exit status: 0 the editor ended it or disconnected, 2 the extra is missing, 3 internal error.
    """
    if find_spec("pygls") is None:
        raise EnvironmentFault("the language server needs pygls: pip install 'jausml[editor]'")
    from jausml.authoring.editor.server import serve

    serve()
