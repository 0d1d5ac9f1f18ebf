"""`jausml import ros`: makes models of ROS 2 interface definitions."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import click

from jausml.cli.choices import REPORT_FORMATS
from jausml.cli.common import PROBLEMS, EnvironmentFault
from jausml.cli.imported import counted, document, say, write_document
from jausml.cli.options import format_option, quiet_option

if TYPE_CHECKING:
    from jausml.language.importers.ros import ImportResult, PackageSource
    from jausml.language.interfaces import Installation
    from jausml.language.metamodel.classes.ros import InterfacePackage
    from jausml.language.validation.report import Report


@click.command("ros")
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
    """Import ROS 2 interfaces: installed packages by name, .msg, .srv and .action files, folders.

    Searches for installed packages in the prefixes of AMENT_PREFIX_PATH and in the running Python.
    Message types of other packages come from the shipped library; packages that it lacks are
    imported too. Comments become documentation. Reports all problems in one run; with an error,
    writes nothing.

    Exit status: 0 done, 1 errors in the files, 2 a package is not installed, a path cannot be read
    or a file cannot be written, 3 internal error.
    """
    from jausml.language.importers.ros import import_packages
    from jausml.language.interfaces import Installation
    from jausml.language.validation.formats import RENDERERS, text

    installation = Installation(shares)
    sources = _sources(packages, installation)
    result = import_packages(sources, installation=installation, comments=not without_comments)
    report = _report(result)
    click.echo(RENDERERS[output_format](report), nl=False)
    if report.has_errors:
        say(f"{text.summary(report)}; nothing written", quiet=quiet)
        raise click.exceptions.Exit(PROBLEMS)
    inputs = [file.path for source in sources for file in source.files]
    for path, roots, data in _documents(result, output):
        state = write_document(path, data, inputs, force=force)
        say(f"{click.format_filename(path)}: {_summary(roots)}, {state}", quiet=quiet)


def _sources(words: tuple[str, ...], installation: Installation) -> list[PackageSource]:
    """Returns the packages that are meant: by their names, or by paths."""
    from jausml.language.importers.ros import PackageSource, installed_source
    from jausml.language.interfaces.definitions import is_package_name

    sources: dict[str, PackageSource] = {}
    for word in words:
        folder = installation.folder(word) if is_package_name(word) else None
        found = [installed_source(word, folder)] if folder is not None else _at(word, installation)
        for source in found:
            known = sources.setdefault(source.name, PackageSource(source.name))
            paths = {os.path.realpath(file.path) for file in known.files}
            known.files += [f for f in source.files if os.path.realpath(f.path) not in paths]
            known.idl += source.idl
    return list(sources.values())


def _at(path: str, installation: Installation) -> list[PackageSource]:
    from jausml.language.importers.ros import package_sources
    from jausml.language.importers.ros.sources import SUFFIXES
    from jausml.language.model.inputs import open_input
    from jausml.language.model.values import suggest

    shown = click.format_filename(path)
    place = Path(path)
    try:
        if place.is_dir():
            found = package_sources([path])
            if not found:
                raise EnvironmentFault(f"no {' or '.join(SUFFIXES)} files in {shown}")
            return found
        if place.suffix in SUFFIXES:
            with open_input(place):
                return package_sources([path])
        if place.exists():
            raise EnvironmentFault(f"{shown} is no {', '.join(SUFFIXES)} file")
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise EnvironmentFault(f"{shown}: {reason}") from error
    hint = suggest(path, installation.packages())
    shares = ", ".join(str(share) for share in installation.shares if share.is_dir()) or "none"
    message = f"no package {path!a} is installed (share folders: {shares})"
    raise EnvironmentFault(f"{message}; {hint}" if hint else message)


def _report(result: ImportResult) -> Report:
    """Returns the findings of the importer; without errors, those of the rules too."""
    from jausml.language.model.reading.reader import ReadResult
    from jausml.language.validation.engine import check
    from jausml.language.validation.report import Report

    if not result.has_errors:
        return check(ReadResult(result.model, result.diagnostics))
    files = tuple(each.display for each in result.model.documents if each.given)
    return Report(result.model, files, tuple(result.diagnostics))


def _documents(
    result: ImportResult, output: str | None
) -> list[tuple[str, list[InterfacePackage], bytes]]:
    """Returns the files to be written, each with its packages and its bytes."""
    from jausml.language.importers.ros import placed

    output = output or f"{result.packages[0].name}.xmi"
    if output.endswith(os.sep) or Path(output).is_dir():
        places = {Path(output, f"{each.name}.xmi"): [each] for each in result.packages}
    else:
        places = {Path(output): result.packages}
    model = placed(result, places)
    made = [(str(path), roots, document(roots, model, str(path))) for path, roots in places.items()]
    try:
        for path in places:
            path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        shown = click.format_filename(output)
        raise EnvironmentFault(f"cannot write {shown}: {error.strerror}") from error
    return made


def _summary(packages: list[InterfacePackage]) -> str:
    return counted(
        (len(packages), "package"),
        (sum(len(each.messages) for each in packages), "message"),
        (sum(len(each.services) for each in packages), "service"),
        (sum(len(each.actions) for each in packages), "action"),
    )
