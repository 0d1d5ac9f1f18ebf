"""What `jausml run` hands on to the processes that it starts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

_ROS_ARGUMENTS = "--ros-args"
_IDENTITY = "--jaus-id"


@dataclass(frozen=True, slots=True)
class Handed:
    """Arguments for one process.

    Attributes:
        ros: For ROS, `--ros-args` included; empty when there are none.
    """

    own: tuple[str, ...] = ()
    ros: tuple[str, ...] = ()


def split_arguments(rest: Sequence[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Returns the name of the process, if there is one, and the arguments."""
    number = 1 if rest and not rest[0].startswith("-") else 0
    return tuple(rest[:number]), tuple(rest[number:])


def handed_on(
    entries: Sequence[Mapping[str, Any]], arguments: Sequence[str], *, is_named: bool
) -> list[Handed]:
    """Returns what each process gets."""
    at = arguments.index(_ROS_ARGUMENTS) if _ROS_ARGUMENTS in arguments else len(arguments)
    own, ros = tuple(arguments[:at]), tuple(arguments[at:])
    jaus = [entry["name"] for entry in entries if entry["kind"] != "node"]
    nodes = [entry["name"] for entry in entries if entry["kind"] != "component"]
    if own and not own[0].startswith("-"):
        raise click.UsageError(f"'{own[0]}' is no option of a process")
    if own and not jaus and not is_named:
        raise click.UsageError(f"no process speaks JAUS, which {own[0]} is for")
    if ros and not nodes:
        raise click.UsageError(f"no process is a ROS node, which {_ROS_ARGUMENTS} is for")
    if len(jaus) > 1 and any(each.partition("=")[0] == _IDENTITY for each in own):
        names = ", ".join(jaus)
        raise click.UsageError(f"name the process that gets this {_IDENTITY}: one of {names}")
    return [
        Handed(
            own if is_named or entry["name"] in jaus else (), ros if entry["name"] in nodes else ()
        )
        for entry in entries
    ]
