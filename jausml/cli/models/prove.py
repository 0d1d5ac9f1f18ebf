"""`jausml prove` and `jausml mutate`: what becomes of all values, and what notices a mistake."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from jausml.cli.shared.files import (
    PROBLEMS,
    EnvironmentFault,
    ending_at,
    finite,
    made_folder,
    write_report,
)
from jausml.cli.shared.models import (
    checked,
    fail,
    model_argument,
    reading_options,
    show_findings,
    valid_model,
)
from jausml.cli.shared.options import FiniteRange, format_option, jobs_option
from jausml.cli.shared.terminal import gathered

if TYPE_CHECKING:
    from jausml.language.model import Model
    from jausml.language.model.project import Reading
    from jausml.language.project import OneDocument
    from jausml.language.validation.rule import Report
    from jausml.mutating import running
    from jausml.mutating.outcomes import Campaign
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
@format_option("Format of the results.", _FORMATS)
@click.option("-o", "--output", metavar="DIR", help="Also write a page for each map into a folder.")
@reading_options
def command(
    model: str,
    names: tuple[str, ...],
    budget: float,
    jobs: int | None,
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
    settings = Settings("", budget, jobs or processors())
    results = _proved(report.model, maps, settings)
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
    failed = next((result for result in results if result.error), None)
    if failed is not None:
        raise EnvironmentFault(f"{failed.name}: {failed.error}")
    if judged.has_errors:
        raise click.exceptions.Exit(PROBLEMS)


def _ready(name: str) -> list[str]:
    """Returns the files of ready maps that a module is, or that lie in it."""
    from jausml.language.model.library import library_paths, module_of

    modules = {str(path): module_of(path) for path in library_paths("mappings")}
    return [path for path, module in modules.items() if f"{module}.".startswith(f"{name}.")]


def _proved(model: Model, trips: Sequence[RoundTrip], settings: Settings) -> list[MapResult]:
    """Returns the results of maps, in their order."""
    from jausml.language.model.xmi.printing import UnwritableError
    from jausml.live.workers.pool import PoolError
    from jausml.proving.running import program, prove_all

    with ending_at(PoolError, UnwritableError):
        settings = replace(settings, program=program())
        return gathered("proving", len(trips), prove_all(model, trips, settings))


def _write_pages(results: Sequence[MapResult], judged: Report, folder: Path) -> None:
    from jausml.proving.html_pages import pages
    from jausml.proving.results import by_map

    made_folder(folder)
    for name, page in pages(results, by_map(judged)):
        write_report(page, str(folder / name))


def _json(results: Sequence[MapResult], judged: Report) -> str:
    import json

    from jausml.language.model.model import digests
    from jausml.proving.results import by_map

    short = by_map(judged)
    maps = [finite(result.to_json()) | {"found": short.get(result.name, [])} for result in results]
    content = {"digests": digests(judged.model), "maps": maps}
    return json.dumps(content, indent=2, allow_nan=False) + "\n"


def _wanted(model: Model, names: tuple[str, ...]) -> list[RoundTrip]:
    """Returns the maps of a model and of its bridges, or the named ones."""
    from jausml.proving.round_trips import round_trips

    trips = round_trips(model)
    known = dict.fromkeys(round_trip.name for round_trip in trips)
    for name in names:
        if name not in known:
            there = ", ".join(known) or "none"
            raise EnvironmentFault(f"there is no map '{name}'; there are {there}")
    if not trips:
        raise EnvironmentFault("the model has no maps")
    return [round_trip for round_trip in trips if not names or round_trip.name in names]


@click.command("mutate")
@model_argument
@click.option(
    "--only", "names", multiple=True, metavar="OPERATOR", help="Use this operator. Repeatable."
)
@click.option(
    "--limit",
    type=click.IntRange(min=1),
    default=1000,
    metavar="N",
    help="Most mutations; of more, a sample that is spread over the operators.",
)
@click.option(
    "--budget",
    type=FiniteRange(min=0, min_open=True),
    default=600.0,
    metavar="SECONDS",
    help="Time after which no further mutation is begun.",
)
@jobs_option
@click.option(
    "--run",
    "run",
    metavar="COMMAND",
    help="Also try the packages by this command, which fails for a mutation. PYTHONPATH leads "
    "to the packages, JAUSML_WORKSPACE names their folder.",
)
@format_option("Format of the results.")
@click.option("-o", "--output", metavar="DIR", help="Also write a page into a folder.")
@reading_options
def mutate(
    model: str,
    names: tuple[str, ...],
    limit: int,
    budget: float,
    jobs: int | None,
    run: str | None,
    output_format: str,
    output: str | None,
    reading: Reading,
) -> None:
    """Break a model, one thing at a time, and tell what notices it.

    Each mutation changes one thing: a sign, a factor, a rate, a time-out, a stop. It is noticed
    if a rule finds an error, if a generated test of the unbroken model fails on the code of the
    broken one, if a proof of its map finds a fault, if a product check finds a violation, or if a
    command of yours fails. What nothing notices is listed.

    Exit status: 0 all is noticed, 1 something survives, the time was over before all were tried, or
    the model has errors, 2 no such operator, nothing to break or an unreadable model, 3 internal
    error.
    """
    import json

    from jausml.language.model.model import digests
    from jausml.mutating.outcomes import Campaign, page, render
    from jausml.mutating.running import Settings, mutations, sample
    from jausml.proving.running import processors

    _check_names(names)
    broken = valid_model(model, reading, outcome="nothing broken")
    document = _document(broken)
    possible = mutations(document.read().model, names)
    if not possible:
        raise EnvironmentFault("the model has nothing that these operators change")
    chosen = sample(possible, limit)
    campaign = Campaign(Path(model).name, len(possible), len(chosen))
    settings = Settings(names, budget, jobs or processors(), tuple(_arguments(run)))
    _run(campaign, document, chosen, settings)
    if output_format == "json":
        content = {"digests": digests(broken), **campaign.to_json()}
        write_report(json.dumps(content, indent=2) + "\n", None)
    else:
        write_report(f"{render(campaign)}\n", None)
    if output is not None:
        made_folder(Path(output))
        write_report(page(campaign), str(Path(output, "index.html")))
    if campaign.survivors() or len(campaign.outcomes) < campaign.chosen:
        raise click.exceptions.Exit(PROBLEMS)


def _arguments(command: str | None) -> list[str]:
    import shlex
    import shutil

    with ending_at(ValueError, about="--run: "):
        words = shlex.split(command or "")
    if words and shutil.which(words[0]) is None:
        raise EnvironmentFault(f"--run: there is no program '{words[0]}'")
    return words


def _check_names(names: Sequence[str]) -> None:
    from jausml.mutating.operators import OPERATORS

    known = [operator.name for operator in OPERATORS]
    for name in names:
        if name not in known:
            raise EnvironmentFault(f"there is no operator '{name}'; there are {', '.join(known)}")


def _document(model: Model) -> OneDocument:
    from jausml.language.model.xmi.printing import UnwritableError
    from jausml.language.project import one_document

    with ending_at(UnwritableError):
        return one_document(model)


def _run(
    campaign: Campaign, document: OneDocument, chosen: Sequence[int], settings: running.Settings
) -> None:
    """Fills a campaign with what becomes of mutations, in their order."""
    from jausml.live.workers.pool import PoolError
    from jausml.mutating.running import CampaignError, outcomes

    with ending_at(CampaignError, PoolError):
        trials = gathered("mutating", len(chosen), outcomes(document, chosen, settings))
    campaign.remarks = list(dict.fromkeys(remark for trial in trials for remark in trial.remarks))
    campaign.outcomes = [trial.outcome for trial in trials if trial.outcome is not None]
