"""A catalogue as plain values, which another process makes a catalogue of without any model.

Layouts stay as they were pickled until they are used: what makes a catalogue of the values has no
long pause. They are values of our own process, from a pipe of ours.
"""

from __future__ import annotations

import pickle
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial

from jausml.language import wire
from jausml.live.messages.catalogue import Catalogue
from jausml.live.messages.entries import MessageEntry, Relations, ServiceEntry

Numbers = tuple[int, ...]
"""Places of messages, or of services, in their list."""


@dataclass(frozen=True)
class FrozenService:
    """A service (`inherits`: the index of the inherited one)."""

    names: Mapping[str, str]
    inputs: Numbers
    outputs: Numbers
    inherits: int | None


@dataclass(frozen=True)
class FrozenMessage:
    """A message (`layout`: a pickled `wire.Message`, or the `wire.LayoutError` of one)."""

    name: str
    code: int
    documentation: str
    is_command: bool
    is_for_controller: bool
    services: Numbers
    answers: Numbers
    exchange: tuple[int, int] | None
    layout: bytes


@dataclass(frozen=True)
class FrozenMessages:
    """The services and messages of a catalogue."""

    services: tuple[FrozenService, ...]
    messages: tuple[FrozenMessage, ...]


def frozen(catalogue: Catalogue) -> FrozenMessages:
    """Returns the messages of a catalogue, as values that can be pickled."""
    messages = catalogue.messages
    place = {entry: number for number, entry in enumerate(messages)}
    services = {service: number for number, service in enumerate(catalogue.services.values())}
    return FrozenMessages(
        tuple(
            FrozenService(
                {name: getattr(service, name) for name in ServiceEntry.NAMES},
                tuple(place[entry] for entry in service.inputs),
                tuple(place[entry] for entry in service.outputs),
                None if service.inherits is None else services[service.inherits],
            )
            for service in services
        ),
        tuple(
            FrozenMessage(
                entry.name,
                entry.code,
                entry.documentation,
                entry.is_command,
                entry.relations.is_for_controller,
                tuple(services[service] for service in entry.services),
                tuple(place[answer] for answer in entry.relations.answers),
                (exchange := entry.relations.exchange) and (place[exchange[0]], place[exchange[1]]),
                pickle.dumps(_layout_of(entry)),
            )
            for entry in messages
        ),
    )


def _layout_of(entry: MessageEntry) -> wire.Message | wire.LayoutError:
    try:
        return entry.layout
    except wire.LayoutError as error:
        return wire.LayoutError(error.reason, error.path)


class ThawedCatalogue(Catalogue):
    """The catalogue of such values."""

    def __init__(self, values: FrozenMessages) -> None:
        """Lists them."""
        super().__init__()
        self._entries: dict[int, tuple[MessageEntry, ...]] = {}
        self._listed = tuple(map(self._message, values.messages))
        services = [self._service(service) for service in values.services]
        for service, value in zip(services, values.services, strict=True):
            self.services[service.urn, service.version] = service
            service.inherits = None if value.inherits is None else services[value.inherits]
        for entry, message in zip(self._listed, values.messages, strict=True):
            entry.services = tuple(services[number] for number in message.services)
            self._entries[entry.code] = (*self._entries.get(entry.code, ()), entry)
            codes = self._codes.setdefault(entry.name, [])
            if entry.code not in codes:
                codes.append(entry.code)

    def _with_code(self, code: int) -> tuple[MessageEntry, ...]:
        return self._entries.get(code, ())

    def _service(self, service: FrozenService) -> ServiceEntry:
        def messages() -> tuple[tuple[MessageEntry, ...], tuple[MessageEntry, ...]]:
            inputs = tuple(self._listed[number] for number in service.inputs)
            return inputs, tuple(self._listed[number] for number in service.outputs)

        inputs, outputs = (tuple(entry.name for entry in entries) for entries in messages())
        return ServiceEntry(service.names, inputs, outputs, messages)

    def _message(self, message: FrozenMessage) -> MessageEntry:
        def relations() -> Relations:
            answers = tuple(self._listed[number] for number in message.answers)
            exchange = message.exchange
            pair = exchange and (self._listed[exchange[0]], self._listed[exchange[1]])
            return Relations(message.is_for_controller, answers, pair)

        return MessageEntry(
            message.name,
            message.code,
            message.documentation,
            partial(_layout_in, message.layout),
            self.encode_embedded,
            self.decode,
            relations,
            is_command=message.is_command,
        )


def _layout_in(data: bytes) -> wire.Message:
    layout: wire.Message | wire.LayoutError = pickle.loads(data)  # noqa: S301 - our own
    if isinstance(layout, wire.LayoutError):
        raise layout
    return layout
