"""`jausml generate`: validates a model and writes a workspace from it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jausml.cli.shared.files import PROBLEMS, EnvironmentFault, ending_at, write_report
from jausml.cli.shared.models import bridge_options, checked, fail, model_argument, reading_options
from jausml.cli.shared.options import REPORT_FORMATS, format_option, quiet_option
from jausml.cli.shared.terminal import painted_findings, remark, step, verbosity

if TYPE_CHECKING:
    from jausml.generation.errors import NoSystemError
    from jausml.generation.plan import Plan
    from jausml.generation.target import Target
    from jausml.generation.workspace import Result, Selection
    from jausml.language.model.model import Model
    from jausml.language.model.project import Reading

_FEW = 3  # files of a package that are listed one by one when the same becomes of them

_MODES = ("check", "diff", "dry_run")
_EXAMPLE = """\
bridge front {{
  address: <subsystem>.<node>.<component>
  connection {map} {{ map: {map}  peers: <component>  topic {map} }}
}}"""


class WholeLibraryOption(click.Option):
    """The flag `--all`, whose help is of the installed targets that know it."""

    def get_help_record(self, ctx: click.Context) -> tuple[str, str] | None:
        """Returns the flag, and its effect for each target."""
        targets = _installed().values()
        able = ((target.name, target.whole_library) for target in targets)
        texts = "; ".join(
            f"with --target {name} {library.help}" for name, library in able if library
        )
        self.help = f"Describe more: {texts}."
        return super().get_help_record(ctx)


@click.command("generate")
@model_argument
@click.option(
    "-o",
    "--out",
    metavar="OUT",
    help="Output folder; by default <name of the model file>_ws/src, a colcon workspace.",
)
@click.option("--target", "names", multiple=True, metavar="NAME", help="Generate only this target.")
@click.option("--all", "whole_library", is_flag=True, cls=WholeLibraryOption)
@click.option(
    "--check",
    is_flag=True,
    help="Write nothing; fail if something would change, or if your own files no longer fit the "
    "model.",
)
@click.option(
    "--strict",
    is_flag=True,
    help="Also fail on warnings about the model, and if your own files no longer fit it.",
)
@format_option(
    "Format of the report of --check on the model, your own files and the generated ones.",
    REPORT_FORMATS,
)
@click.option(
    "--output", metavar="FILE", help="Write the report of --check to a file instead of stdout."
)
@click.option("--diff", is_flag=True, help="Write nothing; show the changes as a patch.")
@click.option("--dry-run", is_flag=True, help="Write nothing; list the changes.")
@click.option(
    "--fix",
    is_flag=True,
    help="Make your own files fit the model where it is certain how: names that are renamed, "
    "imports that are gone and unused.",
)
@click.option(
    "--adopt",
    default="",
    show_default=False,
    metavar="NAME",
    help="Take over the files in OUT that belong to the model NAME, because it has been renamed.",
)
@click.option("--force", is_flag=True, help="Overwrite generated files that have been edited.")
@click.option(
    "--frequency",
    type=float,
    metavar="HZ",
    help="Frequency of every bridge, for connections that state no rate.",
)
@reading_options
@bridge_options
@quiet_option("Print no summary and list no files; with --check, list those that would change.")
def command(
    model: str,
    out: str | None,
    names: tuple[str, ...],
    whole_library: bool,
    strict: bool,
    output_format: str,
    output: str | None,
    fix: bool,
    adopt: str,
    force: bool,
    frequency: float | None,
    reading: Reading,
    quiet: bool,
    **modes: bool,
) -> None:
    """Generate a workspace from the system in MODEL, by default the only one of the project.

    Validates the model first. Your own files (skeletons) are written once and never changed
    afterwards, except by --fix, which prints what it changes. They are read, not run: what no
    longer fits the generated code is an error where it ends the program, else a warning.

    If the same happens to many files of a package, they are listed as one line. Unchanged files are
    not listed. `jausml --verbose generate` lists every file.

    Exit status: 0 done (--check: up to date), 1 problems in the model, a refused file, an error in
    your own files (--check: or something would change; --check and --strict: or a warning about
    your own files), 2 usage or environment, 3 internal error.
    """
    from jausml.generation.workspace import with_code
    from jausml.language.validation.formats import RENDERERS, text

    is_report = output_format != "text" or output is not None
    mode = _mode(modes, fix=fix, is_report=is_report)
    _check_frequency(frequency)
    folder = _out_folder(model, out)
    selection = _selected(names, whole_library=whole_library)
    report = checked([model], reading, is_one=True, frequency=frequency)
    if not is_report:
        click.echo(painted_findings(text.render(report)), nl=False, err=True)
    if report.has_errors or (strict and report.has_warnings):
        if is_report:
            write_report(RENDERERS[output_format](report), output, report.files)
        fail(report, "nothing generated")
    result = _generated(
        report.model, selection, folder, adopt=adopt, force=force, write=mode == "write", fix=fix
    )
    if is_report:
        judged = with_code(report, result, folder)
        write_report(RENDERERS[output_format](judged), output, report.files)
    else:
        _tell_fixes(result)
        _tell_changes(result, folder, mode, quiet=quiet)
    if fix and result.drift and not result.fixed:
        remark("--fix changed nothing: how these fit again is for you to decide")
    _conclude(result, quiet=quiet)
    if result.plan.refused or _has_fallen_behind(result, mode, strict=strict):
        raise click.exceptions.Exit(PROBLEMS)


def _mode(modes: dict[str, bool], *, fix: bool, is_report: bool) -> str:
    """Returns the mode of the run; refuses options that exclude each other."""
    chosen = [mode for mode in _MODES if modes[mode]]
    if len(chosen) > 1:
        raise click.UsageError("--check, --diff and --dry-run exclude each other")
    if fix and chosen:
        raise click.UsageError(f"--fix writes, --{chosen[0].replace('_', '-')} does not")
    if is_report and chosen != ["check"]:
        raise click.UsageError("--format and --output are of --check")
    return chosen[0] if chosen else "write"


def _check_frequency(frequency: float | None) -> None:
    if frequency is None:
        return
    from jausml.language.semantics.connections.limits import LEAST_RATE, MAXIMUM_RATE

    if not LEAST_RATE <= frequency <= MAXIMUM_RATE:
        raise click.UsageError(f"--frequency is {LEAST_RATE:g} to {MAXIMUM_RATE:g} hertz")


def _has_fallen_behind(result: Result, mode: str, *, strict: bool) -> bool:
    """Tells whether files do not fit the model; with `strict`, also those that still run."""
    from jausml.language.model.diagnostics import Severity

    if mode == "check" and not result.plan.is_up_to_date:
        return True
    bad = {Severity.ERROR, Severity.WARNING} if strict or mode == "check" else {Severity.ERROR}
    return any(finding.severity in bad for finding in result.drift)


def _out_folder(model: str, out: str | None) -> Path:
    folder = Path(out) if out is not None else Path(f"{Path(model).stem}_ws", "src")
    if folder.exists() and not folder.is_dir():
        raise EnvironmentFault(f"{click.format_filename(folder)} is no folder")
    return folder


def _selected(names: tuple[str, ...], *, whole_library: bool) -> Selection:
    from jausml.generation.errors import SelectionError
    from jausml.generation.workspace import select

    with ending_at(SelectionError, kind=click.UsageError):
        return select(_installed(), names, whole_library=whole_library)


def _installed() -> dict[str, Target[Any]]:
    from jausml.generation.errors import GenerationError
    from jausml.generation.target import load_targets

    with ending_at(GenerationError):
        return load_targets()


def _generated(model: Model, selection: Selection, folder: Path, **options: Any) -> Result:
    from jausml.generation.errors import (
        GenerationError,
        InternalError,
        NoSystemError,
        OwnershipError,
        RefusedError,
        WriteError,
    )
    from jausml.generation.workspace import generate

    try:
        with step("generating"):
            return generate(
                model,
                selection.targets,
                folder,
                kept=selection.kept,
                renewed=selection.renewed,
                **options,
            )
    except InternalError:
        raise
    except NoSystemError as error:
        raise EnvironmentFault(_no_system(error)) from error
    except OwnershipError as error:
        raise EnvironmentFault(str(error)) from error
    except RefusedError as error:
        raise EnvironmentFault(f"cannot write into {folder}: {error}") from error
    except WriteError as error:
        message = f"cannot write into {folder}: {error}"
        rest = "some files may be written already; fix this and run it again"
        raise EnvironmentFault(f"{message} ({rest})") from error
    except GenerationError as error:
        # A target's view found what no rule demands.
        raise click.ClickException(f"cannot generate from this model: {error}") from error


def _no_system(error: NoSystemError) -> str:
    from jausml.language.text.notation import SUFFIX

    if error.systems or not error.maps or not error.path.endswith(SUFFIX):
        return str(error)
    message = f"{error.path} holds maps, but no bridge that uses them; say --bridge-address ID for"
    message += " one that carries them all, or add one, for example:"
    return f"{message}\n\n{_EXAMPLE.format(map=error.maps[0])}"


def _tell_fixes(result: Result) -> None:
    for fix in result.fixed:
        edit, place = fix.edit, f"{result.plan.out / fix.path}:{fix.edit.line}"
        old, new = (" ".join(text.split()) for text in (edit.old, edit.new))
        click.echo(f"{place}: fixed: {f'{old} -> {new}' if new else f'took out {old}'}", err=True)


def _tell_changes(result: Result, folder: Path, mode: str, *, quiet: bool) -> None:
    """Shows the user code that no longer fits, and the changes of files."""
    from jausml.generation.plan import unified_diff
    from jausml.language.validation.formats.text import lines_of

    for finding in result.drift:
        (line,) = lines_of(finding.diagnostic(folder))
        click.echo(painted_findings(line), err=True)
        if finding.stub:
            click.echo(finding.stub.removesuffix("\n"), err=True)
    if mode == "diff":
        click.echo(unified_diff(result.plan), nl=False)
    elif verbosity().verbose:
        for action in result.plan.actions:
            click.echo(f"{action.kind.value:6} {action.path} ({action.reason})")
    elif not quiet or mode == "check":
        for change in _changes(result.plan):
            click.echo(change)


def _conclude(result: Result, *, quiet: bool) -> None:
    for action in result.plan.refused:
        click.echo(f"{result.plan.out / action.path}: error: {action.reason}", err=True)
    if quiet:
        return
    click.echo(_summary(result), err=True)
    if result.drift and not result.fixed and any(finding.edits for finding in result.drift):
        click.echo("--fix changes your files where it is certain how", err=True)


def _changes(plan: Plan) -> Iterator[str]:
    """Yields the changes of files; many files of a package with one fate are one line."""
    from jausml.generation.plan import ActionKind

    fates: dict[tuple[str, str, str], list[str]] = {}
    for action in plan.actions:
        if action.kind is not ActionKind.KEEP:
            package, _, below = action.path.partition("/")
            fate = (action.kind.value, package if below else "", action.reason)
            fates.setdefault(fate, []).append(action.path)
    for (kind, package, reason), paths in fates.items():
        if package and len(paths) > _FEW:
            yield f"{kind:6} {package}/ ({len(paths)} files, {reason})"
            continue
        for path in paths:
            yield f"{kind:6} {path} ({reason})"


def _summary(result: Result) -> str:
    from jausml.generation.plan import ActionKind

    words = {
        ActionKind.CREATE: "created" if result.is_written else "to create",
        ActionKind.UPDATE: "updated" if result.is_written else "to update",
        ActionKind.DELETE: "deleted" if result.is_written else "to delete",
        ActionKind.KEEP: "kept",
        ActionKind.ORPHAN: "no longer of the model",
        ActionKind.REFUSE: "refused",
    }
    plan = result.plan
    counts = [f"{len(plan.of(kind))} {word}" for kind, word in words.items() if plan.of(kind)]
    end = "; nothing written" if plan.refused else ""
    return f"{', '.join(counts)} in {click.format_filename(plan.out)}{end}"
