"""Services and their messages as elements of JSIDL."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.exporters.jsidl.behaviour import behaviour, reference_name
from jausml.language.exporters.jsidl.elements import element, text_element
from jausml.language.exporters.jsidl.fields import FieldWriter

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from jausml.language.metamodel.classes import jaus

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
