"""The contents of models, as plain values for the unit, and the process that reads them.

Models are read by a child process, again whenever a file of theirs changes. This one holds no
machinery of models: it would stand still for as long as that works.
"""

from __future__ import annotations

import pickle
import struct
import subprocess
import sys
from dataclasses import dataclass, field
from threading import Thread
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path
    from typing import IO

    from jausml.live.messages.frozen import FrozenMessages
    from jausml.live.systems.state import DeclaredConnection

LENGTH = struct.Struct("<Q")  # the number of bytes, which stands before each value in the pipe

_READING = "jausml.live.operating.reading"


@dataclass(frozen=True)
class DeclaredStop:
    """The stop of a command that is sent again and again (`source`: who has declared it)."""

    message: str
    fields: dict[str, Any]
    timeout: float
    source: str


# The stops of one command to one component, or why a connection declares none.
Declarations = tuple["DeclaredStop | str", ...]


@dataclass(frozen=True)
class Knowledge:
    """The contents of models, for one system.

    Attributes:
        messages: Their messages and those of the library.
        declarations: The connections that are looked for.
        components: Names of components by JAUS id.
        stops: What is declared, by JAUS id of the receiver and name of the message.
        untaken: Names of commands that bridges do not take though their services define them, by
            JAUS id.
        fault: Why the system cannot be read; empty where it was.
        left_out: Which files of messages are left out, and why.
    """

    messages: FrozenMessages
    declarations: tuple[DeclaredConnection, ...] = ()
    components: Mapping[str, str] = field(default_factory=dict)
    stops: Mapping[tuple[str, str], Declarations] = field(default_factory=dict)
    untaken: Mapping[str, frozenset[str]] = field(default_factory=dict)
    fault: str = ""
    left_out: str = ""


class ReadingError(Exception):
    """The process that reads models has ended."""


class Learning:
    """The child process, from the first reading to `close`."""

    def __init__(self, path: Path) -> None:
        """Begins to read a file, or the first system below a folder."""
        line = [sys.executable, "-m", _READING, str(path)]
        self._is_closed = False
        # At the end of its input it ends: so it does when this process is killed.
        self._process = subprocess.Popen(  # noqa: S603 - itself
            line, stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True
        )

    def first(self) -> Knowledge:
        """Waits for the first knowledge (`ReadingError`: there is none)."""
        knowledge = self._next()
        if knowledge is None:
            raise ReadingError(f"{_READING} ended with code {self._process.wait()}")
        return knowledge

    def follow(self, learnt: Callable[[Knowledge], None], ended: Callable[[], None]) -> None:
        """Reports the knowledge whenever files have changed, on a thread of its own.

        Args:
            ended: Is called when no more will be told.
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
        pipe = self._process.stdout
        try:
            data = None if pipe is None else _read(pipe)
        except ValueError:  # closed meanwhile
            return None
        knowledge: Knowledge | None = None if data is None else pickle.loads(data)  # noqa: S301 - of our own child
        return knowledge


def _read(pipe: IO[bytes]) -> bytes | None:
    head = pipe.read(LENGTH.size)
    if len(head) < LENGTH.size:
        return None
    (length,) = LENGTH.unpack(head)
    data = pipe.read(length)
    return data if len(data) == length else None
