"""`jausml build`: compiles the cores of the bridges of a workspace."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from jausml.cli.live.workspace import workspace_of
from jausml.cli.shared.files import PROBLEMS, EnvironmentFault
from jausml.cli.shared.terminal import remark, step, warn

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from jausml.generation.native import Built

MISSING = "no compiler: install g++ or clang++, or name one in CXX; until then, Python translates"


@click.command("build")
@click.argument("out", metavar="[OUT]", default=".")
def command(out: str) -> None:
    """Compile the translations of the bridges in a generated workspace, by default in this folder.

    Each bridge has the source core/core.cpp, of which a library is made beside its Python module.
    The usual message is then translated by it, a list in about a tenth of the time; Python treats
    the others as before. A library that was made of the present source stays. `jausml run` builds
    as well, and `colcon build` does where the workspace is built with it.

    The compiler is the one that the variable CXX names, or g++ or clang++.

    Exit status: 0 every library is there, 1 one could not be built, 2 OUT is no generated
    workspace, or there is no compiler, 3 internal error.
    """
    from jausml.generation import native

    folder = workspace_of(out)
    sources = native.cores(folder)
    program = native.compiler()
    if program is None and not all(map(native.is_current, sources)):
        raise EnvironmentFault(MISSING)
    made = _built(sources, program or "")
    for each in made:
        reason = f": {each.reason}" if each.reason else ""
        click.echo(f"{each.state.value} {each.library.relative_to(folder)}{reason}")
    if not made:
        remark(f"no bridge in {click.format_filename(out)} has a compiled form")
    if any(each.reason for each in made):
        raise click.exceptions.Exit(PROBLEMS)


def build_before_run(folder: Path, packages: Sequence[str]) -> None:
    """Builds what is not built yet of some packages; where that fails, Python translates."""
    from jausml.generation import native

    sources = [each for each in native.cores(folder) if each.parent.parent.name in packages]
    stale = [each for each in sources if not native.is_current(each)]
    if not stale:
        return
    program = native.compiler()
    if program is None:
        remark(MISSING)
        return
    for each in _built(stale, program):
        if each.reason:
            warn(f"{each.library.parent.name} is not compiled, Python translates: {each.reason}")


def _built(sources: Sequence[Path], program: str) -> list[Built]:
    from jausml.generation import native

    with step("compile"):
        return native.build(sources, program)
