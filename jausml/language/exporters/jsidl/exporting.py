"""Export of services as JSIDL files, with what gets lost on the way."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.language.exporters.jsidl.behaviour import behaviour, reference_name
from jausml.language.exporters.jsidl.elements import FieldWriter, document, element, text_element
from jausml.language.exporters.jsidl.losses import UNSAID, differences, finding
from jausml.language.importers.jsidl import Source, import_sources
from jausml.language.metamodel.classes import jaus
from jausml.language.model.diagnostics import Diagnostic, Severity
from jausml.language.semantics.jaus.services import with_inherited

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from xml.etree.ElementTree import Element

    from jausml.language.importers.jsidl import ImportResult
    from jausml.language.model.comparison import Difference
    from jausml.language.model.model import Model

_CODE = {"field_type": "unsigned short integer", "field_units": "one"}


def service_element(service: jaus.Service) -> Element:
    """Returns a service with all that it says of its own; what it inherits is a reference."""
    fields = FieldWriter()
    inputs = [_message(each, fields) for each in service.inputs]
    outputs = [_message(each, fields) for each in service.outputs]
    events = [_definition("event_def", each, fields) for each in service.events]
    parts = [text_element("description", service.documentation), element("assumptions")]
    base = service.inherits
    if base is not None:
        name = reference_name(base)
        inherits = element("inherits_from", name=name, id=base.urn, version=base.version)
        parts.append(element("references", [inherits]))
    if types := fields.declared_types():
        parts.append(element("declared_type_set", types, name="types"))
    sets = [element("input_set", inputs), element("output_set", outputs)]
    parts += [element("message_set", sets), element("internal_events_set", events)]
    parts.append(behaviour(service))
    return element("service_def", parts, name=service.name, id=service.urn, version=service.version)


def _message(message: jaus.MessageDef, fields: FieldWriter) -> Element:
    made = _definition("message_def", message, fields)
    made.set("message_id", str(message.code)[2:].upper())
    made.set("is_command", str(bool(message.isCommand)).lower())
    code = element("fixed_field", name="MessageID", optional=False, **_CODE)
    made[1].append(element("record", [code], name="HeaderRec", optional=False))
    return made


def _definition(
    tag: str, defined: jaus.MessageDef | jaus.InternalEvent, fields: FieldWriter
) -> Element:
    body = [] if defined.body is None else [fields.field(defined.body)]
    parts = [
        text_element("description", defined.documentation),
        element("header", name="Header"),
        element("body", body, name="Body"),
        element("footer", name="Footer"),
    ]
    return element(tag, parts, name=defined.name)


_NOT_IN_FILES = re.compile("[^A-Za-z0-9_.-]+")


@dataclass(frozen=True, slots=True)
class ExportResult:
    """The outcome of an export.

    Attributes:
        documents: The documents by the names of their files: one for each service.
    """

    documents: Mapping[str, bytes]
    diagnostics: list[Diagnostic]


def export_jsidl(model: Model, services: Iterable[jaus.Service]) -> ExportResult:
    """Writes services as JSIDL (AS5684), and finds what the files do not say.

    An import of the files is compared with the model: each difference is a finding at the element
    of the model, so that nothing is lost in silence.

    Args:
        model: Knows the places of the services; a valid one.
    """
    services = list(services)
    written = [(each, document(service_element(each))) for each in with_inherited(services)]
    again = import_sources(Source(f"{n}", data) for n, (_, data) in enumerate(written))
    found = list(_refused(model, [each for each, _ in written], again))
    if not found:
        found = [each for service in services for each in _lost(model, service, again)]
        found += _unsaid_sets(model, services)
    documents = {file_name(each): data for each, data in written if each in services}
    return ExportResult(documents, sorted(dict.fromkeys(found)))


def file_name(service: jaus.Service) -> str:
    """Returns the name of the file of a service, e.g. urn.jaus.jss.core.Events-1.1.xml."""
    return f"{_NOT_IN_FILES.sub('.', str(service.urn))}-{service.version}.xml"


def _refused(
    model: Model, services: list[jaus.Service], again: ImportResult
) -> Iterator[Diagnostic]:
    """Yields what the importer does not take of the files."""
    for each in again.diagnostics:
        if each.severity is Severity.ERROR:
            service = services[int(each.location.path)]
            message = f"{service.name} is no JSIDL: {each.message}"
            yield finding("JML633", model.location(service), message)


def _lost(model: Model, service: jaus.Service, again: ImportResult) -> Iterator[Diagnostic]:
    """Yields what an import of the file of a service does not bring back."""
    key = service.urn, service.version
    imported = next(
        each for root in again.sets for each in root.services if (each.urn, each.version) == key
    )
    unsaid: dict[tuple[str, str], list[Difference]] = {}
    for each in differences(service, imported, model.metamodels):
        owner = "/".join(each.path.split("/")[:2])
        if each.second == UNSAID.get(each.feature):
            unsaid.setdefault((owner, each.feature), []).append(each)
        else:
            message = f"{each.path}: {each.feature} is {each.first}, after an import {each.second}"
            yield finding("JML632", model.location(each.first_element), message)
    for (owner, feature), found in unsaid.items():
        names = dict.fromkeys(each.path.rpartition("/")[2] for each in found)
        message = f"{owner}: JSIDL has no place for '{feature}' of {', '.join(names)}"
        yield finding("JML631", model.location(found[0].first_element, feature), message)


def _unsaid_sets(model: Model, services: Iterable[jaus.Service]) -> Iterator[Diagnostic]:
    """Yields what sets say of themselves, and types that no message refers to."""
    used = {each.target for each in model.instances(jaus.TypeReference)}
    for root in dict.fromkeys(each.eContainer() for each in services):
        if root is not None and root.documentation:
            message = f"JSIDL has no place for what the set '{root.name}' says of itself"
            yield finding("JML631", model.location(root, "documentation"), message)
        for each in root.types if root is not None else ():
            if each not in used:
                message = f"the declared type '{each.name}' is left out: nothing refers to it"
                yield finding("JML631", model.location(each), message)
