"""`jausml prove`: tells what becomes of every value that goes through the maps of a model."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from jausml.cli.shared.files import PROBLEMS, EnvironmentFault, finite, made_folder, write_report
from jausml.cli.shared.models import checked, fail, model_argument, reading_options, show_findings
from jausml.cli.shared.options import FiniteRange, format_option, jobs_option, scheduler_option
from jausml.cli.shared.terminal import gathered

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.language.model import Model
    from jausml.language.model.project import Reading
    from jausml.language.validation.rule import Report
    from jausml.proving.results import MapResult
    from jausml.proving.round_trips import RoundTrip
    from jausml.proving.running import Settings

_FORMATS = ("text", "json", "sarif")


@click.command("prove")
@model_argument
@click.option("--only", "names", multiple=True, metavar="MAP", help="Prove this map. Repeatable.")
@click.option(
    "--budget",
    type=FiniteRange(min=0, min_open=True),
    default=60.0,
    metavar="SECONDS",
    help="Time for all values of numbers of 17 to 32 bits; without it, chosen ones are tried.",
)
@jobs_option
@click.option("--no-cache", is_flag=True, help="Prove what was proved before, too.")
@scheduler_option
@format_option("Format of the results.", _FORMATS)
@click.option("-o", "--output", metavar="DIR", help="Also write a page for each map into a folder.")
@reading_options
def command(
    model: str,
    names: tuple[str, ...],
    budget: float,
    jobs: int | None,
    no_cache: bool,
    scheduler: str,
    output_format: str,
    output: str | None,
    reading: Reading,
) -> None:
    """Prove the maps of a model: what becomes of every value that the wire can bring.

    Each value of a number goes through the compiled translation that the bridge runs, and back,
    from JAUS and from ROS. Numbers of up to 16 bits are tried with all values, wider ones with
    directed and random values. MODEL may also be a module of ready maps of the library, such as
    mappings.range_sensor, or mappings for all of them.

    Exit status: 0 no findings, 1 a value fails or exceeds the precision that the model states,
    2 no compiler, no such map or an unreadable model, 3 internal error.
    """
    from jausml.language.validation.formats import sarif
    from jausml.proving.results import render, with_proofs
    from jausml.proving.running import Settings, processors

    ready = [] if Path(model).exists() else _ready(model)
    report = checked(ready or [model], reading, is_one=not ready)
    if report.has_errors:
        show_findings(report)
        fail(report, "nothing proved")
    maps = _wanted(report.model, names)
    settings = Settings("", budget, jobs or processors(), is_cached=not no_cache)
    results = _proved(report.model, maps, settings, scheduler)
    judged = with_proofs(report, maps, results)
    if output_format == "sarif":
        write_report(sarif.render(judged), None)
    elif output_format == "json":
        write_report(_json(results, judged), None)
    else:
        write_report(f"{render(results)}\n", None)
    if output_format != "sarif":
        show_findings(judged)
    if output is not None:
        _write_pages(results, judged, Path(output))
    failed = next((each for each in results if each.error), None)
    if failed is not None:
        raise EnvironmentFault(f"{failed.name}: {failed.error}")
    if judged.has_errors:
        raise click.exceptions.Exit(PROBLEMS)


def _ready(name: str) -> list[str]:
    """Returns the files of ready maps that a module is, or that lie in it."""
    from jausml.language.model.library import library_paths, module_of

    modules = {str(path): module_of(path) for path in library_paths("mappings")}
    return [path for path, each in modules.items() if f"{each}.".startswith(f"{name}.")]


def _proved(
    model: Model, trips: Sequence[RoundTrip], settings: Settings, scheduler: str
) -> list[MapResult]:
    """Returns the results of maps, in their order."""
    from jausml.language.model.xmi.writer import UnwritableError
    from jausml.live.workers.pool_processes import PoolError
    from jausml.proving.running import program, prove_all

    try:
        if not scheduler:
            settings = replace(settings, program=program())
        return gathered("proving", len(trips), prove_all(model, trips, settings, scheduler))
    except (PoolError, UnwritableError) as error:
        raise EnvironmentFault(str(error)) from error


def _write_pages(results: Sequence[MapResult], judged: Report, folder: Path) -> None:
    from jausml.proving.results import by_map
    from jausml.proving.summary import pages

    made_folder(folder)
    for name, page in pages(results, by_map(judged)):
        write_report(page, str(folder / name))


def _json(results: Sequence[MapResult], judged: Report) -> str:
    import json

    from jausml.language.model.model import digests
    from jausml.proving.results import by_map

    short = by_map(judged)
    maps = [finite(each.to_json()) | {"found": short.get(each.name, [])} for each in results]
    found = {"digests": digests(judged.model), "maps": maps}
    return json.dumps(found, indent=2, allow_nan=False) + "\n"


def _wanted(model: Model, names: tuple[str, ...]) -> list[RoundTrip]:
    """Returns the maps of a model and those that its bridges use, or those that are named."""
    from jausml.proving.round_trips import round_trips

    found = round_trips(model)
    known = dict.fromkeys(each.name for each in found)
    for name in names:
        if name not in known:
            there = ", ".join(known) or "none"
            raise EnvironmentFault(f"there is no map '{name}'; there are {there}")
    if not found:
        raise EnvironmentFault("the model has no maps")
    return [each for each in found if not names or each.name in names]
