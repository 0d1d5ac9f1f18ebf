"""`jausml build`: compiles the translations of the bridges in a generated workspace."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from jausml.cli.shared.files import PROBLEMS, EnvironmentFault
from jausml.cli.shared.terminal import remark, step, warn

if TYPE_CHECKING:
    from jausml.generation.native import Built


def workspace_of(out: str) -> Path:
    """Returns the generated folder: OUT itself, or its src when OUT is the colcon workspace."""
    from jausml.generation.manifest import MANIFEST_PATH

    for folder in (Path(out), Path(out, "src")):
        if (folder / MANIFEST_PATH).is_file():
            return folder.resolve()
    name = click.format_filename(out)
    raise EnvironmentFault(
        f"{name} is no generated workspace: it has no {MANIFEST_PATH}; "
        f"'jausml generate MODEL -o {name}' makes one"
    )


NO_COMPILER = (
    "no compiler: install g++ or clang++, or name one in CXX; until then, Python translates, and a "
    "scan or path costs 20 to 100 times as much"
)


@click.command("build")
@click.argument("out", metavar="[OUT]", default=".")
def command(out: str) -> None:
    """Compile the translations of the bridges in a generated workspace, by default in this folder.

    Each bridge has the source core/core.cpp, of which a library is made beside its Python module.
    The usual message is then translated by it, a scan or path in a twentieth of the time or less;
    Python treats the others as before. A library that was made of the present source stays.
    `jausml run` builds as well, and `colcon build` does where the workspace is built with it.

    The compiler is the one that the variable CXX names, or g++ or clang++.

    Exit status: 0 every library is there, 1 one could not be built, 2 OUT is no generated
    workspace, or there is no compiler, 3 internal error.
    """
    from jausml.generation import native

    folder = workspace_of(out)
    sources = native.cores(folder)
    program = native.compiler()
    if program is None and not all(map(native.is_current, sources)):
        raise EnvironmentFault(NO_COMPILER)
    results = _built(sources, program or "")
    for result in results:
        reason = f": {result.reason}" if result.reason else ""
        click.echo(f"{result.state.value} {result.library.relative_to(folder)}{reason}")
    if not results:
        remark(f"no bridge in {click.format_filename(out)} has a compiled form")
    if any(result.reason for result in results):
        raise click.exceptions.Exit(PROBLEMS)


def build_before_run(folder: Path, packages: Sequence[str]) -> None:
    """Builds what is not built yet of some packages; where that fails, Python translates."""
    from jausml.generation import native

    sources = [core for core in native.cores(folder) if core.parent.parent.name in packages]
    stale = [source for source in sources if not native.is_current(source)]
    if not stale:
        return
    program = native.compiler()
    if program is None:
        remark(NO_COMPILER)
        return
    names = ", ".join(path.parent.parent.name for path in stale)
    remark(f"the translations of {names} are compiled, once, before anything runs")
    for result in _built(stale, program):
        if result.reason:
            warn(
                f"{result.library.parent.name} is not compiled, Python translates: {result.reason}"
            )


def _built(sources: Sequence[Path], program: str) -> list[Built]:
    from jausml.generation import native

    with step("compile"):
        return native.build(sources, program)
