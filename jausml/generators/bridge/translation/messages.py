"""Messages inside messages: translated by a map and a method of their own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jausml.generators.bridge.translation.values import NO_LIMIT, Fitted
from jausml.generators.python.codec.jaus_fields import FORMAT
from jausml.generators.python.statements import call

if TYPE_CHECKING:
    from jausml.generators.bridge.translation.translation import Translation
    from jausml.generators.bridge.translation.values import Value
    from jausml.metamodel.classes import bridge


def add_message(translation: Translation, assignment: bridge.MessageAssignment) -> None:
    """Adds the statements that translate a message which a JAUS field carries.

    Args:
        translation: The translation that the assignment belongs to.
        assignment: The assignment.

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
            body.refuse(f"{data}.format_index != 0", "ConversionError", text)
            data = f"{data}.data"
        decoded = call(f"{message.class_name}.decode", data)
        path = assignment.target.strip()
        translation.target.put(body, path, Fitted(call(method, decoded)))


def _to_jaus(translation: Translation, assignment: bridge.MessageAssignment) -> None:
    body = translation.body
    path = assignment.target.strip()
    target: Any = translation.target
    target.prepare(body, path)
    value: Value = translation.source.value(assignment.source.strip(), NO_LIMIT)
    method = translation.nested_method(translation, assignment.map)
    with body.given(value.conditions):
        payload = call(f"{call(method, value.code)}.encode")
        target.put(body, path, target.carrier(path, payload, body.whole_limit))
