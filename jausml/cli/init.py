"""`jausml init`: makes a project of models."""

from __future__ import annotations

from pathlib import Path

import click

from jausml.cli.common import EnvironmentFault


@click.command("init")
@click.argument("folder", metavar="DIR", type=click.Path(file_okay=False, path_type=Path))
@click.option("--name", metavar="NAME", help="Name of the system; by default that of the folder.")
@click.option(
    "--notation",
    type=click.Choice(["xmi", "text"]),
    default="xmi",
    show_default=True,
    help="What the model is written in.",
)
@click.option(
    "--from",
    "origin",
    type=click.Choice(["example", "empty"]),
    default="example",
    show_default=True,
    help="What stands in the model: a sensor and a bridge that work, or nothing.",
)
def command(folder: Path, name: str | None, notation: str, origin: str) -> None:
    """Make a project of models in DIR, which may be there already.

    It holds a model that validates, generates and runs; copies of the metamodels and the library,
    so that Eclipse opens it as it is; a workflow for CI, hooks for pre-commit, and a README. No
    file of yours is overwritten.

    Exit status: 0 done, 2 usage or environment (a file is there already), 3 internal error.
    """
    from jausml.projects.creating import ProjectError, Wish, create, name_for

    try:
        wish = Wish(name or name_for(folder), notation == "text", origin == "empty")
        written = create(folder, wish)
    except ProjectError as error:
        raise EnvironmentFault(str(error)) from error
    except OSError as error:
        raise EnvironmentFault(f"{error.filename} cannot be written: {error.strerror}") from error
    click.echo(f"{len(written)} files in {folder}; next:")
    click.echo(f"  cd {folder}")
    click.echo("  jausml validate models")
    click.echo(f"  jausml generate {wish.model} -o src")
    click.echo("  jausml run src --for 10")
