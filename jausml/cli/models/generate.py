"""`jausml generate`: validates a model and writes a workspace from it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jausml.cli.shared.files import PROBLEMS, EnvironmentFault
from jausml.cli.shared.models import bridge_options, model_argument, reading_options, valid_model
from jausml.cli.shared.options import quiet_option
from jausml.cli.shared.terminal import remark, step, verbosity

if TYPE_CHECKING:
    from jausml.generation import NoSystemError, Plan, Result, Selection, Target
    from jausml.language.model.model import Model
    from jausml.language.project.reading import Reading

_FEW = 3
"""Files of a package that are listed one by one when the same becomes of them."""

_MODES = ("check", "diff", "dry_run")
_EXAMPLE = """\
bridge front {{
  address: <subsystem>.<node>.<component>
  connection {map} {{ map: {map}  peers: <component>  topic {map} }}
}}"""


class WholeLibraryOption(click.Option):
    """The flag `--all`, whose help is of the installed targets that know it."""

    def get_help_record(self, ctx: click.Context) -> tuple[str, str] | None:
        """Returns the flag and what it asks of each target."""
        targets = _installed().values()
        able = ((target.name, target.whole_library) for target in targets)
        texts = "; ".join(f"with --target {name} {each.help}" for name, each in able if each)
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
@click.option(
    "--all",
    "whole_library",
    is_flag=True,
    cls=WholeLibraryOption,
)
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
@quiet_option("Do not list files; with --check, list those that would change.")
def command(
    model: str,
    out: str | None,
    names: tuple[str, ...],
    whole_library: bool,
    strict: bool,
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

    Exit status: 0 done (--check: up to date), 1 problems in the model, a refused file (--check: or
    something would change; --check and --strict: or your own files no longer fit the model), 2
    usage or environment, 3 internal error.
    """
    from jausml.language.validation.rules.jaus.components import MAXIMUM_RATE

    chosen = [mode for mode in _MODES if modes[mode]]
    if len(chosen) > 1:
        raise click.UsageError("--check, --diff and --dry-run exclude each other")
    if fix and chosen:
        raise click.UsageError(f"--fix writes, --{chosen[0].replace('_', '-')} does not")
    if frequency is not None and not 0 < frequency <= MAXIMUM_RATE:
        raise click.UsageError(f"--frequency is above 0 and at most {MAXIMUM_RATE:g} hertz")
    folder = _out_folder(model, out)
    selection = _selected(names, whole_library=whole_library)
    valid = valid_model(
        model,
        reading,
        frequency=frequency,
        is_strict=strict,
        shows_warnings=True,
        outcome="nothing generated",
    )
    mode = chosen[0] if chosen else "write"
    result = _generated(
        valid, selection, folder, adopt=adopt, force=force, write=mode == "write", fix=fix
    )
    _report_fixes(result)
    _report_drift(result)
    if fix and result.drift and not result.fixed:
        remark("--fix changed nothing: how these fit again is for you to decide")
    _report(result, mode, quiet=quiet)
    if (strict or mode == "check") and any(each.severity != "info" for each in result.drift):
        raise click.exceptions.Exit(PROBLEMS)


def _out_folder(model: str, out: str | None) -> Path:
    folder = Path(out) if out is not None else Path(f"{Path(model).stem}_ws", "src")
    if folder.exists() and not folder.is_dir():
        raise EnvironmentFault(f"{click.format_filename(folder)} is no folder")
    return folder


def _selected(names: tuple[str, ...], *, whole_library: bool) -> Selection:
    from jausml.generation import SelectionError, select

    try:
        return select(_installed(), names, whole_library=whole_library)
    except SelectionError as error:
        raise click.UsageError(str(error)) from error


def _installed() -> dict[str, Target[Any]]:
    from jausml.generation import GenerationError, load_targets

    try:
        return load_targets()
    except GenerationError as error:
        raise EnvironmentFault(str(error)) from error


def _generated(model: Model, selection: Selection, folder: Path, **options: Any) -> Result:
    from jausml.generation import (
        GenerationError,
        InternalError,
        NoSystemError,
        OwnershipError,
        RefusedError,
        WriteError,
        generate,
    )

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
    message = (
        f"{error.path} holds maps, but no bridge that uses them; say --bridge-address ID for one"
    )
    message += " that carries them all, or add one, for example:"
    return f"{message}\n\n{_EXAMPLE.format(map=error.maps[0])}"


def _report_fixes(result: Result) -> None:
    for each in result.fixed:
        edit, place = each.edit, f"{result.plan.out / each.path}:{each.edit.line}"
        old, new = (" ".join(text.split()) for text in (edit.old, edit.new))
        click.echo(f"{place}: fixed: {f'{old} -> {new}' if new else f'took out {old}'}", err=True)


def _report_drift(result: Result) -> None:
    from jausml.language.validation.formats.text import one_line

    for finding in result.drift:
        column = f":{finding.column}" if finding.column else ""
        place = f"{result.plan.out / finding.path}:{finding.line}{column}"
        click.echo(one_line(f"{place}: {finding.severity}: {finding.message}"), err=True)
        if finding.stub:
            click.echo(finding.stub, err=True, nl=not finding.stub.endswith("\n"))


def _report(result: Result, mode: str, *, quiet: bool) -> None:
    from jausml.generation import unified_diff

    plan = result.plan
    if mode == "diff":
        click.echo(unified_diff(plan), nl=False)
    elif verbosity().verbose:
        _list(plan)
    elif not quiet or mode == "check":
        _list_changes(plan)
    for action in plan.refused:
        click.echo(f"{plan.out / action.path}: error: {action.reason}", err=True)
    remark(_summary(result))
    if result.drift and not result.fixed and any(each.edits for each in result.drift):
        remark("--fix changes your files where it is certain how")
    if plan.refused or (mode == "check" and not plan.is_up_to_date):
        raise click.exceptions.Exit(PROBLEMS)


def _list(plan: Plan) -> None:
    for action in plan.actions:
        click.echo(f"{action.kind.value:6} {action.path} ({action.reason})")


def _list_changes(plan: Plan) -> None:
    """Tells what is not kept; many files of a package with one fate are one line."""
    from jausml.generation import ActionKind

    fates: dict[tuple[str, str, str], list[str]] = {}
    for action in plan.actions:
        if action.kind is not ActionKind.KEEP:
            package, _, below = action.path.partition("/")
            fate = (action.kind.value, package if below else "", action.reason)
            fates.setdefault(fate, []).append(action.path)
    for (kind, package, reason), paths in fates.items():
        if package and len(paths) > _FEW:
            click.echo(f"{kind:6} {package}/ ({len(paths)} files, {reason})")
            continue
        for path in paths:
            click.echo(f"{kind:6} {path} ({reason})")


def _summary(result: Result) -> str:
    from jausml.generation import ActionKind

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
