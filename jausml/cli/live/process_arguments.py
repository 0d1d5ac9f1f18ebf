"""Command-line arguments for each process of a workspace."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import click

from jausml.cli.live.processes import ProcessEntry

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
    """Returns what each process gets, with the frequency before the ROS arguments of bridges."""
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
