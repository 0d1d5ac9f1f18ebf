"""`jausml mutate`: breaks a model, one thing at a time, and tells what notices it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from jausml.cli.shared.files import PROBLEMS, EnvironmentFault, made_folder, write_report
from jausml.cli.shared.models import model_argument, reading_options, valid_model
from jausml.cli.shared.options import FiniteRange, format_option, jobs_option, scheduler_option
from jausml.cli.shared.terminal import gathered

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.language.model import Model
    from jausml.language.model.project import Reading
    from jausml.language.project import OneDocument
    from jausml.mutating.outcomes import Campaign
    from jausml.mutating.running import Settings


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
@scheduler_option
@format_option("Format of the results.")
@click.option("-o", "--output", metavar="DIR", help="Also write a page into a folder.")
@reading_options
def command(
    model: str,
    names: tuple[str, ...],
    limit: int,
    budget: float,
    jobs: int | None,
    run: str | None,
    scheduler: str,
    output_format: str,
    output: str | None,
    reading: Reading,
) -> None:
    """Break a model, one thing at a time, and tell what notices it.

    Each mutation changes one thing: a sign, a factor, a rate, a time-out, a stop. It is noticed
    if a rule finds an error, if a generated test of the unbroken model fails on the code of the
    broken one, if a proof of its map finds a fault, if a product check finds a violation, or if a
    command of yours fails. What nothing notices is listed.

    Exit status: 0 all is noticed, 1 something survives or the model has errors, 2 no such
    operator, nothing to break or an unreadable model, 3 internal error.
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
    settings = Settings(names, budget, jobs or processors(), tuple(_arguments(run)), scheduler)
    _run(campaign, document, chosen, settings)
    if output_format == "json":
        found = {"digests": digests(broken), **campaign.to_json()}
        write_report(json.dumps(found, indent=2) + "\n", None)
    else:
        write_report(f"{render(campaign)}\n", None)
    if output is not None:
        _write_page(page(campaign), Path(output))
    if campaign.survivors():
        raise click.exceptions.Exit(PROBLEMS)


def _arguments(command: str | None) -> list[str]:
    import shlex
    import shutil

    try:
        found = shlex.split(command or "")
    except ValueError as error:
        raise EnvironmentFault(f"--run: {error}") from error
    if found and shutil.which(found[0]) is None:
        raise EnvironmentFault(f"--run: there is no program '{found[0]}'")
    return found


def _check_names(names: Sequence[str]) -> None:
    from jausml.mutating.operators import OPERATORS

    known = [each.name for each in OPERATORS]
    for name in names:
        if name not in known:
            raise EnvironmentFault(f"there is no operator '{name}'; there are {', '.join(known)}")


def _document(model: Model) -> OneDocument:
    from jausml.language.model.xmi.writer import UnwritableError
    from jausml.language.project import one_document

    try:
        return one_document(model)
    except UnwritableError as error:
        raise EnvironmentFault(str(error)) from error


def _run(
    campaign: Campaign, document: OneDocument, chosen: Sequence[int], settings: Settings
) -> None:
    """Fills a campaign with what becomes of mutations, in their order."""
    from jausml.live.workers.pool_processes import PoolError
    from jausml.mutating.running import CampaignError, outcomes

    try:
        found = gathered("mutating", len(chosen), outcomes(document, chosen, settings))
    except (CampaignError, PoolError) as error:
        raise EnvironmentFault(str(error)) from error
    campaign.remarks = list(dict.fromkeys(remark for each in found for remark in each.remarks))
    campaign.outcomes = [each.outcome for each in found if each.outcome is not None]


def _write_page(text: str, folder: Path) -> None:
    made_folder(folder)
    write_report(text, str(folder / "index.html"))
