"""The terminal: remarks, colours, the progress of steps, questions, and keys that are pressed."""

from __future__ import annotations

import os
import re
import select
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from threading import Thread
from typing import TextIO, TypeVar

import click

ResultT = TypeVar("ResultT")

PATIENCE = 1.0
"""Seconds that a step may take before a terminal shows that it goes on."""
_PERIOD = 0.25
_COLOURS = {"error": "red", "warning": "yellow", "note": "cyan", "ok": "green"}
_SEVERITY = re.compile("^(.*?): (error|warning|note): ", re.MULTILINE)
_CLEAR = "\r\x1b[K"


@dataclass(frozen=True)
class Verbosity:
    """The options in front of the verb.

    `quiet`: results and problems alone; no summaries, no remarks, no progress.
    """

    quiet: bool = False
    verbose: bool = False


def verbosity() -> Verbosity:
    """Returns the chosen verbosity, or the usual one."""
    context = click.get_current_context(silent=True)
    return (context and context.find_object(Verbosity)) or Verbosity()


def colour_allowed() -> bool:
    """Whether terminals may be coloured: not where NO_COLOR is set (no-color.org)."""
    return not os.environ.get("NO_COLOR")


def painted(word: str, shown: str = "") -> str:
    """Returns a verdict in its colour; terminals alone are given it (click).

    `word`: `error`, `warning`, `note` or `ok`.
    """
    return click.style(shown or word, fg=_COLOURS[word], bold=word == "error")


def painted_findings(text: str) -> str:
    """Returns the findings of a report with their severities in colour."""
    return _SEVERITY.sub(lambda match: f"{match[1]}: {painted(match[2])}: ", text)


def remark(text: str) -> None:
    """Shows a remark on stderr, unless `--quiet` is stated."""
    if not verbosity().quiet:
        click.echo(text, err=True)


def warn(text: str) -> None:
    """Shows a warning on stderr, whatever the options."""
    click.echo(text, err=True)


class Progress:
    """How far a step has come, as far as it can tell.

    `share`: part of the step that is done, 0 to 1; None where nobody knows. `note`: returns what
    else is told of it, empty for nothing; called on another thread.
    """

    def __init__(self) -> None:
        self.share: float | None = None
        self.note: Callable[[], str] = str

    def at(self, share: float) -> None:
        """Takes how much is done.

        `share`: 0 to 1.
        """
        self.share = min(max(share, 0.0), 1.0)


@contextmanager
def step(label: str, *, prints: bool = False) -> Iterator[Progress]:
    """Shows the progress of a step on a terminal once it takes long.

    With `--verbose` the time that it took is told at its end, in logs too. `prints`: whether the
    step writes results; these are progress enough on a terminal.
    """
    progress = Progress()
    asked = verbosity()
    begun = time.monotonic()
    with _shown(label, progress, begun) if _is_watched(asked, prints) else nullcontext():
        yield progress
    if asked.verbose:
        click.echo(f"{label}: {time.monotonic() - begun:.2f} s", err=True)


def gathered(label: str, total: int, results: Iterable[tuple[int, ResultT]]) -> list[ResultT]:
    """Returns numbered results in order, and shows how many there are while they come."""
    results_by_number: dict[int, ResultT] = {}
    with step(label) as progress:
        progress.note = lambda: f"{len(results_by_number)} of {total}"
        for number, result in results:
            results_by_number[number] = result
            progress.at(len(results_by_number) / total)
    return [results_by_number[number] for number in sorted(results_by_number)]


def _is_watched(asked: Verbosity, prints: bool) -> bool:
    if asked.quiet or os.environ.get("TERM") == "dumb" or not sys.stderr.isatty():
        return False
    return not (prints and sys.stdout.isatty())


@contextmanager
def _shown(label: str, progress: Progress, begun: float) -> Iterator[None]:
    ended = threading.Event()
    stream = sys.stderr
    teller = threading.Thread(
        target=_show_progress, args=(label, progress, begun, ended, stream), daemon=True
    )
    teller.start()
    try:
        yield
    finally:
        ended.set()
        teller.join()


def _show_progress(
    label: str, progress: Progress, begun: float, ended: threading.Event, stream: TextIO
) -> None:
    """Shows a step until it has ended, from its patience on, and wipes the line."""
    if ended.wait(PATIENCE):
        return
    while True:
        seconds = int(time.monotonic() - begun)
        share = "" if progress.share is None else f" {progress.share:.0%},"
        note = f" {said}," if (said := progress.note()) else ""
        _write(stream, f"{_CLEAR}{label} ...{share}{note} {seconds} s")
        if ended.wait(_PERIOD):
            break
    _write(stream, _CLEAR)


def _write(stream: TextIO, text: str) -> None:
    # A terminal that has gone ends nothing.
    try:
        stream.write(text)
        stream.flush()
    except OSError:
        pass


_NONE = "0"


def can_ask() -> bool:
    """Tells whether a person at a terminal can be asked."""
    return sys.stdin.isatty() and sys.stderr.isatty()


def choose_one(question: str, options: Sequence[str]) -> int | None:
    """Asks for one of several options; returns its position, None for none."""
    return next(iter(choose(question, options, is_one=True)), None)


def choose(question: str, options: Sequence[str], *, is_one: bool = False) -> list[int]:
    """Asks for some of several options; returns their positions, none where none is wanted."""
    click.echo(question, err=True)
    for number, option in enumerate(options, start=1):
        click.echo(f"  {number}  {option}", err=True)
    click.echo(f"  {_NONE}  none of these", err=True)

    def numbers(text: str) -> list[int]:
        words = [word for word in re.split(r"[\s,]+", text.strip()) if word]
        if words == [_NONE]:
            return []
        indices = [int(word) - 1 for word in words if word.isascii() and word.isdigit()]
        if (
            not words
            or len(indices) != len(words)
            or not all(0 <= index < len(options) for index in indices)
            or (is_one and len(words) > 1)
        ):
            wanted = "a number" if is_one else "numbers"
            raise click.BadParameter(f"give {wanted} from 1 to {len(options)}, or {_NONE} for none")
        return list(dict.fromkeys(indices))

    chosen: list[int] = click.prompt(
        "Which (number)" if is_one else "Which (numbers)", "1", value_proc=numbers, err=True
    )
    return chosen


@contextmanager
def pressed(take: Callable[[str], None]) -> Iterator[bool]:
    """Has keys taken while a block runs, and says whether there are any: not without a terminal.

    `take`: takes each, on another thread.
    """
    if not _has_terminal():
        yield False
        return
    import termios
    import tty

    keyboard = sys.stdin.fileno()
    former = termios.tcgetattr(keyboard)
    ended, end = os.pipe()
    reader = Thread(target=_read, args=(keyboard, ended, take), daemon=True)
    tty.setcbreak(keyboard)
    reader.start()
    try:
        yield True
    finally:
        os.close(end)
        reader.join()
        os.close(ended)
        if _has_terminal():
            termios.tcsetattr(keyboard, termios.TCSADRAIN, former)


def _has_terminal() -> bool:
    """Whether stdin is a terminal, and we are before it: in the background we would be stopped."""
    try:
        keyboard = sys.stdin.fileno()
        if not os.isatty(keyboard):
            return False
    except (AttributeError, OSError, ValueError):  # it was closed
        return False
    try:
        return os.tcgetpgrp(keyboard) == os.getpgrp()
    except AttributeError:  # Windows
        return False
    except OSError:  # nobody's terminal stops nobody
        return True


def _read(keyboard: int, ended: int, take: Callable[[str], None]) -> None:
    while True:
        ready, _, _ = select.select([keyboard, ended], [], [])
        if ended in ready:
            return
        try:
            data = os.read(keyboard, 64)
        except OSError:  # the terminal has gone
            return
        if not data:
            return
        for key in data.decode(errors="replace"):
            take(key)
