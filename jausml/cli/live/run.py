"""`jausml run`: starts the processes of a generated workspace."""

from __future__ import annotations

import importlib.util
import os
import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from importlib.machinery import PathFinder
from itertools import chain
from pathlib import Path
from typing import Any

import click

from jausml import installing
from jausml.cli.live.build import build_before_run, workspace_of
from jausml.cli.live.supervisor import Command, Supervisor
from jausml.cli.shared.files import PROBLEMS, EnvironmentFault
from jausml.cli.shared.options import FiniteRange

_RUN_MODULE = (
    "import runpy, sys; sys.path = [folder for folder in sys.path if folder]; "
    "runpy.run_module(sys.argv.pop(1), run_name='__main__', alter_sys=True)"
)
"""Python code that does as `-m`, without the current folder: a script there may hide a package."""
_MODULE = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*", re.ASCII)


@dataclass(frozen=True)
class ProcessEntry:
    """A process of a workspace.

    Attributes:
        kind: `bridge`, `component`, or `node` for one that speaks ROS alone.
        module: What Python runs.
        package: The package that it is of, whose `package.xml` says what it needs.
        parameters: File of ROS parameters in the workspace; empty for none.
        domain: ROS domain.
    """

    name: str
    kind: str
    module: str
    package: str = ""
    arguments: tuple[str, ...] = ()
    parameters: str = ""
    domain: int = 0

    @property
    def speaks_jaus(self) -> bool:
        """Whether it is a component or a bridge."""
        return self.kind != "node"

    @property
    def speaks_ros(self) -> bool:
        """Whether it is a ROS node or a bridge."""
        return self.kind != "component"


def process_entries(folder: Path) -> Sequence[ProcessEntry]:
    """Returns the processes of a workspace, in the order of its manifest.

    Raises:
        EnvironmentFault: The manifest cannot be read, or does not say what runs.
    """
    from jausml.generation.manifest import read_manifest

    manifest = read_manifest(folder)
    if manifest.problem:
        raise EnvironmentFault(f"{folder}: {manifest.problem}; generate it again")
    lists = [facts["processes"] for facts in manifest.models.values() if "processes" in facts]
    try:
        entries = [_entry(fields) for fields in chain(*lists)]
    except (TypeError, KeyError, AttributeError):
        lists = []
    if not lists:
        raise EnvironmentFault(f"{folder}: the manifest lists no processes; generate it again")
    # A component that two models have is one process.
    return list({entry.name: entry for entry in entries}.values())


def _entry(fields: Any) -> ProcessEntry:
    """Returns a process as the manifest has it (`TypeError`, `KeyError`: it is damaged)."""
    name, kind, module = (fields[key] for key in ("name", "kind", "module"))
    package, parameters = (fields.get(key, "") for key in ("package", "parameters"))
    arguments, domain = fields.get("arguments", []), fields.get("domain", 0)
    texts = (name, kind, module, package, parameters, *arguments)
    is_sound = isinstance(arguments, list) and isinstance(domain, int)
    if not is_sound or not all(isinstance(text, str) for text in texts):
        raise TypeError("a value is of another type")
    # Python would take an option, or a statement, for what it runs.
    if not _MODULE.fullmatch(module):
        raise TypeError("no name of a module")
    return ProcessEntry(name, kind, module, package, tuple(arguments), parameters, domain)


@click.command("run", context_settings={"ignore_unknown_options": True})
@click.argument("out", metavar="OUT")
@click.argument(
    "rest", metavar="[PROCESS] [ARGUMENTS]...", nargs=-1, type=click.UNPROCESSED, required=False
)
@click.option("--only", multiple=True, metavar="NAME", help="Start only this process.")
@click.option(
    "--for",
    "duration",
    type=FiniteRange(min=0, min_open=True),
    metavar="SECONDS",
    help="Stop all processes after this time.",
)
@click.option(
    "--frequency",
    type=FiniteRange(0.02, 1092),
    metavar="HZ",
    help="Frequency of the bridges, for connections that state no rate.",
)
def command(
    out: str,
    rest: tuple[str, ...],
    only: tuple[str, ...],
    duration: float | None,
    frequency: float | None,
) -> None:
    """Start the processes of the generated workspace OUT, and mark each line with its process.

    If PROCESS names one of the processes, only that one runs. ARGUMENTS are passed on as in `ros2
    run`. With PROCESS, they all go to it. Without PROCESS, those before --ros-args go to all
    processes that speak JAUS, and those from --ros-args on to all ROS nodes. For example:

        jausml run ws rover --jaus-id 100.2.10 --ros-args -r cmd_vel:=/base -p drive.rate:=5.0

    --frequency means what it means to `jausml generate`: how many reports each second connections
    and joins ask for to which neither the model nor a parameter NAME.rate gives a rate.

    Arguments after -- are never options of this command.

    The translations of bridges are compiled first, if that has not been done and there is a
    compiler (see `jausml build`).

    The environment (ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE, ...) is passed on unchanged. If
    ROS_DOMAIN_ID is not set, the ROS domain of the model is used. All processes stop when one of
    them ends with an error, on Ctrl-C and on SIGTERM, and when this command is killed. Pressing
    Ctrl-C again is safe, and stops the processes more forcefully.

    Exit status: 0 all ended normally or were stopped, 1 a process failed, 2 OUT is not a generated
    workspace, rclpy or a message package is missing, or the environment does not allow ROS, 3
    internal error.
    """
    folder = workspace_of(out)
    process, arguments = split_arguments(rest)
    if process and only:
        raise click.UsageError("name the processes by PROCESS or by --only, not by both")
    entries = _chosen(process_entries(folder), (*only, *process))
    passed = process_arguments(entries, arguments, is_named=bool(process))
    if frequency is not None:
        passed = with_frequency(entries, passed, frequency)
    environment = _environment(folder)
    if any(entry.speaks_ros for entry in entries):
        _require_ros()
        require_packages(entries, folder, environment["PYTHONPATH"])
        build_before_run(folder, [entry.module.partition(".")[0] for entry in entries])
    supervisor = Supervisor(
        [_command(entry, folder, more) for entry, more in zip(entries, passed, strict=True)],
        environment=environment,
        emit=click.echo,
    )
    if not supervisor.run(duration):
        for name, reason in supervisor.failures:
            click.echo(f"jausml: {name} {reason}", err=True)
        raise click.exceptions.Exit(PROBLEMS)


def _chosen(entries: Sequence[ProcessEntry], only: tuple[str, ...]) -> Sequence[ProcessEntry]:
    names = [entry.name for entry in entries]
    unknown = [name for name in only if name not in names]
    if unknown:
        raise click.UsageError(f"no process '{unknown[0]}'; there are {', '.join(names) or 'none'}")
    chosen = [entry for entry in entries if not only or entry.name in only]
    if not chosen:
        raise EnvironmentFault("the workspace has no processes")
    return chosen


def _require_ros() -> None:
    from jausml.runtime.bridge.ros.environment import environment_fault

    if importlib.util.find_spec("rclpy") is None:
        raise EnvironmentFault(
            f"rclpy is missing: source a ROS 2 installation, or {installing.command('ros')}"
        )
    fault = environment_fault()
    if fault:
        raise EnvironmentFault(fault)


def _command(entry: ProcessEntry, folder: Path, passed: ProcessArguments) -> Command:
    arguments = [*entry.arguments, *passed.own]
    if entry.parameters:
        arguments += ["--ros-args", "--params-file", str(folder / entry.parameters)]
    # The last one wins in ROS: what the user says overrides the generated file.
    arguments += passed.ros
    return Command(
        entry.name,
        (sys.executable, "-u", "-c", _RUN_MODULE, entry.module, *arguments),
        {"ROS_DOMAIN_ID": str(entry.domain)},
    )


def _environment(folder: Path) -> dict[str, str]:
    """Returns our environment with the packages of the workspace on Python's path."""
    packages = sorted(
        str(package) for package in folder.iterdir() if (package / package.name).is_dir()
    )
    inherited = os.environ.get("PYTHONPATH", "")
    path = os.pathsep.join([*packages, *([inherited] if inherited else [])])
    return {**os.environ, "PYTHONPATH": path}


_INTERFACES = ("msg", "srv", "action")
_MESSAGE_SUFFIX = "_msgs"


def require_packages(entries: Sequence[ProcessEntry], folder: Path, python_path: str) -> None:
    """Refuses to start processes whose messages nobody has built or installed."""
    path = [*filter(None, python_path.split(os.pathsep)), *sys.path]
    for entry in entries:
        for name in _dependencies(folder / entry.package / "package.xml"):
            is_own = any((folder / name / kind).is_dir() for kind in _INTERFACES)
            # Without an __init__ it is the folder of definitions beside us, or nothing at all.
            spec = PathFinder.find_spec(name, path)
            if (is_own or name.endswith(_MESSAGE_SUFFIX)) and (spec is None or spec.origin is None):
                raise EnvironmentFault(
                    f"{entry.name} needs {name}, {_remedy(name, folder, is_own)}"
                )


def _remedy(name: str, folder: Path, is_own: bool) -> str:
    from jausml.language.model.library import has_package
    from jausml.live.machine.ros import package_cure

    if not (is_own or has_package(name)):
        return (
            "which Python does not find: it is a package of yours, or was imported: run"
            f" `colcon build` where the sources of {name} are, source install/setup.bash,"
            " then run this again"
        )
    if not is_own:
        return (
            "which Python does not find: source a ROS 2 installation that has it, or"
            f" {package_cure(name)}"
        )
    root = folder.parent if folder.name == "src" else folder
    return (
        "whose messages are not built yet: in a shell with ROS 2, run `colcon build` in"
        f" {root} and source install/setup.bash, then run this again"
    )


def _dependencies(file: Path) -> Iterator[str]:
    """Yields the names of packages that a package.xml says its package needs to run."""
    from lxml import etree

    if not file.is_file():
        return
    parser = etree.XMLParser(resolve_entities=False, no_network=True)
    try:
        root = etree.parse(file, parser).getroot()
    except etree.XMLSyntaxError:
        return
    for element in root.iter("depend", "exec_depend"):
        if element.text:
            yield element.text.strip()


_ROS_ARGUMENTS = "--ros-args"
_IDENTITY = "--jaus-id"


@dataclass(frozen=True, slots=True)
class ProcessArguments:
    """Arguments for one process.

    `ros`: for ROS, `--ros-args` included; empty when there are none.
    """

    own: tuple[str, ...] = ()
    ros: tuple[str, ...] = ()


def split_arguments(rest: Sequence[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Returns the name of the process, if there is one, and the arguments."""
    number = 1 if rest and not rest[0].startswith("-") else 0
    return tuple(rest[:number]), tuple(rest[number:])


def process_arguments(
    entries: Sequence[ProcessEntry], arguments: Sequence[str], *, is_named: bool
) -> list[ProcessArguments]:
    """Returns the arguments of each process, in the order of the processes."""
    has_ros = _ROS_ARGUMENTS in arguments
    ros_start = arguments.index(_ROS_ARGUMENTS) if has_ros else len(arguments)
    own, ros = tuple(arguments[:ros_start]), tuple(arguments[ros_start:])
    jaus = [entry.name for entry in entries if entry.speaks_jaus]
    nodes = [entry.name for entry in entries if entry.speaks_ros]
    if own and not own[0].startswith("-"):
        raise click.UsageError(f"'{own[0]}' is no option of a process")
    if own and not jaus and not is_named:
        raise click.UsageError(f"no process speaks JAUS, which {own[0]} is for")
    if ros and not nodes:
        raise click.UsageError(f"no process is a ROS node, which {_ROS_ARGUMENTS} is for")
    if len(jaus) > 1 and any(argument.partition("=")[0] == _IDENTITY for argument in own):
        names = ", ".join(jaus)
        raise click.UsageError(f"name the process that gets this {_IDENTITY}: one of {names}")
    return [
        ProcessArguments(
            own if is_named or entry.name in jaus else (), ros if entry.name in nodes else ()
        )
        for entry in entries
    ]


def with_frequency(
    entries: Sequence[ProcessEntry], passed: Sequence[ProcessArguments], frequency: float
) -> list[ProcessArguments]:
    """Returns the arguments of each process, the frequency before the ROS arguments of bridges."""
    if not any(entry.kind == "bridge" for entry in entries):
        raise click.UsageError("no process is a bridge, which --frequency is for")
    # A number without a point is an integer to ROS, which the parameter is not.
    frequency_arguments = (_ROS_ARGUMENTS, "-p", f"frequency:={frequency!r}")
    return [
        replace(arguments, ros=(*frequency_arguments, *arguments.ros))
        if entry.kind == "bridge"
        else arguments
        for entry, arguments in zip(entries, passed, strict=True)
    ]
