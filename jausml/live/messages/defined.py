"""The messages that models define: of the shipped library and of the user's own models."""

from __future__ import annotations

import os
from collections.abc import Sequence
from functools import cache, cached_property, partial
from typing import Any

from jausml.language import wire
from jausml.language.metamodel.classes import jaus
from jausml.language.model import Model, ReadResult, read_models
from jausml.language.model.diagnostics import Severity
from jausml.language.model.library import library_paths
from jausml.language.model.model import without_collector
from jausml.language.model.notation import Notation
from jausml.language.project import services_alone
from jausml.language.semantics.jaus.commands import (
    is_command,
    obeys_controller_alone,
    responses,
    told_after,
)
from jausml.live.messages.catalogue import Catalogue
from jausml.live.messages.counted import EncodeMessage
from jausml.live.messages.entries import DecodeMessage, MessageEntry, ServiceEntry
from jausml.live.messages.errors import CatalogueError, MessageError


def load_catalogue(
    models: Sequence[str | os.PathLike[str]] = (),
    *,
    project_root: str | os.PathLike[str] | None = None,
    allow_outside: bool = False,
    notations: Sequence[Notation] = (),
) -> DefinedCatalogue:
    """Returns the catalogue of the shipped library and of further models.

    That of the library alone is read once in a process. A service of these models takes the place
    of the library's service of the same URN and version.

    Raises:
        CatalogueError: A model cannot be read; the text has all errors with their places.
    """
    if not models:
        return _library_catalogue()
    result = read_models(
        [*models, *library_paths("jaus")],
        project_root=project_root,
        allow_outside=allow_outside,
        notations=notations,
    )
    return _catalogue_of(result)


@cache
def _library_catalogue() -> DefinedCatalogue:
    with without_collector():
        return DefinedCatalogue(services_alone())


def _catalogue_of(result: ReadResult) -> DefinedCatalogue:
    errors = [error for error in result.diagnostics if error.severity is Severity.ERROR]
    if errors:
        raise CatalogueError("\n".join(f"{e.location}: {e.rule} {e.message}" for e in errors))
    return DefinedCatalogue(result.model)


class DefinedCatalogue(Catalogue):
    """The messages of a model; entries and codecs are made when they are used."""

    def __init__(self, model: Model) -> None:
        """Lists it."""
        super().__init__()
        self.model = model
        self._by_code: dict[int, list[tuple[jaus.MessageDef, jaus.Service, ServiceEntry]]] = {}
        self._entries: dict[int, tuple[MessageEntry, ...]] = {}
        self._entry_of: dict[jaus.MessageDef, MessageEntry] = {}
        self._owners: dict[MessageEntry, list[jaus.Service]] = {}
        services: dict[jaus.Service, ServiceEntry] = {}
        for definition in model.instances(jaus.Service):
            entry = _service(definition, partial(self._entries_of, definition))
            key = (entry.urn, entry.version)
            if key not in self.services:
                self.services[key] = entry
                self._list_messages(definition, entry)
            services[definition] = self.services[key]
        for definition, entry in services.items():
            if definition.inherits is not None:
                entry.inherits = services.get(definition.inherits)

    def _list_messages(self, definition: jaus.Service, service: ServiceEntry) -> None:
        for message in (*definition.inputs, *definition.outputs):
            code = int(str(message.code), 16)
            self._by_code.setdefault(code, []).append((message, definition, service))
            codes = self._codes.setdefault(str(message.name), [])
            if code not in codes:
                codes.append(code)

    def entry(self, definition: jaus.MessageDef) -> MessageEntry:
        """Returns the message of a definition."""
        self._with_code(int(str(definition.code), 16))
        return self._entry_of[definition]

    def _entries_of(
        self, service: jaus.Service
    ) -> tuple[tuple[MessageEntry, ...], tuple[MessageEntry, ...]]:
        inputs, outputs = map(self.entry, service.inputs), map(self.entry, service.outputs)
        return tuple(dict.fromkeys(inputs)), tuple(dict.fromkeys(outputs))

    def _with_code(self, code: int) -> tuple[MessageEntry, ...]:
        if code not in self._by_code:
            return ()
        if code not in self._entries:
            by_identity: dict[object, MessageEntry] = {}
            definitions = self._by_code[code]
            for definition, owner, service in definitions:
                entry: MessageEntry = DefinedMessage(
                    definition, self.encode_embedded, self.decode, self
                )
                try:
                    # Most codes have one definition, which nothing can be equal to.
                    identity: object = entry.identity if len(definitions) > 1 else definition
                except MessageError:
                    identity = definition  # using it will tell what is wrong
                entry = by_identity.setdefault(identity, entry)
                entry.services = tuple(dict.fromkeys((*entry.services, service)))
                self._entry_of[definition] = entry
                self._owners.setdefault(entry, []).append(owner)
            self._entries[code] = tuple(by_identity.values())
        return self._entries[code]

    def owners_of(self, definition: jaus.MessageDef) -> Sequence[jaus.Service]:
        """Returns the services that define a message as it is defined."""
        return self._owners[self.entry(definition)]


def _service(definition: jaus.Service, messages: partial[Any]) -> ServiceEntry:
    owner = definition.eContainer()
    names = {
        "urn": str(definition.urn),
        "version": str(definition.version),
        "name": str(definition.name),
        "documentation": str(definition.documentation or ""),
        "set_name": str(owner.name) if owner is not None else "",
        "set_version": str(owner.version) if owner is not None else "",
    }
    inputs = tuple(str(message.name) for message in definition.inputs)
    outputs = tuple(str(message.name) for message in definition.outputs)
    return ServiceEntry(names, inputs, outputs, messages)


class DefinedMessage(MessageEntry):
    """A message that a model defines."""

    def __init__(
        self,
        definition: jaus.MessageDef,
        encode_message: EncodeMessage,
        decode_message: DecodeMessage,
        catalogue: DefinedCatalogue | None = None,
    ) -> None:
        """Is a definition.

        Args:
            catalogue: What lists it and its answers; nothing is known of these without.
        """
        super().__init__(
            str(definition.name),
            int(str(definition.code), 16),
            str(definition.documentation or ""),
            encode_message,
            decode_message,
            is_command=is_command(definition),
        )
        self._definition, self._catalogue = definition, catalogue

    @property
    def _owned(self) -> list[tuple[DefinedCatalogue, jaus.Service]]:
        """The services that define it, each with its catalogue."""
        catalogue = self._catalogue
        owners = () if catalogue is None else catalogue.owners_of(self._definition)
        return [(catalogue, owner) for owner in owners if catalogue is not None]

    @property
    def layout(self) -> wire.Message:
        """The layout of the message (`wire.LayoutError`: it has none)."""
        return wire.resolve(self._definition)

    @cached_property
    def is_for_controller(self) -> bool:
        """Whether a service of it obeys its commands from the controller alone."""
        return any(obeys_controller_alone(self._definition, owner) for _, owner in self._owned)

    @cached_property
    def answers(self) -> tuple[MessageEntry, ...]:
        """The messages that confirm or reject it."""
        entries = (
            catalogue.entry(answer)
            for catalogue, owner in self._owned
            for answer in responses(self._definition, owner)
        )
        return tuple(dict.fromkeys(entries))

    @cached_property
    def exchange(self) -> tuple[MessageEntry, MessageEntry] | None:
        """The query and the report of the value that it sets."""
        for catalogue, owner in self._owned:
            answer = told_after(self._definition, owner)
            if answer is not None:
                return catalogue.entry(answer.query), catalogue.entry(answer.report)
        return None
