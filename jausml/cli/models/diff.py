"""`jausml diff`: what changed between two states of models, also those of git revisions."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import click

from jausml.cli.shared.files import PROBLEMS, EnvironmentFault, ending_at, find_files, write_report
from jausml.cli.shared.models import SUFFIXES, read, reading_options, valid_model
from jausml.cli.shared.options import format_option
from jausml.cli.shared.revisions import check_out, is_revision

if TYPE_CHECKING:
    from jausml.authoring.differences.changes import Change
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.diagnostics import Diagnostic, Location
    from jausml.language.model.model import Model
    from jausml.language.model.project import Reading
    from jausml.language.model.reading.reader import ReadResult

FORMATS = ("text", "json", "svg", "html")
_PICTURES = ("svg", "html")
_COLOURS = {"added": "green", "removed": "red"}
_SIGNS = {"added": "+", "removed": "-", "renamed": "~", "changed": "~", "ordered": "~"}
_SAME_MEANING = (
    "no differences in meaning; --no-ext-diff shows layout, comments, ids and documentation"
)


@click.command("diff")
@click.argument("old", metavar="OLD")
@click.argument("new", metavar="NEW")
@format_option("Text for people, one JSON object, or a coloured diagram of NEW.", FORMATS)
@click.option("--view", default="system", metavar="VIEW", help="View to draw in a diagram.")
@click.option("-o", "--output", metavar="FILE", help="Write to a file instead of stdout.")
@click.option(
    "--fail-on",
    type=click.Choice(["nothing", "breaking", "any"]),
    default="nothing",
    help="Exit with 1 for changes that break peers or code, or for any change.",
)
@click.option(
    "--as",
    "file",
    metavar="FILE",
    help="File whose states OLD and NEW are; references are resolved from its folder.",
)
@click.option(
    "--new-as",
    "renamed",
    metavar="FILE",
    help="The same for NEW alone, if it was renamed; goes with --as.",
)
@click.option(
    "--code",
    metavar="DIR",
    type=click.Path(exists=True, file_okay=False),
    help="Workspace generated from OLD or NEW: name the lines of your code in it that break.",
)
@reading_options
def command(
    old: str,
    new: str,
    output_format: str,
    view: str,
    output: str | None,
    fail_on: str,
    file: str | None,
    renamed: str | None,
    code: str | None,
    reading: Reading,
) -> None:
    """Show what changed from OLD to NEW, in terms of the models.

    OLD and NEW are models, folders of models, or REVISION:PATH in a git repository, such as
    `HEAD~1:models` or `main:./rover.xmi`. Layout, ids, documentation, the notation, and an order
    that has no meaning do not count as changes. Changes that break programs on the network or code
    of users are marked; with --code, the lines of yours that break are named. With --as, git can
    call this command: one of the states may then be /dev/null, for a file that does not exist.

    A diagram (svg, html) shows a view of NEW as `jausml diagram` does, and the removed parts of
    OLD: added parts are blue with +, removed ones orange and dashed with a minus sign, changed ones
    yellow with ~.

    Exit status: 0 done, 1 changes of the kind of --fail-on, 2 usage or environment (with --fail-on:
    or a file cannot be read), 3 internal error.
    """
    _check_options(old, new, output_format, file, renamed, code)
    with ExitStack() as stack:
        before = _state(old, file, reading, stack)
        after = _state(new, renamed or file, reading, stack)
        comparison = _comparison(before, after, code)
        if output_format in _PICTURES:
            text = _diagram(comparison, view, output_format)
        elif output_format == "json":
            text = json.dumps(_as_json(comparison), indent=2, ensure_ascii=False) + "\n"
        else:
            text = _report_text(comparison, file, renamed)
        states = (comparison.before, comparison.after)
        inputs = (document.path for state in states for document in state.model.documents)
        shown = click.unstyle(text) if output is not None else text
        write_report(shown, output, (old, new, *inputs))
    if comparison.unread and fail_on != "nothing":
        names = ", ".join(map(click.format_filename, comparison.unread))
        raise EnvironmentFault(f"{names} cannot be read; what changed is not known")
    failures = {"any": bool(comparison.changes), "breaking": comparison.is_breaking}
    if failures.get(fail_on):
        raise click.exceptions.Exit(PROBLEMS)


@dataclass(frozen=True)
class _State:
    """A state of models: its name for the user, its place, and its model.

    Attributes:
        path: The file or folder, that of a revision in a folder of its own.
        reading: Where its references may lead.
    """

    name: str
    path: Path
    reading: Reading
    result: ReadResult

    @property
    def model(self) -> Model:
        """Its model."""
        return self.result.model

    @property
    def folder(self) -> Path:
        """The folder that its files are named from."""
        return self.path if self.path.is_dir() else self.path.parent


@dataclass(frozen=True)
class _Comparison:
    """The changes from one state to another.

    Attributes:
        pairs: The root elements of both states, None for one that the other state lacks.
        broken_lines: The lines of users that break; None if nobody asked.
    """

    before: _State
    after: _State
    pairs: Sequence[tuple[EObject | None, EObject | None]]
    changes: Sequence[Change]
    broken_lines: Sequence[Diagnostic] | None

    @property
    def unread(self) -> list[str]:
        """The states with a file that cannot be read."""
        return [
            state.name
            for state in (self.before, self.after)
            if not all(document.readable for document in state.model.documents)
        ]

    @property
    def is_breaking(self) -> bool:
        """Whether anything breaks peers or code."""
        return bool(self.broken_lines) or any(change.breaks for change in self.changes)


def _check_options(
    old: str, new: str, output_format: str, file: str | None, renamed: str | None, code: str | None
) -> None:
    """Refuses options that make no sense together."""
    if code is not None and (file is not None or output_format in _PICTURES):
        raise click.UsageError("--code goes with text and json, without --as")
    if renamed is not None and file is None:
        raise click.UsageError("--new-as goes with --as")
    if old == new == os.devnull:
        raise click.UsageError("only one of the states can be a file that does not exist")
    if file is not None and any(Path(state_argument).is_dir() for state_argument in (old, new)):
        raise click.UsageError("--as compares states of a file, no folders")


def _comparison(before: _State, after: _State, code: str | None) -> _Comparison:
    """Returns the comparison of two states, and shows unreadable files."""
    from jausml.authoring.differences import finding
    from jausml.authoring.differences.matching import paired_roots

    pairs = paired_roots(before.model, after.model, before.folder, after.folder)
    lost = (*before.result.lost, *after.result.lost)
    changes = finding.changes(before.model, after.model, pairs, lost)
    for state in (before, after):
        _warn(state.name, state.result)
    broken_lines = _broken_lines(before, after, Path(code)) if code is not None else None
    return _Comparison(before, after, pairs, changes, broken_lines)


def _broken_lines(before: _State, after: _State, code: Path) -> list[Diagnostic]:
    """Returns the lines of users that the change breaks."""
    from jausml.generation.errors import GenerationError
    from jausml.generation.target import load_targets
    from jausml.generation.workspace import broken_code, select

    old, new = (
        valid_model(str(state.path), state.reading, outcome="no code was compared")
        for state in (before, after)
    )
    with ending_at(GenerationError, about="cannot tell which code breaks: "):
        findings = broken_code(old, new, select(load_targets()).targets, code)
    return [finding.diagnostic(code) for finding in findings]


def _report_text(comparison: _Comparison, file: str | None, renamed: str | None) -> str:
    """Returns a line for each change, and a summary."""
    from jausml.language.validation.formats.text import lines_of

    changes = comparison.changes
    # By this line a reader of `git diff` knows the file.
    title = f"{file} -> {renamed}" if renamed else file
    header_lines = [click.style(title, bold=True)] if title is not None else []
    summary = _summary(changes)
    if not changes and comparison.unread:
        summary = "nothing was compared"
    elif not changes and file is not None:
        summary = _SAME_MEANING
    findings = comparison.broken_lines or ()
    if findings:
        count = f"{len(findings)} line{'' if len(findings) == 1 else 's'}"
        summary += f"; {count} of your code to change"
    broken_lines = [line for finding in findings for line in lines_of(finding)]
    lines = (*header_lines, *map(_line, changes), *broken_lines, summary)
    return "".join(f"{line}\n" for line in lines)


def _warn(name: str, result: ReadResult) -> None:
    """Tells the first error of a state, and how many more there are."""
    from jausml.language.model.diagnostics import Severity

    errors = [error for error in result.diagnostics if error.severity is Severity.ERROR]
    if not errors:
        return
    first = errors[0]
    more = f", and {len(errors) - 1} more" if len(errors) > 1 else ""
    click.echo(f"warning: {name} has errors; what can be read was compared", err=True)
    click.echo(f"  {first.location}: {first.rule} {first.message}{more}", err=True)


def _state(state_argument: str, file: str | None, reading: Reading, stack: ExitStack) -> _State:
    """Reads a state.

    `file`: the name that its content is read under; None for that of the state itself.
    """
    path = Path(file or state_argument)
    if file is not None or state_argument == os.devnull:
        return _State(state_argument, path, reading, _read_as(path, state_argument, reading))
    if is_revision(state_argument):
        folder = stack.enter_context(TemporaryDirectory(prefix="jausml-diff-"))
        root = Path(folder).resolve()
        path, reading = check_out(state_argument, root), replace(reading, project_root=root)
    return _State(state_argument, path, reading, read([str(path)], reading))


def _read_as(path: Path, state_argument: str, reading: Reading) -> ReadResult:
    """Reads a file under another name; one that does not exist is a model without elements."""
    from jausml.language.model.files import read_input
    from jausml.language.model.reading.reader import read_models
    from jausml.language.text.notation import NOTATIONS

    [state_file] = find_files([state_argument], SUFFIXES)
    return read_models(
        [] if state_argument == os.devnull else [path],
        project_root=reading.project_root,
        allow_outside=reading.allow_outside,
        projects=reading.projects,
        notations=NOTATIONS,
        contents={Path(os.path.realpath(path)): read_input(state_file)},
    )


def _diagram(comparison: _Comparison, view: str, output_format: str) -> str:
    """Returns a view of both states as a picture or page."""
    from jausml.authoring.differences.drawing import Drawn, compared
    from jausml.authoring.differences.matching import Matching
    from jausml.views.diagrams.graph import Graph
    from jausml.views.diagrams.layout.sheet import LayoutError
    from jausml.views.diagrams.views import UnknownViewError, graph_of
    from jausml.views.diagrams.writers import html, svg

    drawings: list[Drawn] = []
    unknown_views: list[UnknownViewError] = []
    for state in (comparison.before, comparison.after):
        try:
            graph = graph_of(state.model, view, root=state.folder)
        except UnknownViewError as error:
            unknown_views.append(error)
            graph = Graph(view, "")
        drawings.append(Drawn(graph, state.model, Path(os.path.realpath(state.folder))))
    if len(unknown_views) == len(drawings):
        raise EnvironmentFault(str(unknown_views[-1]))
    old, new = drawings
    roots = [(a, b) for a, b in comparison.pairs if a is not None and b is not None]
    matching = Matching(old.model, new.model, roots)
    graph = compared(old, new, matching, comparison.changes)
    if comparison.changes and not graph.compares:
        summary = _summary(comparison.changes)
        click.echo(f"note: nothing changed in {view}; {summary} elsewhere", err=True)
    render = svg.render if output_format == "svg" else html.render
    with ending_at(LayoutError):
        return render(graph)


def _line(change: Change) -> str:
    from jausml.authoring.differences.changes import marked

    mark = marked(change.breaks)
    kind = change.kind.value
    text = f"{_SIGNS[kind]} {change.element} {change.path}: {change.text}"
    line = click.style(text, fg=_COLOURS.get(kind))
    return f"{line}  {click.style(f'[{mark}]', bold=True)}" if mark else line


def _summary(changes: Sequence[Change]) -> str:
    if not changes:
        return "no differences"
    parts = [f"{len(changes)} change{'' if len(changes) == 1 else 's'}"]
    for whom in ("peers", "code"):
        number = sum(any(mark.value == whom for mark in change.breaks) for change in changes)
        if number:
            parts.append(f"{number} break{'s' if number == 1 else ''} {whom}")
    return ", ".join(parts)


def _as_json(comparison: _Comparison) -> dict[str, Any]:
    from jausml.language.validation.formats.json import as_json

    report: dict[str, Any] = {
        "changes": [
            {
                "kind": change.kind.value,
                "element": change.element,
                "path": change.path,
                "feature": change.feature,
                "old": change.old,
                "new": change.new,
                "text": change.text,
                "breaks": [mark.value for mark in change.breaks],
                "oldPlace": _place(change.old_place),
                "newPlace": _place(change.new_place),
            }
            for change in comparison.changes
        ],
        "unread": comparison.unread,
    }
    if comparison.broken_lines is not None:
        report["code"] = [as_json(finding) for finding in comparison.broken_lines]
    return report


def _place(location: Location | None) -> dict[str, Any] | None:
    if location is None:
        return None
    return {"file": location.path, "line": location.line, "column": location.column}
