"""`jausml prove`: tells what becomes of every value that goes through the maps of a model."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jausml.cli.shared.files import PROBLEMS, EnvironmentFault, write_report
from jausml.cli.shared.models import checked, fail, model_argument, reading_options, show_findings
from jausml.cli.shared.options import FiniteRange, format_option
from jausml.cli.shared.terminal import step

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.language.model import Model
    from jausml.language.project.reading import Reading
    from jausml.language.validation.report import Report
    from jausml.proving.proof_bridge import RoundTrip
    from jausml.proving.results import MapResult
    from jausml.proving.running import Settings

_FORMATS = ("text", "json", "sarif")


@click.command("prove")
@model_argument
@click.option("--only", "names", multiple=True, metavar="MAP", help="Prove this map. Repeatable.")
@click.option(
    "--budget",
    type=FiniteRange(min=0, min_open=True),
    default=60.0,
    show_default=True,
    metavar="SECONDS",
    help="Time for all values of numbers of 17 to 32 bits; without it, chosen ones are tried.",
)
@click.option(
    "--jobs",
    type=click.IntRange(min=1),
    metavar="N",
    help="Processors that work at once; by default, one for each processor.",
)
@click.option("--no-cache", is_flag=True, help="Prove what was proved before, too.")
@format_option("Format of the results.", _FORMATS)
@click.option("-o", "--output", metavar="DIR", help="Also write a page for each map into a folder.")
@reading_options
def command(
    model: str,
    names: tuple[str, ...],
    budget: float,
    jobs: int | None,
    no_cache: bool,
    output_format: str,
    output: str | None,
    reading: Reading,
) -> None:
    """Prove the maps of a model: what becomes of every value that the wire can bring.

    Each value of a number goes through the compiled translation that the bridge runs, and back,
    from JAUS and from ROS. Numbers of up to 16 bits are tried with all values, wider ones with
    directed and random values.

    Exit status: 0 no findings, 1 a value fails or exceeds the precision that the model states,
    2 no compiler, no such map or an unreadable model, 3 internal error.
    """
    from jausml.generation import native
    from jausml.language.validation.formats import sarif
    from jausml.proving import text
    from jausml.proving.findings import with_proofs
    from jausml.proving.running import Settings, processors

    report = checked([model], reading, is_one=True)
    if report.has_errors:
        show_findings(report)
        fail(report, "nothing proved")
    maps = _wanted(report.model, names)
    program = native.compiler()
    if program is None:
        wanted = " or ".join(native.COMPILERS)
        raise EnvironmentFault(f"there is no C++ compiler: install {wanted}, or name one by CXX")
    settings = Settings(program, budget, jobs or processors(), is_cached=not no_cache)
    results = _proved(report.model, maps, settings)
    judged = with_proofs(report, maps, results)
    if output_format == "sarif":
        write_report(sarif.render(judged), None)
    elif output_format == "json":
        write_report(_json(results, judged), None)
    else:
        write_report(f"{text.render(results)}\n", None)
    if output_format != "sarif":
        show_findings(judged)
    if output is not None:
        _write_pages(results, judged, Path(output))
    if judged.has_errors:
        raise click.exceptions.Exit(PROBLEMS)


def _proved(model: Model, maps: Sequence[RoundTrip], settings: Settings) -> list[MapResult]:
    """Returns the results of maps.

    Raises:
        EnvironmentFault: The compiler or a process of the proof has failed.
    """
    from jausml.live.workers.worker import WorkerError
    from jausml.proving.compiled_form import ProgramError
    from jausml.proving.running import prove

    results: list[MapResult] = []
    try:
        with step("proving") as progress:
            progress.note = lambda: maps[min(len(results), len(maps) - 1)].name
            for each in prove(model, maps, settings):
                results.append(each)
                progress.at(len(results) / len(maps))
    except (ProgramError, WorkerError) as error:
        raise EnvironmentFault(f"{maps[len(results)].name}: {error}") from error
    return results


def _write_pages(results: Sequence[MapResult], judged: Report, folder: Path) -> None:
    from jausml.proving.findings import by_map
    from jausml.proving.pages import pages

    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        name = click.format_filename(folder)
        raise EnvironmentFault(f"cannot write {name}: {error.strerror}") from error
    for name, page in pages(results, by_map(judged)):
        write_report(page, str(folder / name))


def _json(results: Sequence[MapResult], judged: Report) -> str:
    import json

    from jausml.language.model.digests import digests
    from jausml.proving.findings import by_map

    short = by_map(judged)
    maps = [_finite(each.to_json()) | {"found": short.get(each.name, [])} for each in results]
    found = {"digests": digests(judged.model), "maps": maps}
    return json.dumps(found, indent=2, allow_nan=False) + "\n"


def _finite(value: Any) -> Any:
    """Returns JSON in which numbers that are not finite, for which it has none, are texts."""
    if isinstance(value, dict):
        return {name: _finite(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(each) for each in value]
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value


def _wanted(model: Model, names: tuple[str, ...]) -> list[RoundTrip]:
    """Returns the maps of a model and those that its bridges use, or those that are named.

    Raises:
        EnvironmentFault: There are none, or none of a name.
    """
    from jausml.proving.proof_bridge import round_trips

    found = round_trips(model)
    known = dict.fromkeys(each.name for each in found)
    for name in names:
        if name not in known:
            there = ", ".join(known) or "none"
            raise EnvironmentFault(f"there is no map '{name}'; there are {there}")
    if not found:
        raise EnvironmentFault("the model has no maps")
    return [each for each in found if not names or each.name in names]
