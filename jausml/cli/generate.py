"""`jausml generate`: validates a model and writes a workspace from it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import click

from jausml.cli.common import PROBLEMS, EnvironmentFault, find_models
from jausml.generation import (
    ActionKind,
    Artifact,
    Finding,
    GenerationError,
    InternalError,
    LibraryTarget,
    Manifest,
    Plan,
    RefusedError,
    Target,
    WriteError,
    apply,
    drift,
    is_on_request,
    load_targets,
    make_plan,
    needs_system,
    read_manifest,
    render,
    unified_diff,
)
from jausml.metamodel.classes import bridge, system
from jausml.model import ReadResult, read_models
from jausml.text.notation import NOTATIONS, SUFFIX
from jausml.validation.engine import check
from jausml.validation.formats import text
from jausml.validation.formats.text import one_line
from jausml.validation.rules.jaus.components import MAXIMUM_RATE

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from jausml.model.model import Model

_MODES = ("check", "diff", "dry_run")
_EXAMPLE = """\
bridge front {{
  address: <subsystem>.<node>.<component>
  connection {map} {{ map: {map}  peers: <component>  topic {map} {{ }} }}
}}"""


@runtime_checkable
class LaunchingTarget(Protocol):
    """A target that knows which processes a workspace has."""

    def processes(self, model: Any) -> Sequence[Mapping[str, Any]]:
        """Returns what `jausml run` starts, as the manifest records it."""


@click.command("generate")
@click.argument("model", metavar="MODEL")
@click.option(
    "-o",
    "--out",
    metavar="OUT",
    help="Output folder; by default <name of the model file>_ws/src, a colcon workspace.",
)
@click.option("--target", "names", multiple=True, metavar="NAME", help="Only this target.")
@click.option(
    "--all",
    "whole_library",
    is_flag=True,
    help="With --target wireshark: every message of the library, not only those of the system;"
    " with --target ros_interfaces: every message of the services that the system uses.",
)
@click.option("--check", is_flag=True, help="Write nothing; fail when something would change.")
@click.option("--diff", is_flag=True, help="Write nothing; show what would change as a patch.")
@click.option("--dry-run", is_flag=True, help="Write nothing; list what would happen.")
@click.option("--force", is_flag=True, help="Overwrite generated files that were edited.")
@click.option(
    "--frequency",
    type=float,
    metavar="HZ",
    help="Frequency of every bridge, for connections that state no rate of their own.",
)
@click.option("--project-root", metavar="DIR", type=click.Path(exists=True, file_okay=False))
@click.option("--allow-outside", is_flag=True, help="Let references leave the project root.")
@click.option("-q", "--quiet", is_flag=True, help="Do not list files that stay as they are.")
def command(
    model: str,
    out: str | None,
    names: tuple[str, ...],
    whole_library: bool,
    force: bool,
    frequency: float | None,
    project_root: str | None,
    allow_outside: bool,
    quiet: bool,
    **modes: bool,
) -> None:
    """Generate a workspace from the system in MODEL.

    The model is validated first. Files of yours (skeletons) are written once and never again.

    Exit status: 0 done (--check: up to date), 1 problems in the model, a refused file (--check: or
    something would change), 2 usage or environment, 3 internal error.
    """
    chosen = [mode for mode in _MODES if modes[mode]]
    if len(chosen) > 1:
        raise click.UsageError("--check, --diff and --dry-run exclude each other")
    if frequency is not None and not 0 < frequency <= MAXIMUM_RATE:
        raise click.UsageError(f"--frequency is above 0 and at most {MAXIMUM_RATE:g} hertz")
    folder = _out_folder(model, out)
    installed = _installed()
    targets = _targets(names, installed)
    if whole_library:
        targets = _for_whole_library(targets)
    read = _read(model, project_root, allow_outside=allow_outside)
    if frequency is not None:
        for owner in read.model.instances(bridge.Bridge):
            owner.frequency = frequency
    valid = _valid_model(read)
    if any(needs_system(target) for target in targets):
        _require_system(model, valid)
    artifacts = _rendered(valid, targets)
    manifest = read_manifest(folder)
    plan = make_plan(
        artifacts,
        folder,
        manifest,
        targets=_covered(targets, manifest, installed) if not names else set(names),
        force=force,
        extra=_extra(valid, targets),
    )
    findings = drift(artifacts, folder, manifest)
    _report_drift(findings, folder)
    _act(plan, chosen[0] if chosen else "write", quiet=quiet)


def _out_folder(model: str, out: str | None) -> Path:
    folder = Path(out) if out is not None else Path(f"{Path(model).stem}_ws", "src")
    if folder.exists() and not folder.is_dir():
        raise EnvironmentFault(f"{click.format_filename(folder)} is no folder")
    return folder


def _read(path: str, project_root: str | None, *, allow_outside: bool) -> ReadResult:
    if Path(path).is_dir():
        raise EnvironmentFault(f"{click.format_filename(path)} is a folder; name one model file")
    return read_models(
        find_models([path]),
        project_root=project_root,
        allow_outside=allow_outside,
        notations=NOTATIONS,
    )


def _valid_model(read: ReadResult) -> Model:
    report = check(read)
    click.echo(text.render(report), nl=False, err=True)
    if report.has_errors:
        click.echo(f"{text.summary(report)}; nothing generated", err=True)
        raise click.exceptions.Exit(PROBLEMS)
    return report.model


def _require_system(path: str, model: Model) -> None:
    systems = [root for root in model.documents[0].roots if isinstance(root, system.System)]
    if len(systems) == 1:
        return
    name = click.format_filename(path)
    maps = model.instances(bridge.AttributeMap, library=False)
    if maps and not systems and path.endswith(SUFFIX):
        message = f"{name} holds maps, but no bridge that uses them; add one, for example:"
        raise EnvironmentFault(f"{message}\n\n{_EXAMPLE.format(map=maps[0].name)}")
    found = f"holds {len(systems)} systems" if systems else "holds no system"
    raise EnvironmentFault(f"{name} {found}; generate needs one")


def _installed() -> dict[str, Target[Any]]:
    try:
        return load_targets()
    except GenerationError as error:
        raise EnvironmentFault(str(error)) from error


def _targets(names: tuple[str, ...], installed: Mapping[str, Target[Any]]) -> list[Target[Any]]:
    unknown = [name for name in names if name not in installed]
    if unknown:
        known = ", ".join(installed) or "none"
        raise click.UsageError(f"no target '{unknown[0]}'; installed: {known}")
    usual = (name for name, target in installed.items() if not is_on_request(target))
    return [installed[name] for name in sorted(set(names) or usual)]


def _for_whole_library(targets: Sequence[Target[Any]]) -> list[Target[Any]]:
    if not any(isinstance(target, LibraryTarget) for target in targets):
        raise click.UsageError("--all is an option of --target wireshark and ros_interfaces")
    return [
        target.for_whole_library() if isinstance(target, LibraryTarget) else target
        for target in targets
    ]


def _covered(
    targets: Sequence[Target[Any]], manifest: Manifest, installed: Mapping[str, Target[Any]]
) -> set[str]:
    """Returns the targets whose files a run without --target answers for.

    Those of targets that are no longer installed are among them: nothing produces their files any
    more. Files of a target that runs on request stay as they are.
    """
    asked = {name for name, target in installed.items() if is_on_request(target)}
    written = {entry.target for entry in manifest.files.values()}
    return {target.name for target in targets} | (written - asked)


def _rendered(model: Model, targets: Sequence[Target[Any]]) -> list[Artifact]:
    try:
        return render(model, targets)
    except InternalError:
        raise
    except GenerationError as error:
        # A target's view found what no rule demands.
        raise click.ClickException(f"cannot generate from this model: {error}") from error


def _extra(model: Model, targets: Sequence[Target[Any]]) -> dict[str, Any]:
    launching = [target for target in targets if isinstance(target, LaunchingTarget)]
    if not launching:
        return {}
    return {"processes": [dict(each) for target in launching for each in target.processes(model)]}


def _report_drift(findings: Sequence[Finding], folder: Path) -> None:
    for finding in findings:
        place = f"{folder / finding.path}:{finding.line}"
        click.echo(one_line(f"{place}: {finding.severity}: {finding.message}"), err=True)
        if finding.stub:
            click.echo(finding.stub, err=True, nl=not finding.stub.endswith("\n"))


def _act(plan: Plan, mode: str, *, quiet: bool) -> None:
    if mode == "diff":
        click.echo(unified_diff(plan), nl=False)
    else:
        _list(plan, quiet=quiet)
    for action in plan.refused:
        click.echo(f"{plan.out / action.path}: error: {action.reason}", err=True)
    if mode == "write" and not plan.refused:
        try:
            apply(plan)
        except (RefusedError, WriteError) as error:
            raise EnvironmentFault(f"cannot write into {plan.out}: {error}") from error
    click.echo(_summary(plan, mode), err=True)
    if plan.refused or (mode == "check" and not plan.is_up_to_date):
        raise click.exceptions.Exit(PROBLEMS)


def _list(plan: Plan, *, quiet: bool) -> None:
    for action in plan.actions:
        if not (quiet and action.kind is ActionKind.KEEP):
            click.echo(f"{action.kind.value:6} {action.path} ({action.reason})")


def _summary(plan: Plan, mode: str) -> str:
    words = {
        ActionKind.CREATE: "to create" if mode != "write" or plan.refused else "created",
        ActionKind.UPDATE: "to update" if mode != "write" or plan.refused else "updated",
        ActionKind.DELETE: "to delete" if mode != "write" or plan.refused else "deleted",
        ActionKind.KEEP: "kept",
        ActionKind.ORPHAN: "no longer of the model",
        ActionKind.REFUSE: "refused",
    }
    counts = [f"{len(plan.of(kind))} {word}" for kind, word in words.items() if plan.of(kind)]
    end = "; nothing written" if plan.refused else ""
    return f"{', '.join(counts)} in {click.format_filename(plan.out)}{end}"
