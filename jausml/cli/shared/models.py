"""Models of the verbs: options of reading them, and one call that reads and judges them."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import click

from jausml.cli.shared.files import PROBLEMS, ending_at
from jausml.cli.shared.options import FiniteRange, refuse_options
from jausml.cli.shared.terminal import painted_findings, step, warn

if TYPE_CHECKING:
    from jausml.language.metamodel.classes.system import System
    from jausml.language.model import Model, ReadResult
    from jausml.language.model.project import Reading
    from jausml.language.validation.rule import Report
    from jausml.live.messages.defined import DefinedCatalogue

SUFFIXES = (".xmi", ".ros2jaus")
"""The endings of model files."""

model_option = click.option(
    "--model",
    "models",
    multiple=True,
    metavar="FILE",
    help="Also use the messages of a model, or of all models below a folder; by default, those of "
    "the project of the current folder. May be repeated.",
)


def model_argument(command: Callable[..., None]) -> Callable[..., None]:
    """Adds MODEL, by default the one in the project of the current folder that has a system."""
    callback = or_only_system("MODEL")
    return click.argument(
        "model", metavar="[MODEL]", required=False, default="", callback=callback
    )(command)


def optional_model_argument(command: Callable[..., None]) -> Callable[..., None]:
    """Adds MODEL to a verb that does without one where no project is around."""
    return click.argument(
        "model", metavar="[MODEL]", required=False, callback=_or_system_of_project
    )(command)


def _or_system_of_project(_: click.Context, __: click.Parameter, value: str | None) -> str | None:
    from jausml.language.project import Index

    index = None if value or not is_in_project() else Index.here()
    if index is None or not index.files_with_systems:
        return value
    with _usable_input():
        return from_here(index.only_system())


def or_only_system(argument: str) -> Callable[..., str]:
    """Returns a callback for the value of an argument, by default the only system that is here."""
    return lambda _context, _parameter, value: value or only_system(argument)


def only_system(argument: str) -> str:
    """Returns the model in the project of the current folder that has a system.

    `argument`: what would name another one.
    """
    from jausml.language.project import Index

    with _usable_input():
        return from_here(Index(_project(argument)).only_system())


def models_argument(command: Callable[..., None]) -> Callable[..., None]:
    """Adds PATH..., by default the project of the current folder."""
    return click.argument(
        "paths", nargs=-1, metavar="[PATH]...", callback=lambda _, __, paths: paths or (project(),)
    )(command)


def project() -> str:
    """Returns the folder of the project of the current folder, for a verb without a PATH."""
    return from_here(_project("PATH"))


def _project(argument: str) -> Path:
    """Returns the folder of the project of the current folder."""
    from jausml.language.model.project import project_folder

    folder = project_folder(Path.cwd() / "any")
    if folder is None:
        raise click.UsageError(
            f"Missing argument '{argument}': no project is here; 'jausml init DIR' makes one."
        )
    return folder


def from_here(path: Path) -> str:
    """Returns a path as it is best named from the current folder."""
    here = Path.cwd()
    return str(path.relative_to(here)) if path.is_relative_to(here) else str(path)


def is_in_project() -> bool:
    """Tells whether `jausml init` made the folder around the current one."""
    from jausml.language.model.project import made_project

    return made_project(Path.cwd()) is not None


def project_files() -> list[str]:
    """Returns the models of the project of the current folder, none where it is in none."""
    if not is_in_project():
        return []
    from jausml.language.project import Index

    index = Index.here()
    return [from_here(index.root / content) for content in sorted(index.contents)] if index else []


class ModelFault(click.ClickException):
    """A model has errors."""

    exit_code = PROBLEMS


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
        bridge_address: str | None = None,
        bridge_frequency: float | None = None,
        **others: object,
    ) -> None:
        from jausml.language.model.project import Reading

        if bridge_address is None:
            refuse_options("only with --bridge-address", "bridge_frequency")
        reading = Reading(project_root, allow_outside, projects, bridge_address, bridge_frequency)
        command(*arguments, reading=reading, **others)

    return with_reading


def _projects(_: click.Context, __: click.Parameter, values: tuple[str, ...]) -> dict[str, str]:
    folders_by_name = {}
    for value in values:
        name, sign, folder = value.partition("=")
        if not (name and sign and Path(folder).is_dir()):
            raise click.BadParameter(f"'{value}' is not NAME=DIR with an existing folder")
        folders_by_name[name] = folder
    return folders_by_name


def bridge_options(command: Callable[..., None]) -> Callable[..., None]:
    """Adds the option of a bridge of all maps, which `reading_options` hand on."""
    return click.option(
        "--bridge-address",
        metavar="ID",
        help="Make a bridge with this JAUS id that carries all maps of the file in both "
        "directions.",
    )(command)


def frequency_option(command: Callable[..., None]) -> Callable[..., None]:
    """Adds the frequency of the bridge of `bridge_options`."""
    return click.option(
        "--frequency",
        "bridge_frequency",
        type=FiniteRange(0, 1092, min_open=True),
        metavar="HZ",
        help="Frequency of the bridge of --bridge-address.",
    )(command)


@contextmanager
def _usable_input() -> Iterator[None]:
    """Ends the verb where its input cannot be used."""
    from jausml.language.model.project import InputError

    with ending_at(InputError):
        yield


def checked(
    paths: Iterable[str],
    reading: Reading | None = None,
    *,
    is_one: bool = False,
    frequency: float | None = None,
) -> Report:
    """Returns models that were read and judged, as `check_project` has it."""
    from jausml.language.validation.engine import check_project

    with _usable_input(), step("checking the model" if is_one else "checking models"):
        return check_project(paths, reading, is_one=is_one, frequency=frequency)


def read(
    paths: Iterable[str], reading: Reading | None = None, *, is_one: bool = False
) -> ReadResult:
    """Returns models that were read and not judged, for verbs that take them as they are."""
    from jausml.language.project import read_project

    with _usable_input():
        return read_project(paths, reading, is_one=is_one)


def valid_model(path: str, reading: Reading | None = None, *, outcome: str = "") -> Model:
    """Returns a model without errors; any other ends the verb, with its findings on stderr.

    `outcome`: what stands behind the summary, such as `nothing generated`.
    """
    report = checked([path], reading, is_one=True)
    if report.has_errors:
        show_findings(report)
        fail(report, outcome)
    return report.model


def valid_system(path: str, reading: Reading) -> tuple[Model, System]:
    """Returns a model without errors and its system; any other ends the verb."""
    from jausml.generation.errors import NoSystemError
    from jausml.generation.target import system_of

    model = valid_model(path, reading)
    with ending_at(NoSystemError):
        return model, system_of(model)


def readable_model(
    paths: Iterable[str], reading: Reading | None = None, *, is_one: bool = False
) -> Model:
    """Returns models that could be read without an error, whatever the rules find."""
    from jausml.language.model import Severity
    from jausml.language.validation.formats.text import one_line

    result = read(paths, reading, is_one=is_one)
    errors = [error for error in result.diagnostics if error.severity is Severity.ERROR]
    if errors:
        raise ModelFault(
            "\n".join(
                one_line(f"{error.location}: {error.rule} {error.message}") for error in errors
            )
        )
    return result.model


def beside_library(ready: Iterable[Path], models: Sequence[str], what: str) -> Model:
    """Returns files of the library and models, by default those of the current project.

    Of the project those that cannot be read are left out, and that is told. `what`: what of them
    is wanted.
    """
    from jausml.language.model.project import Reading, find_project_root
    from jausml.language.project import find_models
    from jausml.live.messages.of_project import sound_files

    with _usable_input():
        own = find_models(models or project_files())
    shipped = list(map(str, ready))
    reading = Reading(project_root=find_project_root(map(Path, own)))
    try:
        return readable_model([*shipped, *own], reading)
    except ModelFault:
        if models:
            raise
    sound = sound_files(map(Path, own), what, warn)
    return readable_model([*shipped, *map(str, sound)], reading)


def show_findings(report: Report, *, err: bool = True) -> None:
    """Prints the findings of a report, a line each, in colour on terminals."""
    from jausml.language.validation.formats import text

    click.echo(painted_findings(text.render(report)), nl=False, err=err)


def fail(report: Report, outcome: str = "", *, quiet: bool = False) -> NoReturn:
    """Ends a verb for the findings of a report, with their summary."""
    from jausml.language.validation.formats import text

    if not quiet:
        click.echo("; ".join(filter(None, (text.summary(report), outcome))), err=True)
    raise click.exceptions.Exit(PROBLEMS)


def open_catalogue(models: Iterable[str]) -> DefinedCatalogue:
    """Returns the messages of the library, and of the models in files and folders.

    Without any, those of the project of the current folder are known.
    """
    paths = list(models)
    if not paths and is_in_project():
        from jausml.live.messages.of_project import project_catalogue

        return project_catalogue(warn)
    # Options and output of the verbs alone need no reader.
    from jausml.language.text.notation import NOTATIONS
    from jausml.live.messages import CatalogueError, load_catalogue

    model_files: list[str] = []
    if paths:
        from jausml.language.project import find_models

        with _usable_input():
            model_files = find_models(paths)
    try:
        return load_catalogue(model_files, notations=NOTATIONS)
    except CatalogueError as error:
        raise ModelFault(str(error)) from error


def explained(error: Exception, models: Sequence[str]) -> str:
    """Returns the fault of a message, and the origin of the known ones.

    `models`: files and folders whose messages are known too.
    """
    from jausml.live.messages import UnknownServiceError

    if not isinstance(error, UnknownServiceError) or error.suggestions:
        return str(error)
    if models:
        known = f"known are the library and {', '.join(models)}"
    elif is_in_project():
        known = "known are the library and this project: see 'jausml list messages'"
    else:
        known = "messages of your own are known in their project, elsewhere by --model FILE"
    return f"{error} ({known})"
