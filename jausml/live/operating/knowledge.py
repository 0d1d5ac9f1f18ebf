"""Knowledge of models as plain values for the unit, and the child process that reads them.

The child reads the models again whenever a file changes. This process does not import the language
modules: it would stand still while they work.
"""

from __future__ import annotations

import pickle
import subprocess
import sys
from dataclasses import dataclass, field
from threading import Thread
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from jausml.live.messages.frozen import FrozenMessages
    from jausml.live.systems.state import DeclaredConnection

_READING = "jausml.live.operating.reading"


@dataclass(frozen=True)
class DeclaredStop:
    """The stop of a repeated command.

    Attributes:
        message: Name of the message; empty for that of the command.
        timeout: Seconds after the last command at which the stop is due.
        source: The connection or the command line, in words.
    """

    message: str
    fields: dict[str, Any]
    timeout: float
    source: str


# The stops that connections declare for a command to a component, or the reasons for none.
Declarations = tuple["DeclaredStop | str", ...]


@dataclass(frozen=True)
class Knowledge:
    """The contents of the models of one system.

    Attributes:
        messages: Messages of the models and of the library.
        declarations: The connections of bridges.
        components: Names of components by JAUS id.
        stops: Declared stops, by JAUS id of the receiver and name of the message.
        untaken: Names of commands of its services that a bridge does not take, by JAUS id.
        fault: Why the system cannot be read; empty when it was read.
        left_out: Files of messages that are left out, and why; empty when there is none.
    """

    messages: FrozenMessages
    declarations: tuple[DeclaredConnection, ...] = ()
    components: Mapping[str, str] = field(default_factory=dict)
    stops: Mapping[tuple[str, str], Declarations] = field(default_factory=dict)
    untaken: Mapping[str, frozenset[str]] = field(default_factory=dict)
    fault: str = ""
    left_out: str = ""


class ReadingError(Exception):
    """The child process that reads models has ended."""


class Learning:
    """The child process that reads models, until `close`."""

    def __init__(self, path: Path) -> None:
        """Starts it for a file, or for the first system below a folder."""
        line = [sys.executable, "-m", _READING, str(path)]
        self._is_closed = False
        # The child ends at the end of its input, so also when this process is killed.
        self._process = subprocess.Popen(  # noqa: S603 - itself
            line, stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True
        )

    def first(self) -> Knowledge:
        """Waits for the first knowledge and returns it (`ReadingError`: there is none)."""
        knowledge = self._next()
        if knowledge is None:
            raise ReadingError(f"{_READING} ended with code {self._process.wait()}")
        return knowledge

    def follow(self, learnt: Callable[[Knowledge], None], ended: Callable[[], None]) -> None:
        """Calls `learnt` with the knowledge after each change of files, on another thread.

        Args:
            ended: Is called when the child ends before `close`.
        """

        def run() -> None:
            while (knowledge := self._next()) is not None:
                learnt(knowledge)
            if not self._is_closed:
                ended()

        Thread(target=run, name="learning", daemon=True).start()

    def close(self) -> None:
        """Ends the process."""
        self._is_closed = True
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                pipe.close()
        self._process.terminate()
        self._process.wait()

    def _next(self) -> Knowledge | None:
        pipe: Any = self._process.stdout
        try:
            knowledge: Knowledge = pickle.load(pipe)  # noqa: S301 - of our own child
        except (EOFError, ValueError, pickle.UnpicklingError):  # its pipe has ended, or is closed
            return None
        return knowledge
