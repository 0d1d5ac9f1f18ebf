"""`jausml import`: makes models of foreign descriptions."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from jausml.cli.choices import REPORT_FORMATS
from jausml.cli.common import PROBLEMS, find_files
from jausml.cli.import_ros import ros
from jausml.cli.imported import counted, document, say, write_document
from jausml.cli.options import format_option, quiet_option

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.importers.jsidl import ImportResult
    from jausml.language.metamodel.classes import jaus
    from jausml.language.validation.report import Report

JSIDL_SUFFIXES = (".xml", ".jsidl")
"""The endings of JSIDL files."""


@click.group("import")
def command() -> None:
    """Make models from JSIDL and from ROS interfaces."""


command.add_command(ros)


@command.command("jsidl")
@click.argument("paths", nargs=-1, required=True, metavar="PATH...")
@click.option("-o", "--output", metavar="OUT.xmi", help="Model to write.")
@click.option("--name", help="Name of the service set; by default, that of its file or URNs.")
@click.option(
    "--set-version", metavar="VERSION", help="Version of the set; by default, that of its services."
)
@click.option(
    "--compare-library",
    is_flag=True,
    help="Show where the services differ from those of the library.",
)
@click.option("--without-behaviour", is_flag=True, help="Leave out state machines.")
@click.option("--force", is_flag=True, help="Overwrite OUT.xmi if it differs.")
@format_option("Format of the findings.", REPORT_FORMATS)
@quiet_option("Print no summary.")
def jsidl(
    paths: tuple[str, ...],
    output: str | None,
    name: str | None,
    set_version: str | None,
    compare_library: bool,
    without_behaviour: bool,
    force: bool,
    output_format: str,
    quiet: bool,
) -> None:
    """Import services in JSIDL (AS5684): files, or all *.xml and *.jsidl files below folders.

    All services become one model, with a service set for each set of URNs. Inherited services may
    be in the shipped library. Reports all problems in one run; with an error, writes nothing.

    Exit status: 0 done, 1 errors in the files (--compare-library: or differences), 2 a path cannot
    be read or OUT.xmi cannot be written, 3 internal error.
    """
    from jausml.language.importers.jsidl import import_jsidl
    from jausml.language.validation.formats import RENDERERS, text
    from jausml.language.validation.formats.text import one_line

    if output is None and not compare_library:
        raise click.UsageError("name the model to write by -o OUT.xmi")
    folders = [path for path in paths if Path(path).is_dir()]
    files = find_files([path for path in paths if path not in folders], JSIDL_SUFFIXES)
    candidates = find_files(folders, JSIDL_SUFFIXES)
    result = import_jsidl(
        files,
        candidates=candidates,
        name=name,
        version=set_version,
        behaviour=not without_behaviour,
    )
    report = findings_of(result)
    click.echo(RENDERERS[output_format](report), nl=False)
    if report.has_errors:
        say(f"{text.summary(report)}; nothing written", quiet=quiet)
        raise click.exceptions.Exit(PROBLEMS)
    if len(result.sets) > 1 and (name or set_version):
        names = ", ".join(f"{each.name} {each.version}" for each in result.sets)
        raise click.UsageError(f"--name and --set-version name one set, here are several: {names}")
    if output is not None:
        data = document(result.sets, result.model, output)
        state = write_document(output, data, [*files, *candidates], force=force)
        say(f"{click.format_filename(output)}: {_summary(result)}, {state}", quiet=quiet)
    if compare_library:
        differences = list(_differences(result))
        for line in differences:
            click.echo(one_line(line))
        noun = "difference" if len(differences) == 1 else "differences"
        say(f"{len(differences)} {noun} from the library", quiet=quiet)
        if differences:
            raise click.exceptions.Exit(PROBLEMS)


def findings_of(result: ImportResult) -> Report:
    """Returns the findings of the importer; without errors, those of the rules too."""
    from jausml.language.model.reading.reader import ReadResult
    from jausml.language.validation.engine import check
    from jausml.language.validation.report import Report

    if not result.has_errors:
        return check(ReadResult(result.model, result.diagnostics))
    files = tuple(document.display for document in result.model.documents if document.given)
    return Report(result.model, files, tuple(result.diagnostics))


def _differences(result: ImportResult) -> Iterator[str]:
    """Yields the differences from the services of the library, each with its place."""
    from jausml.language.importers.jsidl.inheritance import library_model, services_by_urn
    from jausml.language.importers.jsidl.scopes import pick_version
    from jausml.language.model.comparison import ON_THE_WIRE, compare

    library = services_by_urn(library_model())
    for service in (each for root in result.sets for each in root.services):
        place = result.model.location(service)
        versions = library.get(service.urn)
        if versions is None:
            yield f"{place}: {service.name}: the library has no service {service.urn}"
            continue
        theirs = versions[pick_version(service.version, versions)]
        for each in compare(service, theirs, result.model.metamodels, ON_THE_WIRE):
            at = result.model.location(each.first_element)
            values = f"{_shown(each.first)} here, {_shown(each.second)} in the library"
            yield f"{at}: {each.path}: {each.feature}: {values}"


def _shown(value: str) -> str:
    return value.lower() if value in ("True", "False") else value


def _summary(result: ImportResult) -> str:
    services: list[jaus.Service] = [each for root in result.sets for each in root.services]
    messages = sum(len(each.inputs) + len(each.outputs) for each in services)
    counts = ((len(result.sets), "set"), (len(services), "service"), (messages, "message"))
    return counted(*counts)
