"""`jausml case`: makes the safety case of a model, and keeps one that is checked in."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from jausml.cli.shared.files import EnvironmentFault, ending_at, write_report, writing
from jausml.cli.shared.models import checked, fail, model_argument, reading_options, show_findings
from jausml.cli.shared.options import format_option
from jausml.cli.shared.terminal import step

if TYPE_CHECKING:
    from jausml.language.model import Diagnostic
    from jausml.language.model.project import Reading
    from jausml.language.validation.rule import Report
    from jausml.safety_case.argument import SafetyCase
    from jausml.safety_case.comparing import Former
    from jausml.safety_case.evidence import Evidence

_FORMATS = ("html", "json")
_PLAIN, _DOCUMENT = "case.json", "case.html"


@click.command("case")
@model_argument
@click.option("-o", "--output", metavar="DIR", help="Write the case, with pictures, into a folder.")
@click.option(
    "--evidence",
    "files",
    multiple=True,
    metavar="FILE",
    help="Results in JSON of prove, model-check or mutate, of fault runs, or a JUnit report of the "
    "generated tests; by default, those of the case in the folder. Repeatable.",
)
@click.option("--check", is_flag=True, help="Write nothing; fail if the case in the folder fails.")
@format_option("Format of the case where no folder is named.", _FORMATS)
@reading_options
def command(
    model: str,
    output: str | None,
    files: tuple[str, ...],
    check: bool,
    output_format: str,
    reading: Reading,
) -> None:
    """Make the safety case of MODEL: hazards, what the model does about each, and evidence.

    What nothing answers, and evidence that is missing, is named. A person decides whether that is
    enough: the document has fields to sign or refuse each goal.

    Exit status: 0 done, 1 errors in the model, or a case that fails --check, 2 usage, environment
    or evidence that cannot be read, 3 internal error.
    """
    from jausml.safety_case.argument import to_plain
    from jausml.safety_case.comparing import findings

    if check and (output is None or files):
        raise click.UsageError("--check takes -o DIR, and the evidence that the case there names")
    folder = Path(output or ".")
    former = _former(folder) if check or (output and (folder / _PLAIN).exists()) else None
    links = [os.path.relpath(Path(path), folder).replace(os.sep, "/") for path in files]
    report = _readable(model, reading)
    named = links or (former.evidence if former else ())
    evidence, unread = _evidence(report, folder, named)
    if unread and not check:
        file, reason = next(iter(unread.items()))
        raise EnvironmentFault(f"{click.format_filename(os.path.normpath(folder / file))} {reason}")
    case = _case(report, evidence)
    if check and former:
        lost = findings(former, case, unread)
        report = replace(report, diagnostics=tuple(sorted([*_errors(report), *lost])))
    elif output is not None:
        _write(case, folder)
    else:
        plain = json.dumps(to_plain(case), indent=2) + "\n"
        write_report(plain if output_format == "json" else _drawn(case)[_DOCUMENT], None)
    if report.has_errors:
        show_findings(report)
        fail(report)


def _readable(path: str, reading: Reading) -> Report:
    """Returns the report on a model that could be read; rules may find errors in it."""
    from jausml.language.validation.rules import all_rules

    report = checked([path], reading, is_one=True)
    rules = {rule.id for rule in all_rules()}
    if any(error.rule not in rules for error in _errors(report)):
        show_findings(report)
        fail(report, "no case made")
    return report


def _errors(report: Report) -> list[Diagnostic]:
    from jausml.language.model import Severity

    return [error for error in report.diagnostics if error.severity is Severity.ERROR]


def _evidence(
    report: Report, folder: Path, links: Iterable[str]
) -> tuple[list[Evidence], dict[str, str]]:
    """Returns the evidence in files, named from a folder on, and why some cannot be read."""
    from jausml.language.model.model import digests
    from jausml.safety_case.evidence import EvidenceError, read_evidence

    known, evidence, unread = digests(report.model).values(), [], {}
    for number, link in enumerate(dict.fromkeys(links), start=1):
        try:
            # The folder may not be there yet.
            file = Path(os.path.normpath(folder / link))
            evidence.append(read_evidence(file, link, number, known))
        except EvidenceError as error:
            unread[link] = str(error)
    return evidence, unread


def _case(report: Report, evidence: Sequence[Evidence]) -> SafetyCase:
    """Returns the case of a model, with evidence and its generated tests."""
    from jausml.generation.errors import GenerationError
    from jausml.safety_case.argument import safety_case
    from jausml.safety_case.evidence import EvidenceError, generated_tests

    try:
        with step("rendering tests"):
            tests = [] if report.has_errors else generated_tests(report.model)
    except GenerationError:
        tests = []
    with ending_at(EvidenceError):
        return safety_case(report, evidence, tests)


def _former(folder: Path) -> Former:
    """Returns the case that a folder has; ends the verb if there is none that can be read."""
    from jausml.language.model.files import read_input
    from jausml.safety_case.comparing import CaseError, former_case

    path = folder / _PLAIN
    try:
        return former_case(str(path), read_input(path))
    except (OSError, CaseError) as error:
        reason = f"cannot be read: {error.strerror}" if isinstance(error, OSError) else error
        raise EnvironmentFault(f"{click.format_filename(path)} {reason}") from error


def _drawn(case: SafetyCase) -> dict[str, str]:
    """Returns the document and the pictures of a case, by file."""
    from jausml.safety_case.page import render
    from jausml.safety_case.pictures import pictures
    from jausml.views.diagrams.layout.sheet import LayoutError

    with ending_at(LayoutError), step("drawing"):
        drawings = pictures(case)
    return {_DOCUMENT: render(case, drawings)} | {
        f"{name}.svg": drawing for name, drawing in drawings.items()
    }


def _write(case: SafetyCase, folder: Path) -> None:
    """Writes a case; a document that somebody has filled in stays."""
    from jausml.language.model.files import read_input
    from jausml.safety_case.argument import to_plain
    from jausml.safety_case.page import is_untouched

    path = folder / _DOCUMENT
    shown = click.format_filename(path)
    with writing(path):
        folder.mkdir(parents=True, exist_ok=True)
        is_ours = not path.exists() or is_untouched(read_input(path).decode("utf-8", "replace"))
    if not is_ours:
        raise EnvironmentFault(f"{shown} has been changed by hand: move it away to keep it")
    plain = json.dumps(to_plain(case), indent=2) + "\n"
    for name, text in (_drawn(case) | {_PLAIN: plain}).items():
        write_report(text, str(folder / name))
    click.echo(f"{shown}: {case.summary}", err=True)
