"""Messages of a component: bytes to fields and back, and reports one after the other."""

from __future__ import annotations

import logging
import os
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from queue import Empty, Full, Queue
from typing import TYPE_CHECKING, Any

from jausml.language.model.project import made_project
from jausml.language.text.notation import NOTATIONS
from jausml.live.messages import load_catalogue
from jausml.live.messages.of_project import project_catalogue

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from typing import TypeAlias

    from jausml.live.messages import Catalogue, DecodedMessage

    Models: TypeAlias = str | os.PathLike[str] | Sequence[str | os.PathLike[str]]
    """One file, or several."""


_LOG = logging.getLogger(__name__)


@lru_cache(maxsize=8)
def _catalogue(models: tuple[str, ...], project: Path | None) -> Catalogue:
    if project is not None:
        return project_catalogue(_LOG.warning)
    return load_catalogue(models, notations=NOTATIONS)


def catalogue(models: Models = ()) -> Catalogue:
    """Returns the messages of the library and of models, read once.

    Without any, those of the project of the current folder count, if `jausml init` made it.

    Raises:
        MessageError: A model cannot be read; the text has all errors with their places.
    """
    each_model = (models,) if isinstance(models, (str, os.PathLike)) else models
    names = tuple(os.fspath(each) for each in each_model)
    return _catalogue(names, None if names else made_project(Path.cwd()))


def decode(
    payload: bytes | str,
    *,
    service: str | None = None,
    message: str | None = None,
    models: Models = (),
) -> DecodedMessage:
    """Returns the message that bytes hold: its `entry` (name, code) and its `fields`.

    Args:
        service: Where a code has several meanings, that of this service: URN or name.
        message: Where it still has several, the message of this name.
    """
    data = bytes.fromhex(payload) if isinstance(payload, str) else payload
    return catalogue(models).decode(data, service, message)


def encode(
    message: str | int,
    fields: Mapping[str, Any] | None = None,
    *,
    service: str | None = None,
    models: Models = (),
) -> bytes:
    """Returns the bytes of a message: its code and its body.

    Args:
        fields: Its fields in units of the standard; the one record of a body need not be named.
        service: Where several messages have the name, that of this service: URN or name.

    Raises:
        MessageError: There is no such message, or the fields are wrong.
    """
    entry = catalogue(models).message(message, service)
    return entry.encode(entry.completed(dict(fields or {})))


Fields = dict[str, Any]
"""Fields of a message by their names, without the one record of a body."""

MOST_WAITING = 1000
"""Reports that wait to be taken; then the oldest is thrown away."""


@dataclass(frozen=True)
class Received:
    """A message that came.

    Attributes:
        fields: Its fields, in units of the standard.
    """

    name: str
    fields: Fields
    sender: str


class Subscription:
    """Reports of an event, to be iterated over; ends with `close`.

    Attributes:
        missed: Reports that were thrown away because nobody took them in time, the oldest first.
    """

    def __init__(self) -> None:
        self.missed = 0
        self._reports: Queue[Received | None] = Queue(MOST_WAITING)
        self._cancel: Callable[[], None] | None = None

    def __enter__(self) -> Subscription:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __iter__(self) -> Iterator[Received]:
        """Yields reports as they come, until the subscription is closed."""
        while (report := self._reports.get()) is not None:
            yield report

    def next(self, timeout: float | None = None) -> Received:
        """Returns the next report.

        Args:
            timeout: Seconds to wait; None waits forever.

        Raises:
            TimeoutError: None came in time, or the subscription is closed.
        """
        try:
            report = self._reports.get(timeout=timeout)
        except Empty:
            raise TimeoutError(f"no report within {timeout:g} s") from None
        if report is None:
            raise TimeoutError("the subscription is closed")
        return report

    def close(self) -> None:
        """Cancels the event."""
        if self._cancel is not None:
            self._cancel()
            self._cancel = None
        self.take(None)

    def take(self, report: Received | None) -> None:
        """Takes a report, on another thread; None ends the iteration."""
        while True:
            try:
                self._reports.put_nowait(report)
            except Full:
                self._drop()
            else:
                return

    def begin(self, cancel: Callable[[], None]) -> None:
        """Takes what cancels the event at the end."""
        self._cancel = cancel

    def _drop(self) -> None:
        try:
            self._reports.get_nowait()
        except Empty:
            return
        self.missed += 1
