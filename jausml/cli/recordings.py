"""Shared parts of the verbs that make and replay recordings: the model, the file."""

from __future__ import annotations

import signal
from contextlib import contextmanager
from datetime import datetime, timezone
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import click

from jausml.cli.common import PROBLEMS, EnvironmentFault, find_models, notations_for

if TYPE_CHECKING:
    from collections.abc import Iterator
    from threading import Event

    from jausml.language.model import Model

output_option = click.option("-o", "--output", metavar="FILE", help="MCAP file to write.")
force_option = click.option("--force", is_flag=True, help="Overwrite FILE.")


def valid_model(path: str, bridge_address: str | None = None) -> Model:
    """Returns a model without errors; the others end the verb, with what is wrong.

    Args:
        bridge_address: JAUS id of the bridge of `bridge_options`, None for none.
    """
    from jausml.language.model import read_models
    from jausml.language.validation.engine import check
    from jausml.language.validation.formats import text

    if Path(path).is_dir():
        raise EnvironmentFault(f"{click.format_filename(path)} is a folder; name one model file")
    notations = notations_for(path, bridge_address, None)
    report = check(read_models(find_models([path]), notations=notations))
    if report.has_errors:
        click.echo(text.render(report), nl=False, err=True)
        click.echo(text.summary(report), err=True)
        raise click.exceptions.Exit(PROBLEMS)
    return report.model


@contextmanager
def written(path: str, *, force: bool) -> Iterator[BinaryIO]:
    """Opens a file for writing."""
    try:
        with Path(path).open("wb" if force else "xb") as stream:
            yield stream
    except FileExistsError as error:
        raise already_there(path) from error
    except OSError as error:
        name = click.format_filename(path)
        raise EnvironmentFault(f"cannot write {name}: {error.strerror or error}") from error


def not_itself(recording: str, output: str) -> None:
    """Does nothing where a recording is not written over itself: there is but one of it."""
    try:
        is_same = Path(recording).samefile(output)
    except (OSError, ValueError):  # one is not there, which others tell
        return
    if is_same:
        raise click.UsageError(f"{click.format_filename(output)} would be written over itself")


def already_there(path: str) -> EnvironmentFault:
    """Returns the error of a file that would be overwritten."""
    return EnvironmentFault(
        f"{click.format_filename(path)} is there already; --force overwrites it"
    )


def shown_time(seconds: float) -> str:
    """Returns a time as people read it, of the world and to the millisecond."""
    return datetime.fromtimestamp(seconds, tz=timezone.utc).isoformat(" ", "milliseconds")


@contextmanager
def stopped_by_signals(stop: Event) -> Iterator[None]:
    """Has signals end a recording or a replay in good order, in the midst of nothing.

    They are SIGINT, SIGTERM, and SIGHUP, which comes when the terminal goes, unless that is ignored
    as `nohup` has it.
    """
    numbers = [signal.SIGINT, signal.SIGTERM]
    hang_up = getattr(signal, "SIGHUP", None)  # Windows has none
    if hang_up is not None and signal.getsignal(hang_up) != signal.SIG_IGN:
        numbers.append(hang_up)
    former = [signal.signal(number, lambda *_: stop.set()) for number in numbers]
    try:
        yield
    finally:
        for number, handler in zip(numbers, former, strict=True):
            signal.signal(number, handler)
