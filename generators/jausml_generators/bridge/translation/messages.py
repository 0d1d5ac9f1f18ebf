"""Messages inside messages: translated by a map and a method of their own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jausml_generators.bridge.translation.expressions import (
    FORMAT,
    OCTETS,
    Decode,
    Encode,
    Read,
    Translate,
)
from jausml_generators.bridge.translation.places import Equal
from jausml_generators.bridge.translation.steps import Require
from jausml_generators.bridge.translation.values import NO_POLICY

if TYPE_CHECKING:
    from jausml.language.metamodel.classes import bridge
    from jausml_generators.bridge.translation.translation import Translation
    from jausml_generators.bridge.translation.values import Value


def add_message(translation: Translation, assignment: bridge.MessageAssignment) -> None:
    """Adds the statements that translate a message which a JAUS field carries.

    Raises:
        AssignmentError: A value does not fit its target.
        PathError: A path leads nowhere.
    """
    (_to_ros if translation.to_ros else _to_jaus)(translation, assignment)


def _to_ros(translation: Translation, assignment: bridge.MessageAssignment) -> None:
    body, source = translation.body, translation.source
    surroundings = translation.surroundings
    field: Any = source.carried(assignment.source.strip())  # type: ignore[union-attr]
    message = surroundings.view_of(assignment.map.message)
    method = translation.nested_method(translation, assignment.map)
    with body.given(field.conditions):
        data = field.place
        if field.kind == FORMAT:
            text = f"{field.path} carries no JAUS message"
            body.add(Require(Equal(data.at("format_index"), 0), "ConversionError", text))
            data = data.at("data")
        decoded = Decode(message.class_name, Read(data, OCTETS))
        path = assignment.target.strip()
        translation.target.put(body, path, Translate(method, decoded))


def _to_jaus(translation: Translation, assignment: bridge.MessageAssignment) -> None:
    body = translation.body
    path = assignment.target.strip()
    target: Any = translation.target
    target.prepare(body, path)
    value: Value = translation.source.value(assignment.source.strip(), NO_POLICY)
    method = translation.nested_method(translation, assignment.map)
    with body.given(value.conditions):
        payload = Encode(Translate(method, value.expression))
        target.put(body, path, target.carrier(path, payload, body.whole_policy))
