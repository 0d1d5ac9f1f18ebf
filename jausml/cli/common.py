"""Shared parts of the verbs: finding models, refusing what cannot be done, writing reports."""

from __future__ import annotations

import functools
import math
import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict

import click

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from jausml.language.model.notation import Notation

_ADDRESS = re.compile(r"\d+\.\d+\.\d+")

PROBLEMS = 1
SUFFIXES = (".xmi", ".ros2jaus")
"""The endings of model files."""


class FiniteRange(click.FloatRange):
    """A number in a range, as click has it, which takes `nan` in any and `inf` without an end."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """Returns the number, or tells that it is none."""
        number: float = super().convert(value, param, ctx)
        if not math.isfinite(number):
            self.fail(f"{value!a} is no finite number.", param, ctx)
        return number


class EnvironmentFault(click.ClickException):
    """Something outside the models is wrong: a path, a permission, a missing package."""

    exit_code = 2


class Reading(TypedDict):
    """What `reading_options` hands to a verb, for `read_models` and `validate`."""

    project_root: str | None
    allow_outside: bool
    projects: dict[str, str]


def reading_options(command: Callable[..., None]) -> Callable[..., None]:
    """Adds the options of where references may lead; the verb takes them as `reading`."""

    @click.option(
        "--project-root",
        metavar="DIR",
        type=click.Path(exists=True, file_okay=False),
        help="Folder that references may not leave; by default, the checkout or Eclipse project.",
    )
    @click.option(
        "--allow-outside", is_flag=True, help="Allow references to leave the project root."
    )
    @click.option(
        "--project",
        "projects",
        multiple=True,
        metavar="NAME=DIR",
        callback=_projects,
        help="Folder of an Eclipse project that references name; nearby ones are found "
        "automatically.",
    )
    @functools.wraps(command)
    def with_reading(
        *arguments: object,
        project_root: str | None,
        allow_outside: bool,
        projects: dict[str, str],
        **others: object,
    ) -> None:
        reading = Reading(project_root=project_root, allow_outside=allow_outside, projects=projects)
        command(*arguments, reading=reading, **others)

    return with_reading


def _projects(_: click.Context, __: click.Parameter, values: tuple[str, ...]) -> dict[str, str]:
    found = {}
    for value in values:
        name, sign, folder = value.partition("=")
        if not (name and sign and Path(folder).is_dir()):
            raise click.BadParameter(f"'{value}' is not NAME=DIR with an existing folder")
        found[name] = folder
    return found


def bridge_options(command: Callable[..., None]) -> Callable[..., None]:
    """Adds the option of a bridge of all maps to a verb that reads one model."""
    return click.option(
        "--bridge-address",
        metavar="ID",
        help="Make a bridge with this JAUS id that carries all maps of the file in both "
        "directions.",
    )(command)


def frequency_option(command: Callable[..., None]) -> Callable[..., None]:
    """Adds the frequency of the bridge of `bridge_options` to a verb."""
    return click.option(
        "--frequency",
        type=FiniteRange(0, 1092, min_open=True),
        metavar="HZ",
        help="Frequency of the bridge of --bridge-address.",
    )(command)


def notations_for(
    model: str, bridge_address: str | None, frequency: float | None
) -> tuple[Notation, ...]:
    """Returns what reads a model file that is no XMI, with a bridge of its maps where one is asked.

    Args:
        bridge_address: JAUS id of the bridge, None for none.
        frequency: Messages each second of its events, None for the default.
    """
    # Most verbs take files by their endings alone, which needs no reader.
    from jausml.language.text.bridge_options import BridgeOfMaps
    from jausml.language.text.notation import NOTATIONS, SUFFIX, Ros2Jaus

    if bridge_address is None:
        return NOTATIONS
    if not _ADDRESS.fullmatch(bridge_address):
        raise click.UsageError("--bridge-address is a JAUS id such as 100.1.20")
    if not model.endswith(SUFFIX):
        raise click.UsageError(f"--bridge-address takes the maps of a {SUFFIX} file")
    bridge = BridgeOfMaps(Path(model).resolve(), bridge_address, frequency)
    return (Ros2Jaus(bridge),)


def find_models(paths: Iterable[str]) -> list[str]:
    """Returns model files: files as they are, and the *.xmi and *.ros2jaus files below folders.

    Hidden folders are left out, and the shipped library with its copies in projects, unless a
    folder holds nothing else.
    """
    return [file for path in paths for file in _own_models(_files_at(path, SUFFIXES))]


def _own_models(files: Sequence[str]) -> Sequence[str]:
    """Returns the files that are no copies of the shipped library; all where all are copies."""
    if len(files) == 1:
        return files
    from jausml.language.model.uris import shipped_as

    own = [each for each in files if shipped_as(Path(os.path.realpath(each))) is None]
    return own or files


def one_model(path: str) -> list[str]:
    """Returns the file of a verb that takes one model, in a list as readers take it."""
    if Path(path).is_dir():
        there = min(_walk(path, SUFFIXES), default=None)
        such = f", such as {click.format_filename(there)}" if there else ""
        raise EnvironmentFault(
            f"{click.format_filename(path)} is a folder; name one model file{such}"
        )
    return find_models([path])


def find_files(paths: Iterable[str], suffixes: tuple[str, ...]) -> list[str]:
    """Returns files as they are, and the files with certain endings below folders.

    Hidden folders are left out.
    """
    return [file for path in paths for file in _files_at(path, suffixes)]


def write_report(rendered: str | bytes, output: str | None) -> None:
    """Writes a report or picture to a file, or a report to stdout where none is named."""
    if output is None:
        click.echo(rendered, nl=False)
        return
    if isinstance(rendered, str):
        rendered = rendered.encode("utf-8", errors="backslashreplace")
    try:
        Path(output).write_bytes(rendered)
    except OSError as error:
        name = click.format_filename(output)
        raise EnvironmentFault(f"cannot write {name}: {error.strerror}") from error


def _files_at(path: str, suffixes: tuple[str, ...]) -> Sequence[str]:
    from jausml.language.model.inputs import open_input

    try:
        if os.path.isdir(path):  # noqa: PTH112 - paths stay as the user wrote them
            found = sorted(_walk(path, suffixes))
            _refuse_links(path, found)
            if not found:
                what = " or ".join(suffixes)
                hint = (
                    "; 'jausml init DIR' makes a project of models" if suffixes is SUFFIXES else ""
                )
                raise EnvironmentFault(f"no {what} files in {click.format_filename(path)}{hint}")
            return found
        with open_input(path):
            return [path]
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        near = _near(path, suffixes) if isinstance(error, FileNotFoundError) else ""
        raise EnvironmentFault(f"{click.format_filename(path)}: {reason}{near}") from error


def _refuse_links(folder: str, found: Sequence[str]) -> None:
    """Refuses files of a walk that are links out of the project: nobody has named them."""
    from jausml.language.model.inputs import leads_out
    from jausml.language.model.uris import find_project_root

    links = [each for each in found if os.path.islink(each)]  # noqa: PTH114 - as above
    root = Path(os.path.realpath(find_project_root([Path(folder) / "any"]))) if links else None
    for each in links:
        if root is not None and leads_out(each, root):
            shown = click.format_filename(each)
            raise EnvironmentFault(
                f"{shown}: JML209 the link leads out of the project root {root}; "
                "name the file itself to have it read"
            )


def _near(path: str, suffixes: tuple[str, ...]) -> str:
    """Returns a question for the file that may be meant, empty where none is near."""
    from difflib import get_close_matches

    wanted = Path(path)
    try:
        there = [each.name for each in wanted.parent.iterdir() if each.name.endswith(suffixes)]
    except OSError:
        return ""
    near = get_close_matches(wanted.name, there, n=1)
    return f"; did you mean {click.format_filename(wanted.with_name(near[0]))}?" if near else ""


def _walk(path: str, suffixes: tuple[str, ...]) -> Iterator[str]:
    for folder, subfolders, names in os.walk(path, onerror=_raise):
        subfolders[:] = sorted(name for name in subfolders if not name.startswith("."))
        for name in names:
            if name.endswith(suffixes) and not name.startswith("."):
                yield os.path.normpath(os.path.join(folder, name))  # noqa: PTH118


def _raise(error: OSError) -> None:
    raise error
