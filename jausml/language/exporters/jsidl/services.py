"""Services and their messages as elements of JSIDL."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.exporters.jsidl.behaviour import BehaviourWriter
from jausml.language.exporters.jsidl.elements import element, text_element
from jausml.language.exporters.jsidl.fields import FieldWriter
from jausml.language.exporters.jsidl.names import reference_name

if TYPE_CHECKING:
    from collections.abc import Iterable
    from xml.etree.ElementTree import Element

    from jausml.language.metamodel.classes import jaus


def service_element(service: jaus.Service) -> Element:
    """Returns a service with all that it says of its own; what it inherits is a reference."""
    fields = FieldWriter()
    inputs, outputs = (
        [_message(each, fields) for each in messages]
        for messages in (service.inputs, service.outputs)
    )
    events = [_event(each, fields) for each in service.events]
    types = fields.declared_types()
    return element(
        "service_def",
        [
            text_element("description", service.documentation),
            text_element("assumptions", None),
            *_references(service),
            *([element("declared_type_set", types, name="types")] if types else []),
            element("message_set", [element("input_set", inputs), element("output_set", outputs)]),
            element("internal_events_set", events),
            BehaviourWriter(service).behaviour(),
        ],
        name=service.name,
        id=service.urn,
        version=service.version,
    )


def _references(service: jaus.Service) -> Iterable[Element]:
    base = service.inherits
    if base is not None:
        inherited = element(
            "inherits_from", name=reference_name(base), id=base.urn, version=base.version
        )
        yield element("references", [inherited])


def _message(message: jaus.MessageDef, fields: FieldWriter) -> Element:
    code = element(
        "fixed_field",
        name="MessageID",
        field_type="unsigned short integer",
        field_units="one",
        optional=False,
    )
    record = element("record", [code], name="HeaderRec", optional=False)
    return element(
        "message_def",
        [
            text_element("description", message.documentation),
            element("header", [record], name="Header"),
            *_body(message.body, fields),
        ],
        name=message.name,
        message_id=str(message.code)[2:].upper(),
        is_command=bool(message.isCommand),
    )


def _event(event: jaus.InternalEvent, fields: FieldWriter) -> Element:
    return element(
        "event_def",
        [
            text_element("description", event.documentation),
            element("header", name="Header"),
            *_body(event.body, fields),
        ],
        name=event.name,
    )


def _body(body: jaus.Field | None, fields: FieldWriter) -> Iterable[Element]:
    yield element("body", [] if body is None else [fields.field(body)], name="Body")
    yield element("footer", name="Footer")
