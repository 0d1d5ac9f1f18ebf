"""Generated workspaces, as verbs that run or build them are given them."""

from __future__ import annotations

from pathlib import Path

import click

from jausml.cli.shared.files import EnvironmentFault


def workspace_of(out: str) -> Path:
    """Returns the generated folder: OUT itself, or its src when OUT is the colcon workspace.

    Raises:
        EnvironmentFault: It is none.
    """
    from jausml.generation import MANIFEST_PATH

    for folder in (Path(out), Path(out, "src")):
        if (folder / MANIFEST_PATH).is_file():
            return folder.resolve()
    name = click.format_filename(out)
    raise EnvironmentFault(
        f"{name} is no generated workspace: it has no {MANIFEST_PATH}; "
        f"'jausml generate MODEL -o {name}' makes one"
    )
