"""`jausml diff`: what changed between two states of models, also those of git revisions."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import click

from jausml.cli.shared.files import PROBLEMS, EnvironmentFault, find_files, git, write_report
from jausml.cli.shared.models import SUFFIXES, read, reading_options, valid_model
from jausml.cli.shared.options import format_option

if TYPE_CHECKING:
    from jausml.authoring.differences.changes import Change
    from jausml.authoring.differences.matching import Matching
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
    help="The same for NEW alone, if it was renamed.",
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

    Exit status: 0 done, 1 changes of the kind of --fail-on, 2 usage or environment, 3 internal
    error.
    """
    from jausml.authoring.differences.finding import changes
    from jausml.authoring.differences.matching import Matching, paired_roots
    from jausml.language.validation.formats.text import lines_of

    if code is not None and (file is not None or output_format in _PICTURES):
        raise click.UsageError("--code goes with text and json, without --as")
    if file is not None and os.devnull in (old, new):
        click.echo(f"+ {file}: added" if old == os.devnull else f"- {file}: removed")
        return
    with ExitStack() as stack:
        before, old_folder = _read(old, file, reading, stack)
        after, new_folder = _read(new, renamed or file, reading, stack)
        pairs = paired_roots(before.model, after.model, old_folder, new_folder)
        found = changes(before.model, after.model, pairs, (*before.lost, *after.lost))
        for name, result in ((old, before), (new, after)):
            _warn(name, result)
        broken = _broken(old, new, code, reading, stack) if code is not None else []
        if output_format in _PICTURES:
            roots = [(a, b) for a, b in pairs if a is not None and b is not None]
            matching = Matching(before.model, after.model, roots)
            states = ((before.model, old_folder), (after.model, new_folder))
            text = _drawn(states, view, matching, found, output_format)
        elif output_format == "json":
            told = _as_json(found) | _code_as_json(broken, code)
            text = json.dumps(told, indent=2, ensure_ascii=False) + "\n"
        else:
            shown = [] if file is None else [_title(file, renamed)]
            end = _summary(found)
            if not found and _unread(before, after):
                end = "nothing was compared"
            elif not found and file is not None:
                end = _SAME_MEANING
            if broken:
                lines = f"{len(broken)} line{'' if len(broken) == 1 else 's'}"
                end += f"; {lines} of your code to change"
            lost = [line for diagnostic in broken for line in lines_of(diagnostic)]
            text = "".join(f"{line}\n" for line in (*shown, *map(_line, found), *lost, end))
        write_report(click.unstyle(text) if output is not None else text, output)
    is_breaking = bool(broken) or any(change.breaks for change in found)
    if (fail_on == "any" and found) or (fail_on == "breaking" and is_breaking):
        raise click.exceptions.Exit(PROBLEMS)


def _broken(old: str, new: str, code: str, reading: Reading, stack: ExitStack) -> list[Diagnostic]:
    """Returns the lines of users that the change breaks."""
    from jausml.generation import GenerationError, broken_code, load_targets, select

    states = []
    for given in (old, new):
        path, inside = _found(given, reading, stack)
        states.append(valid_model(str(path), inside, outcome="no code was compared"))
    try:
        targets = select(load_targets()).targets
        found = broken_code(states[0], states[1], targets, Path(code))
    except GenerationError as error:
        raise EnvironmentFault(f"cannot tell which code breaks: {error}") from error
    return [finding.diagnostic(Path(code)) for finding in found]


def _title(file: str, renamed: str | None) -> str:
    """Returns the line by which a reader of `git diff` knows the file."""
    title = f"{file} -> {renamed}" if renamed else file
    return click.style(title, bold=True)


def _unread(*states: ReadResult) -> bool:
    return any(not document.readable for state in states for document in state.model.documents)


def _warn(name: str, result: ReadResult) -> None:
    """Tells the first error of a state, and how many more there are."""
    from jausml.language.model.diagnostics import Severity

    errors = [
        diagnostic for diagnostic in result.diagnostics if diagnostic.severity is Severity.ERROR
    ]
    if not errors:
        return
    first = errors[0]
    more = f", and {len(errors) - 1} more" if len(errors) > 1 else ""
    click.echo(f"warning: {name} has errors; what can be read was compared", err=True)
    click.echo(f"  {first.location}: {first.rule} {first.message}{more}", err=True)


def _read(
    given: str, file: str | None, reading: Reading, stack: ExitStack
) -> tuple[ReadResult, Path]:
    """Reads a state; returns it with the folder that its files are named from."""
    from jausml.language.model.inputs import read_input
    from jausml.language.model.reading.reader import read_models
    from jausml.language.text.notation import NOTATIONS

    path = Path(given)
    if file is not None:
        [state] = find_files([given], SUFFIXES)
        path = Path(file)
        contents = {Path(os.path.realpath(path)): read_input(state)}
        result = read_models(
            [path],
            project_root=reading.project_root,
            allow_outside=reading.allow_outside,
            projects=reading.projects,
            notations=NOTATIONS,
            contents=contents,
        )
        return result, path.parent
    path, reading = _found(given, reading, stack)
    return read([str(path)], reading), path if path.is_dir() else path.parent


def _found(given: str, reading: Reading, stack: ExitStack) -> tuple[Path, Reading]:
    """Returns where a state is, that of a revision in a folder of its own."""
    if not is_revision(given):
        return Path(given), reading
    folder = Path(stack.enter_context(TemporaryDirectory(prefix="jausml-diff-"))).resolve()
    return checked_out(given, folder), replace(reading, project_root=folder)


def _drawn(
    models: Sequence[tuple[Model, Path]],
    view: str,
    matching: Matching,
    found: Sequence[Change],
    output_format: str,
) -> str:
    """Returns a view of both states as a picture or page."""
    from jausml.authoring.differences.drawing import Drawn, compared
    from jausml.views.diagrams.graph import Graph
    from jausml.views.diagrams.layout.graphviz import Graphviz
    from jausml.views.diagrams.layout.sheet import LayoutError
    from jausml.views.diagrams.views import UnknownViewError, graph_of
    from jausml.views.diagrams.writers import html, svg

    drawn: list[Drawn] = []
    faults: list[UnknownViewError] = []
    for model, folder in models:
        try:
            graph = graph_of(model, view, root=folder)
        except UnknownViewError as error:
            faults.append(error)
            graph = Graph(view, "")
        drawn.append(Drawn(graph, model, Path(os.path.realpath(folder))))
    if len(faults) == len(models):
        raise EnvironmentFault(str(faults[-1]))
    old, new = drawn
    graph = compared(old, new, matching, found)
    states = [group.state for group in graph.groups]
    states += [edge.state for edge in graph.edges]
    states += [node.state for node in graph.nodes]
    states += [port.state for node in graph.nodes for port in node.ports]
    if found and not any(states):
        click.echo(f"note: nothing changed in {view}; {_summary(found)} elsewhere", err=True)
    render = svg.render if output_format == "svg" else html.render
    try:
        return render(graph, Graphviz())
    except LayoutError as error:
        raise EnvironmentFault(str(error)) from error


def _line(change: Change) -> str:
    from jausml.authoring.differences.changes import marked

    mark = marked(change.breaks)
    kind = change.kind.value
    text = f"{_SIGNS[kind]} {change.element} {change.path}: {change.text}"
    line = click.style(text, fg=_COLOURS.get(kind))
    return f"{line}  {click.style(f'[{mark}]', bold=True)}" if mark else line


def _summary(found: Sequence[Change]) -> str:
    if not found:
        return "no differences"
    parts = [f"{len(found)} change{'' if len(found) == 1 else 's'}"]
    for whom in ("peers", "code"):
        number = sum(any(mark.value == whom for mark in change.breaks) for change in found)
        if number:
            parts.append(f"{number} break{'s' if number == 1 else ''} {whom}")
    return ", ".join(parts)


def _as_json(found: Iterable[Change]) -> dict[str, Any]:
    return {
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
            for change in found
        ]
    }


def _code_as_json(broken: Iterable[Diagnostic], code: str | None) -> dict[str, Any]:
    from jausml.language.validation.formats.json import as_json

    return {} if code is None else {"code": [as_json(diagnostic) for diagnostic in broken]}


def _place(location: Location | None) -> dict[str, Any] | None:
    if location is None:
        return None
    return {"file": location.path, "line": location.line, "column": location.column}


_KEPT = (*SUFFIXES, ".project")
_FILE = "blob"


def is_revision(text: str) -> bool:
    """Tells whether a text says `REVISION:PATH` and names no file that is there."""
    revision, colon, _ = text.partition(":")
    return bool(colon and revision) and not Path(text).exists()


def checked_out(text: str, folder: Path) -> Path:
    """Writes the models of `REVISION:PATH` into a folder, and returns where the path is there.

    `text`: the revision and a path: from the present folder if it begins with `./`, else from the
    top of the repository, as git has it. `folder`: an empty folder.
    """
    revision, _, path = text.partition(":")
    top = Path(_git("rev-parse", "--show-toplevel").decode().rstrip("\n"))
    wanted = PurePosixPath(path)
    if path == "." or path.startswith(("./", "../")):
        wanted = PurePosixPath(Path(path).resolve().relative_to(top.resolve()).as_posix())
    for name, identifier in _files(top, _commit(revision)):
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(_git("cat-file", _FILE, identifier, cwd=top))
    found = folder / wanted
    if not found.exists():
        raise EnvironmentFault(f"{revision} has no model at {wanted}")
    return found


def _commit(revision: str) -> str:
    try:
        named = ("--verify", "--quiet", "--end-of-options", f"{revision}^{{commit}}")
        return _git("rev-parse", *named).decode().strip()
    except EnvironmentFault as error:
        raise EnvironmentFault(f"git knows no revision {revision!a}") from error


def _files(top: Path, commit: str) -> Iterator[tuple[str, str]]:
    """Yields names and ids of the model files of a commit."""
    for entry in (
        _git("ls-tree", "-r", "-z", commit, cwd=top).decode("utf-8", "replace").split("\0")
    ):
        head, tab, name = entry.partition("\t")
        if tab and head.split()[1] == _FILE and name.endswith(_KEPT):
            yield name, head.split()[2]


def _git(*arguments: str, cwd: Path | None = None) -> bytes:
    done = git(*arguments, cwd=cwd)
    if done.returncode:
        lines = done.stderr.decode(errors="replace").strip().splitlines()
        raise EnvironmentFault(f"git: {lines[0] if lines else f'exit {done.returncode}'}")
    return done.stdout
