"""`jausml upgrade`: brings a project to the present version of the metamodels."""

from __future__ import annotations

from pathlib import Path

import click

from jausml.cli.common import PROBLEMS, EnvironmentFault


@click.command("upgrade")
@click.argument(
    "folder",
    metavar="[DIR]",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    default=".",
)
@click.option(
    "--check", is_flag=True, help="Write nothing; exit with 1 if something is out of date."
)
def command(folder: Path, check: bool) -> None:
    """Bring the models in DIR, by default this folder, to the current version of the metamodels.

    Replaces names that have changed, and leaves the rest of the files as it is: layout, comments
    and order. Renews the copies of metamodels and library that `jausml init` made, unless they have
    been edited. Writes either all files or none.

    Exit status: 0 done, 1 a model cannot be upgraded (--check: or something is out of date), 2
    usage or environment, 3 internal error.
    """
    from jausml.authoring.projects.errors import ProjectError
    from jausml.authoring.projects.upgrading.project import carry_out, upgrade_of
    from jausml.authoring.projects.upgrading.steps import UpgradeError

    try:
        upgrade = upgrade_of(folder)
        if not check:
            carry_out(upgrade)
    except UpgradeError as error:
        click.echo(f"{error}; nothing written", err=True)
        raise click.exceptions.Exit(PROBLEMS) from error
    except ProjectError as error:
        raise EnvironmentFault(str(error)) from error
    except OSError as error:
        raise EnvironmentFault(f"{error.filename}: {error.strerror}") from error
    root = folder.resolve()
    for path in upgrade.kept:
        click.echo(f"{path.relative_to(root)} stays: it was changed here", err=True)
    for path in upgrade.files:
        click.echo(f"{path.relative_to(root)} {'is old' if check else 'upgraded'}")
    if not upgrade.files:
        click.echo(f"all {'else ' * bool(upgrade.kept)}is of the present version", err=True)
    elif check:
        raise click.exceptions.Exit(PROBLEMS)
