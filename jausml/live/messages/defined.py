"""The messages that models define: of the shipped library and of the user's own models."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from functools import cache, partial
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
from jausml.live.messages.entries import DecodeMessage, MessageEntry, Relations, ServiceEntry
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
        raise CatalogueError(
            "\n".join(f"{error.location}: {error.rule} {error.message}" for error in errors)
        )
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
        listed: list[tuple[jaus.Service, ServiceEntry]] = []
        for definition in model.instances(jaus.Service):
            entry = _service(definition, partial(self._entries_of, definition))
            key = (entry.urn, entry.version)
            if key not in self.services:
                self.services[key] = entry
                self._list_messages(definition, entry)
                listed.append((definition, entry))
            services[definition] = self.services[key]
        for definition, entry in listed:
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
        """Returns the message of a definition in a service that is listed."""
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
                relations = partial(self._relations_of, definition)
                entry = defined_message(definition, self.encode_embedded, self.decode, relations)
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

    def _relations_of(self, definition: jaus.MessageDef) -> Relations:
        owners = self._owners[self.entry(definition)]
        answers = (answer for owner in owners for answer in responses(definition, owner))
        reports = filter(None, (told_after(definition, owner) for owner in owners))
        exchanges = (
            (self._listed(report.query), self._listed(report.report)) for report in reports
        )
        return Relations(
            any(obeys_controller_alone(definition, owner) for owner in owners),
            tuple(dict.fromkeys(filter(None, map(self._listed, answers)))),
            next(((query, report) for query, report in exchanges if query and report), None),
        )

    def _listed(self, definition: jaus.MessageDef) -> MessageEntry | None:
        """Returns the message of a definition; None where its service has lost its place."""
        self._with_code(int(str(definition.code), 16))
        return self._entry_of.get(definition)


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


def defined_message(
    definition: jaus.MessageDef,
    encode_message: EncodeMessage,
    decode_message: DecodeMessage,
    relations: Callable[[], Relations] = Relations,
) -> MessageEntry:
    """Returns the message that a model defines."""
    return MessageEntry(
        str(definition.name),
        int(str(definition.code), 16),
        str(definition.documentation or ""),
        partial(wire.resolve, definition),
        encode_message,
        decode_message,
        relations,
        is_command=is_command(definition),
    )
