"""Messages of a component as fields, its reports, and what it declares: services and commands."""

from __future__ import annotations

import logging
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from inspect import iscoroutinefunction
from pathlib import Path
from queue import Empty, Full, Queue
from typing import Any, TypeAlias

from jausml.language.model.project import made_project
from jausml.language.text.notation import NOTATIONS
from jausml.live.messages import Catalogue, DecodedMessage, MessageEntry, load_catalogue
from jausml.live.messages.of_project import project_catalogue
from jausml.live.peers.entry_messages import find_exchange, find_message
from jausml.live.peers.operator import Identity, Operator
from jausml.live.peers.watching import Reply
from jausml.runtime.base.address import JausAddress
from jausml.runtime.services.definitions import ServiceIdentity

Models: TypeAlias = "str | os.PathLike[str] | Sequence[str | os.PathLike[str]]"
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
    names = tuple(os.fspath(model_path) for model_path in each_model)
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
        while (report := self._get(None)) is not None:
            yield report

    def next(self, timeout: float | None = None) -> Received:
        """Returns the next report.

        Args:
            timeout: Seconds to wait; None waits forever.

        Raises:
            TimeoutError: None came in time, or the subscription is closed.
        """
        try:
            report = self._get(timeout)
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
        """Keeps the function that cancels the event at the end."""
        self._cancel = cancel

    def _get(self, timeout: float | None) -> Received | None:
        report = self._reports.get(timeout=timeout)
        if report is None:
            self.take(None)  # for whoever asks next
        return report

    def _drop(self) -> None:
        try:
            self._reports.get_nowait()
        except Empty:
            return
        self.missed += 1


class Declarations:
    """Services of a component, the reports that it gives, and the messages that it takes."""

    def __init__(self, known: Catalogue, name: str, provides: str | Sequence[str]) -> None:
        named = (provides,) if isinstance(provides, str) else provides
        self.identity = Identity(name, _identities(known, named))
        self._known = known
        self._answers: dict[MessageEntry, tuple[MessageEntry, Callable[[], Fields | None]]] = {}
        self._obeyed: dict[MessageEntry, Callable[[Received], Reply | None]] = {}

    def answer(
        self, name: str, give: Callable[[], Fields | None]
    ) -> tuple[MessageEntry, MessageEntry]:
        """Declares that a function gives a report; returns its query, and itself."""
        _check_callable(give, "that returns the fields")
        query, report = find_exchange(self._known, name, self.identity.services)
        if query in self._answers:
            raise ValueError(f"{query.name} is answered already")
        self._answers[query] = report, give
        return query, report

    def obey(self, name: str, take: Callable[[Received], Reply | None]) -> MessageEntry:
        """Declares that a function takes a message, and returns that."""
        _check_callable(take, "that takes the message")
        entry = find_message(self._known, name, self.identity.services)
        if entry.name.startswith("Query"):
            raise ValueError(f"{entry.name} is a query: `answer` gives its report")
        if entry in self._obeyed:
            raise ValueError(f"{entry.name} is obeyed already")
        self._obeyed[entry] = take
        return entry

    def prepare(self, operator: Operator) -> None:
        """Lets an operator answer and obey as declared, before any other component can ask it."""
        for query, (report, give) in self._answers.items():
            operator.provide(query, report, give)
        for entry, take in self._obeyed.items():
            operator.obey(entry, taking(take))


def taking(
    take: Callable[[Received], Reply | None],
) -> Callable[[MessageEntry, Fields, JausAddress], Reply | None]:
    """Returns a handler that hands messages to a user's function, as an operator has them."""

    def take_entry(entry: MessageEntry, fields: Fields, sender: JausAddress) -> Reply | None:
        return take(Received(entry.name, entry.shortened(fields), str(sender)))

    return take_entry


def _check_callable(function: object, purpose: str) -> None:
    if iscoroutinefunction(function):
        raise TypeError(f"a function {purpose} cannot be async: it is called on another thread")
    if not callable(function):
        raise TypeError(f"{function!r} is not a function {purpose}")


def _identities(known: Catalogue, names: Sequence[str]) -> tuple[ServiceIdentity, ...]:
    """Returns services with all that they inherit, and the core services that each tool has."""
    identities = {service.urn: service for service in Identity().services}
    for name in names:
        for service in known.find_services(name)[0].lineage:
            major, _, minor = service.version.partition(".")
            identities.setdefault(
                service.urn, ServiceIdentity(service.urn, int(major), int(minor or 0))
            )
    return tuple(identities.values())
