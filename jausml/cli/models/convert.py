"""`jausml convert` and `jausml format`: models as ros2jaus text and back, and its layout."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from difflib import unified_diff
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import quote

import click

from jausml.cli.shared.files import (
    PROBLEMS,
    EnvironmentFault,
    counted,
    ending_at,
    find_files,
    made_folder,
    say,
    write_document,
    writing,
)
from jausml.cli.shared.models import (
    SUFFIXES,
    bridge_options,
    checked,
    fail,
    frequency_option,
    read,
    reading_options,
    show_findings,
)
from jausml.cli.shared.options import quiet_option

if TYPE_CHECKING:
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.documents import Document
    from jausml.language.model.model import Model
    from jausml.language.model.project import Reading
    from jausml.language.model.reading.reader import ReadResult
    from jausml.language.text.reading.parsing import Parsed

_XMI, _TEXT = SUFFIXES


@click.command("convert")
@click.argument("source", metavar="FROM")
@click.argument("target", metavar="TO")
@click.option("--force", is_flag=True, help="Overwrite TO if it differs.")
@reading_options
@bridge_options
@frequency_option
@quiet_option("Print no summary.")
def command(source: str, target: str, force: bool, reading: Reading, quiet: bool) -> None:
    """Write a model in another notation: XMI as ros2jaus text, or text as XMI.

    The endings .xmi and .ros2jaus determine the notation. The new file has exactly the same content
    as the old one, and refers to the same other files. If the model cannot be read, or the new file
    would have errors that the old one has not, they are reported and no file is written.

    Exit status: 0 done, 1 errors in the model, 2 FROM cannot be read or TO cannot be written, 3
    internal error.
    """
    from jausml.language.model.xmi.printing import UnwritableError

    _check_paths(source, target)
    result = read([source], reading)
    _report(result, source, quiet=quiet)
    model, document = result.model, result.model.documents[0]
    what = f"cannot write {click.format_filename(target)}: "
    with ending_at(UnwritableError, kind=click.ClickException, about=what):
        written, copies = _written(document.roots, model, target, reading.project_root)
    data = written.encode("utf-8")
    _check_written(source, target, {Path(target): data, **copies}, reading, quiet=quiet)
    for path in copies:
        made_folder(path.parent)
    state = write_document(target, data, (), force=force)
    for path, data in copies.items():
        shown = click.format_filename(os.path.relpath(path))
        say(f"{shown}: {write_document(str(path), data, (), force=False)}", quiet=quiet)
    for warning in _left_behind(result, target, written):
        say(f"{click.format_filename(source)}: warning: {warning}", quiet=quiet)
    summary = f"{_summary(document.roots, model)}, {state}"
    say(f"{click.format_filename(target)}: {summary}", quiet=quiet)


def _check_paths(source: str, target: str) -> None:
    """Refuses what cannot be read or must not be written."""
    shown = click.format_filename(target)
    if not target.endswith(SUFFIXES):
        raise click.UsageError(f"TO must end with {_XMI} or {_TEXT}")
    if Path(source).is_dir():
        raise click.UsageError("FROM is a folder: convert one file at a time")
    if os.path.realpath(source) == os.path.realpath(target):
        raise EnvironmentFault(f"{shown} is the file to convert")
    if Path(target).exists() and not Path(target).is_file():
        raise EnvironmentFault(f"cannot write {shown}: it is no file")


def _report(result: ReadResult, source: str, *, quiet: bool) -> None:
    """Shows the findings of reading, and ends when the model cannot be used."""
    from jausml.language.model.diagnostics import Severity
    from jausml.language.validation.rule import Report

    report = Report(result.model, (source,), tuple(result.diagnostics))
    shown = [
        diagnostic for diagnostic in report.diagnostics if diagnostic.severity is not Severity.INFO
    ]
    if shown:
        show_findings(Report(result.model, (source,), tuple(shown)), err=False)
    if result.has_errors:
        fail(report, "nothing written", quiet=quiet)


def _check_written(
    source: str, target: str, contents: Mapping[Path, bytes], reading: Reading, *, quiet: bool
) -> None:
    """Ends where the new file would have more errors of a rule than the old one."""
    from collections import Counter

    from jausml.language.model.diagnostics import Severity
    from jausml.language.model.reading.reader import read_models
    from jausml.language.text.notation import NOTATIONS
    from jausml.language.validation.engine import check
    from jausml.language.validation.rule import Report

    held = {Path(os.path.realpath(path)): data for path, data in contents.items()}
    result = read_models(
        [target],
        project_root=reading.project_root,
        allow_outside=True,  # what is read with an option alone is told as a warning
        projects=reading.projects,
        notations=NOTATIONS,
        contents=held,
    )
    after = check(result)
    if not after.has_errors:
        return
    errors, known = (
        [diagnostic for diagnostic in report.diagnostics if diagnostic.severity is Severity.ERROR]
        for report in (after, checked([source], reading))
    )
    more = Counter(error.rule for error in errors) - Counter(error.rule for error in known)
    if more:
        new = tuple(error for error in errors if error.rule in more)
        report = Report(after.model, (target,), new)
        show_findings(report)
        fail(report, "nothing written", quiet=quiet)


def _written(
    roots: list[EObject], model: Model, target: str, project_root: str | os.PathLike[str] | None
) -> tuple[str, dict[Path, bytes]]:
    """Returns the new file, and the copies of ready maps that Eclipse needs beside it."""
    from jausml.authoring.projects.eclipse_xmi import as_xmi_beside, localized, with_ready_maps
    from jausml.language.model.project import find_project_root
    from jausml.language.model.xmi.writer import name_identifiers, to_xmi
    from jausml.language.text.writing.unparsing import to_text

    if target.endswith(_TEXT):
        return to_text(roots, model, target), {}
    document = model.document_of(roots[0]) if roots else None
    if document is not None and not document.is_xml:
        name_identifiers(roots, model)
    path = Path(os.path.realpath(target))
    root = Path(os.path.realpath(project_root)) if project_root else find_project_root([path])
    xmi, missing = with_ready_maps(to_xmi(roots, model, target), path, root)
    copies = {copy: as_xmi_beside(text, copy, root).encode() for copy, text in missing.items()}
    return localized(xmi, path, root), copies


def _left_behind(result: ReadResult, target: str, written: str) -> Iterator[str]:
    """Yields the parts that the new file lacks, and the references that it cannot follow."""
    from jausml.language.model.project import find_project_root

    document, *others = result.model.documents
    number = _comments(document)
    if number:
        noun = "comment stays" if number == 1 else "comments stay"
        yield f"{number} {noun} behind: only documentation is part of a model"
    if target.endswith(_XMI):
        for other in others:
            if not other.is_xml and f"{quote(other.path.name)}#" in written:
                yield f"refers to {other.display}, which Eclipse cannot read: convert it too"
    root = find_project_root([Path(target)])
    outside = [
        document
        for document in others
        if not document.is_library and not document.path.is_relative_to(root)
    ]
    if outside:
        yield (
            f"refers to {outside[0].display}, which lies outside of {root}: there it is read with "
            "--project-root or --allow-outside alone (JML209)"
        )


def _comments(document: Document) -> int:
    """Returns how many comments of a document no model holds."""
    from jausml.language.text.comments import ordinary_comments

    if document.is_xml:
        return document.data.replace(b"\0", b"").count(b"<!--")
    return len(ordinary_comments(document.data.decode("utf-8", "replace")))


def _summary(roots: list[EObject], model: Model) -> str:
    pending, elements = list(roots), 0
    while pending:
        elements += 1
        pending += model.owned(pending.pop())
    return counted((len(roots), "root"), (elements, "element"))


@click.command("format")
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@click.option("--check", is_flag=True, help="Write nothing; fail if a file would change.")
@click.option("--diff", is_flag=True, help="Write nothing; show the changes as a patch.")
@quiet_option("Do not list the changed files.")
def format_(files: tuple[str, ...], check: bool, diff: bool, quiet: bool) -> None:
    """Lay out ros2jaus text uniformly: files, or all *.ros2jaus files below folders.

    Changes neither the meaning of the text nor its comments, and keeps the line ends of a file. If
    a file has syntax errors, reports them and writes no file.

    Exit status: 0 done (--check: nothing to do), 1 syntax errors (--check: or a file would change),
    2 a file cannot be read or written or is not ros2jaus text, 3 internal error.
    """
    from jausml.language.text.notation import SUFFIX
    from jausml.language.text.reading.parsing import parse
    from jausml.language.text.reading.scanning import line_end
    from jausml.language.text.writing.layout import lay_out

    texts = {name: _read(name) for name in find_files(files, (SUFFIX,))}
    parsed = {name: parse(text) for name, text in texts.items()}
    if _report_faults(parsed):
        raise click.exceptions.Exit(PROBLEMS)
    laid_out = {
        name: lay_out(result.document).replace("\n", line_end(texts[name]))
        for name, result in parsed.items()
    }
    changed = {name: new for name, new in laid_out.items() if new != texts[name]}
    for name, new in changed.items():
        if diff:
            click.echo(_patch(name, texts[name], new), nl=False)
        elif not quiet:
            click.echo(click.format_filename(name))
        if not (check or diff):
            _write(name, new)
    if check and changed:
        raise click.exceptions.Exit(PROBLEMS)


def _read(name: str) -> str:
    """Returns the text of a file as it is, line ends and byte order mark included."""
    from jausml.language.model.diagnostics import Location
    from jausml.language.model.files import read_input
    from jausml.language.text.notation import SUFFIX, decode

    if not name.endswith(SUFFIX):
        raise EnvironmentFault(f"{click.format_filename(name)}: the file is no *{SUFFIX} file")
    data = read_input(name)
    _, fault = decode(data)
    if fault is not None:
        place = Location(name, fault.line, fault.column)
        raise EnvironmentFault(f"{place}: {fault.message}")
    return data.decode("utf-8")


def _report_faults(parsed: Mapping[str, Parsed]) -> bool:
    """Reports the syntax errors of files, and tells whether there are any."""
    from jausml.language.model.diagnostics import Diagnostic, Location, Severity
    from jausml.language.validation.formats.text import lines_of

    findings = [
        Diagnostic(
            "JML701",
            Severity.ERROR,
            Location(name, fault.span.line, fault.span.column),
            fault.message,
            fault.hint,
        )
        for name, result in parsed.items()
        for fault in result.faults
    ]
    for finding in sorted(findings):
        for line in lines_of(finding):
            click.echo(line)
    return bool(findings)


def _patch(name: str, old: str, new: str) -> str:
    # Lines end at line feeds alone, not at all that Unicode has.
    before, after = (list(StringIO(text, newline="\n")) for text in (old, new))
    lines = unified_diff(before, after, f"a/{name}", f"b/{name}")
    marked = (
        line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n" for line in lines
    )
    return "".join(marked)


def _write(name: str, text: str) -> None:
    from jausml.language.model.files import replace_file

    with writing(name):
        replace_file(Path(name), text.encode("utf-8"))
