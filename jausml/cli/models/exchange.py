"""`jausml import` and `jausml export`: models of JSIDL and ROS interfaces, and JSIDL of models."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jausml.cli.shared.files import (
    PROBLEMS,
    EnvironmentFault,
    counted,
    document,
    ending_at,
    find_files,
    made_folder,
    say,
    write_document,
)
from jausml.cli.shared.models import model_argument, reading_options, valid_model
from jausml.cli.shared.options import REPORT_FORMATS, format_option, quiet_option

if TYPE_CHECKING:
    from jausml.language.importers import jsidl as jsidl_importer
    from jausml.language.importers import ros as ros_importer
    from jausml.language.importers.ros import PackageSource
    from jausml.language.interfaces import Installation
    from jausml.language.metamodel.classes import jaus
    from jausml.language.metamodel.classes.ros import InterfacePackage
    from jausml.language.model.model import Model
    from jausml.language.model.project import Reading
    from jausml.language.validation.rule import Report

JSIDL_SUFFIXES = (".xml", ".jsidl")
"""The endings of JSIDL files."""


@click.group("import")
def imports() -> None:
    """Make models from JSIDL and from ROS interfaces."""


@imports.command("jsidl")
@click.argument("paths", nargs=-1, required=True, metavar="PATH...")
@click.option(
    "-o",
    "--output",
    metavar="OUT.xmi",
    help="Model to write, or the folder of one with the set's name.",
)
@click.option("--name", help="Name of the service set; by default, that of its file or URNs.")
@click.option(
    "--set-version", metavar="VERSION", help="Version of the set; by default, that of its services."
)
@click.option(
    "--compare-library",
    is_flag=True,
    help="Show where the services differ from those of the library; on stderr if --format is not "
    "text.",
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
    from jausml.language.validation.formats.text import one_line

    if output is None and not compare_library:
        raise click.UsageError("name the model to write by -o OUT.xmi")
    result, files = read_jsidl(
        paths, name=name, version=set_version, behaviour=not without_behaviour
    )
    report = findings_of(result)
    _show(report, output_format, quiet=quiet)
    if len(result.sets) > 1 and (name or set_version):
        names = ", ".join(f"{services.name} {services.version}" for services in result.sets)
        raise click.UsageError(f"--name and --set-version name one set, here are several: {names}")
    if output is not None:
        if _is_folder(output):
            output = str(made_folder(Path(output)) / f"{result.sets[0].name}.xmi")
        data = document(result.sets, result.model, output)
        state = write_document(output, data, files, force=force)
        say(f"{click.format_filename(output)}: {_summary(result)}, {state}", quiet=quiet)
    if compare_library:
        differences = list(_differences(result))
        for line in differences:
            click.echo(one_line(line), err=output_format != "text")
        noun = "difference" if len(differences) == 1 else "differences"
        say(f"{len(differences)} {noun} from the library", quiet=quiet)
        if differences:
            raise click.exceptions.Exit(PROBLEMS)


def read_jsidl(paths: Sequence[str], **how: Any) -> tuple[jsidl_importer.ImportResult, list[str]]:
    """Returns the import of files and folders, and all files that were looked at."""
    from jausml.language.importers.jsidl import import_jsidl

    folders = [path for path in paths if Path(path).is_dir()]
    files = find_files([path for path in paths if path not in folders], JSIDL_SUFFIXES)
    candidates = find_files(folders, JSIDL_SUFFIXES)
    return import_jsidl(files, candidates=candidates, **how), [*files, *candidates]


def _show(report: Report, output_format: str, *, quiet: bool) -> None:
    """Shows a report, and ends the verb where it has errors."""
    from jausml.language.validation.formats import RENDERERS, text

    click.echo(RENDERERS[output_format](report), nl=False)
    if report.has_errors:
        say(f"{text.summary(report)}; nothing written", quiet=quiet)
        raise click.exceptions.Exit(PROBLEMS)


def findings_of(result: jsidl_importer.ImportResult | ros_importer.ImportResult) -> Report:
    """Returns the findings of the importer; without errors, those of the rules too."""
    from jausml.language.model.reading.reader import ReadResult
    from jausml.language.validation.engine import check
    from jausml.language.validation.rule import Report

    if not result.has_errors:
        return check(ReadResult(result.model, result.diagnostics))
    files = tuple(document.display for document in result.model.documents if document.is_input)
    return Report(result.model, files, tuple(result.diagnostics))


def _differences(result: jsidl_importer.ImportResult) -> Iterator[str]:
    """Yields the differences from the services of the library, each with its place."""
    from jausml.language.importers.jsidl.scopes import pick_version
    from jausml.language.importers.jsidl.services import services_by_urn
    from jausml.language.model.comparison import ON_THE_WIRE, compare
    from jausml.language.project import library

    shipped = services_by_urn(library("jaus"))
    for service in (imported_service for root in result.sets for imported_service in root.services):
        place = result.model.location(service)
        versions = shipped.get(service.urn)
        if versions is None:
            yield f"{place}: {service.name}: the library has no service {service.urn}"
            continue
        theirs = versions[pick_version(service.version, versions)]
        for difference in compare(service, theirs, result.model.metamodels, ON_THE_WIRE):
            at = result.model.location(difference.first_element)
            values = f"{_shown(difference.first)} here, {_shown(difference.second)} in the library"
            yield f"{at}: {difference.path}: {difference.feature}: {values}"


def _shown(value: str) -> str:
    return value.lower() if value in ("True", "False") else value


def _summary(result: jsidl_importer.ImportResult) -> str:
    services: list[jaus.Service] = [service for root in result.sets for service in root.services]
    messages = sum(len(service.inputs) + len(service.outputs) for service in services)
    counts = ((len(result.sets), "set"), (len(services), "service"), (messages, "message"))
    return counted(*counts)


@imports.command("ros")
@click.argument("packages", nargs=-1, required=True, metavar="PACKAGE...")
@click.option(
    "-o",
    "--output",
    metavar="OUT.xmi",
    help="Model to write, by default <package>.xmi; or a folder (DIR/) for one model per package.",
)
@click.option(
    "--share",
    "shares",
    multiple=True,
    metavar="DIR",
    type=click.Path(exists=True, file_okay=False),
    help="Share folder of installed packages, searched before the others.",
)
@click.option("--without-comments", is_flag=True, help="Leave out comments and their units.")
@click.option("--force", is_flag=True, help="Overwrite files that differ.")
@format_option("Format of the findings.", REPORT_FORMATS)
@quiet_option("Print no summary.")
def ros(
    packages: tuple[str, ...],
    output: str | None,
    shares: tuple[str, ...],
    without_comments: bool,
    force: bool,
    output_format: str,
    quiet: bool,
) -> None:
    """Import ROS 2 interfaces: installed packages by name, definition files, folders.

    Definition files are .msg, .srv, .action and .idl files. Searches for installed packages in the
    prefixes of AMENT_PREFIX_PATH and in the running Python. Message types of other packages come
    from the shipped library; packages that it lacks are imported too. Comments become
    documentation. Reports all problems in one run; with an error, writes nothing.

    Exit status: 0 done, 1 errors in the files, 2 a package is not installed, a path cannot be read
    or a file cannot be written, 3 internal error.
    """
    from jausml.language.importers.ros import import_packages
    from jausml.language.interfaces import Installation

    installation = Installation(shares)
    sources = _sources(packages, installation)
    result = import_packages(sources, installation=installation, comments=not without_comments)
    report = findings_of(result)
    _show(report, output_format, quiet=quiet)
    inputs = [file.path for source in sources for file in source.files]
    for path, roots, data in _documents(result, output):
        state = write_document(path, data, inputs, force=force)
        say(f"{click.format_filename(path)}: {_summary_of_packages(roots)}, {state}", quiet=quiet)


def _sources(words: tuple[str, ...], installation: Installation) -> list[PackageSource]:
    """Returns the packages that are meant: by their names, or by paths."""
    from jausml.language.importers.ros import PackageSource, installed_source
    from jausml.language.interfaces.definitions import is_package_name

    sources: dict[str, PackageSource] = {}
    for word in words:
        folder = installation.folder(word) if is_package_name(word) else None
        matches = (
            [installed_source(word, folder)] if folder is not None else _at(word, installation)
        )
        for source in matches:
            known = sources.setdefault(source.name, PackageSource(source.name))
            paths = {os.path.realpath(file.path) for file in known.files}
            known.files += [
                file for file in source.files if os.path.realpath(file.path) not in paths
            ]
    return list(sources.values())


def _at(path: str, installation: Installation) -> list[PackageSource]:
    from jausml.language.importers.ros import package_sources
    from jausml.language.importers.ros.definitions import SUFFIXES
    from jausml.language.model.files import open_input
    from jausml.language.model.values import suggest

    shown = click.format_filename(path)
    place = Path(path)
    with ending_at(OSError, ValueError, about=f"{shown}: "):
        if place.is_dir():
            sources = package_sources([path])
            if not sources:
                raise EnvironmentFault(f"no {' or '.join(SUFFIXES)} files in {shown}")
            return sources
        if place.suffix in SUFFIXES:
            with open_input(place):
                return package_sources([path])
        if place.exists():
            raise EnvironmentFault(f"{shown} is no {', '.join(SUFFIXES)} file")
    hint = suggest(path, installation.packages())
    shares = ", ".join(str(share) for share in installation.shares if share.is_dir()) or "none"
    message = f"no package {path!r} is installed (share folders: {shares})"
    raise EnvironmentFault(f"{message}; {hint}" if hint else message)


def _documents(
    result: ros_importer.ImportResult, output: str | None
) -> list[tuple[str, list[InterfacePackage], bytes]]:
    """Returns the files to be written, each with its packages and its bytes."""
    from jausml.language.importers.ros import placed

    output = output or f"{result.packages[0].name}.xmi"
    if _is_folder(output):
        places = {Path(output, f"{package.name}.xmi"): [package] for package in result.packages}
    else:
        places = {Path(output): result.packages}
    model = placed(result, places)
    documents = [
        (str(path), roots, document(roots, model, str(path))) for path, roots in places.items()
    ]
    for path in places:
        made_folder(path.parent)
    return documents


def _is_folder(output: str) -> bool:
    return output.endswith(os.sep) or Path(output).is_dir()


def _summary_of_packages(packages: list[InterfacePackage]) -> str:
    return counted(
        (len(packages), "package"),
        (sum(len(package.messages) for package in packages), "message"),
        (sum(len(package.services) for package in packages), "service"),
        (sum(len(package.actions) for package in packages), "action"),
    )


@click.group("export")
def exports() -> None:
    """Write services as JSIDL."""


@exports.command("jsidl")
@model_argument
@click.option(
    "-o", "--output", required=True, metavar="DIR", help="Folder of the files, one per service."
)
@click.option("--with-inherited", is_flag=True, help="Write the services that they inherit, too.")
@click.option("--force", is_flag=True, help="Overwrite files that differ.")
@reading_options
@format_option("Format of the findings.", REPORT_FORMATS)
@quiet_option("Print no summary.")
def to_jsidl(
    model: str,
    output: str,
    with_inherited: bool,
    force: bool,
    reading: Reading,
    output_format: str,
    quiet: bool,
) -> None:
    """Export the services of MODEL as JSIDL 1.1 (AS5684).

    These are the services of its service sets, and those that its components provide, of the
    library too. An import of the files gives the same services; what JSIDL cannot say is a finding.

    Exit status: 0 done, 1 errors in the model or a service that is no JSIDL, 2 a path cannot be
    read or written, 3 internal error.
    """
    from jausml.language.exporters.jsidl import JSIDL_EXPORT_RULES, export_jsidl
    from jausml.language.semantics.jaus import inheritance
    from jausml.language.validation.rule import Report

    read = valid_model(model, reading, outcome="nothing written")
    chosen = _services(read)
    if not chosen:
        raise EnvironmentFault(f"{click.format_filename(model)} has no services")
    result = export_jsidl(read, inheritance.with_inherited(chosen) if with_inherited else chosen)
    report = Report(read, (model,), tuple(result.diagnostics), rules=JSIDL_EXPORT_RULES)
    _show(report, output_format, quiet=quiet)
    folder = made_folder(Path(output))
    states = [
        write_document(str(folder / name), data, (), force=force)
        for name, data in result.documents.items()
    ]
    counts = ", ".join(f"{number} {state}" for state, number in Counter(states).items())
    summary = f"{counted((len(states), 'service'))}, {counts}"
    say(f"{click.format_filename(output)}: {summary}", quiet=quiet)


def _services(model: Model) -> list[jaus.Service]:
    """Returns the services of the file that was named, then those that its components provide."""
    from jausml.language.metamodel.classes import jaus

    documents = [named_document for named_document in model.documents if named_document.is_input]
    elements = [element for document in documents for element in model.elements_of(document)]
    own = [element for element in elements if isinstance(element, jaus.Service)]
    components = [element for element in elements if isinstance(element, jaus.Component)]
    provided = [service for component in components for service in component.provides]
    return list(dict.fromkeys([*own, *provided]))
