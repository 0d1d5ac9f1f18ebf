"""Whole maps as the statements of methods, and messages inside messages by methods of their own."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from jausml.generation.literals import printable
from jausml.language.cdr import short_name
from jausml.language.metamodel.classes import bridge, ros
from jausml.language.semantics.connections.stops import stop_assignments
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.paths.scopes import spelled_out
from jausml_generators.bridge.translation.body import Body
from jausml_generators.bridge.translation.expressions import (
    FORMAT,
    OCTETS,
    Decode,
    Encode,
    New,
    Read,
    Translate,
)
from jausml_generators.bridge.translation.lists import add_list
from jausml_generators.bridge.translation.places import Equal, Place
from jausml_generators.bridge.translation.policies import NO_POLICY, Policies
from jausml_generators.bridge.translation.printing import printed
from jausml_generators.bridge.translation.ros_fields import RosStart
from jausml_generators.bridge.translation.sources import JausSource, RosSource
from jausml_generators.bridge.translation.steps import Require, Write
from jausml_generators.bridge.translation.surroundings import NestedTranslation, Surroundings
from jausml_generators.bridge.translation.targets import JausTarget, RosTarget
from jausml_generators.bridge.translation.translation import Translation, paths_of
from jausml_generators.bridge.translation.values import Value
from jausml_generators.python.codec.jaus_fields import JausStart
from jausml_generators.python.codec.messages import MessageView
from jausml_generators.python.names import snake_case
from jausml_generators.python.statements import CURRENT_COMMAND, may_set_limits

TARGET = Place("target")
"""The message that is made."""


def to_ros(
    connection: bridge.Connection,
    message: MessageView,
    owner: str,
    class_name: str,
    joins: Mapping[str, tuple[str, MessageView]],
    surroundings: Surroundings,
) -> Body:
    """Returns the steps that make `target` (ROS) from `source` (JAUS).

    Args:
        joins: Parameter and class of each joined report, by name of the join.
    """
    body = Body(Policies(owner, connection.outOfRange.name))
    _map_to_ros(body, connection.map, message, class_name, joins, surroundings)
    return body


def to_jaus(
    connection: bridge.Connection,
    message: MessageView,
    owner: str,
    joins: Mapping[str, tuple[str, ros.MessageType]],
    surroundings: Surroundings,
) -> Body:
    """Returns the steps that make `target` (JAUS) from `source` (ROS).

    Args:
        joins: Parameter and `ros.MessageType` of each joined message, by name of the join.
    """
    body = Body(Policies(owner, connection.outOfRange.name))
    _map_to_jaus(body, connection.map, message, joins, surroundings)
    return body


def stop(
    connection: bridge.Connection,
    message: MessageView,
    owner: str,
    class_name: str,
    surroundings: Surroundings,
) -> Body:
    """Returns the steps that make `target`, of either side, without a source."""
    body = Body(Policies(owner, connection.outOfRange.name))
    map_ = connection.map
    if is_to_ros(connection):
        translation = _translation_to_ros(body, map_, message, {}, surroundings)
    else:
        translation = _translation_to_jaus(body, map_, message, {}, surroundings)
        class_name = message.class_name
    body.add(Write(TARGET, New(class_name)))
    translation.add(stop_assignments(connection))
    return body


class _MapTranslation(Translation):
    """A translation with lists and messages inside messages, which translate by it in turn."""

    def add_list(self, assignment: bridge.ListAssignment) -> None:
        add_list(self, assignment)

    def add_message(self, assignment: bridge.MessageAssignment) -> None:
        add_message(self, assignment)


def _map_to_ros(
    body: Body,
    attribute_map: bridge.AttributeMap,
    message: MessageView,
    class_name: str,
    joins: Mapping[str, tuple[str, MessageView]],
    surroundings: Surroundings,
) -> None:
    if may_set_limits(attribute_map.message):
        _refuse_limits(body, attribute_map)
    translation = _translation_to_ros(body, attribute_map, message, joins, surroundings)
    # What is required comes before anything is made: a refused message costs least.
    translation.require(attribute_map.toRos)
    body.add(Write(TARGET, New(class_name)))
    translation.say_unset(attribute_map.toRos)
    translation.add(attribute_map.toRos)


def _map_to_jaus(
    body: Body,
    attribute_map: bridge.AttributeMap,
    message: MessageView,
    joins: Mapping[str, tuple[str, ros.MessageType]],
    surroundings: Surroundings,
) -> None:
    translation = _translation_to_jaus(body, attribute_map, message, joins, surroundings)
    translation.require(attribute_map.toJaus)
    body.add(Write(TARGET, New(message.class_name)))
    translation.add(attribute_map.toJaus)


def _translation_to_ros(
    body: Body,
    attribute_map: bridge.AttributeMap,
    message: MessageView,
    joins: Mapping[str, tuple[str, MessageView]],
    surroundings: Surroundings,
) -> _MapTranslation:
    start = RosStart("target", attribute_map.type)
    target = RosTarget(attribute_map.type, start, surroundings.type_name)
    source = JausSource(message, JausStart("source", names=body.local_of), joins=joins)
    return _MapTranslation(
        body, surroundings, attribute_map, source, target, body.policies.owner, _nested_method
    )


def _translation_to_jaus(
    body: Body,
    attribute_map: bridge.AttributeMap,
    message: MessageView,
    joins: Mapping[str, tuple[str, ros.MessageType]],
    surroundings: Surroundings,
) -> _MapTranslation:
    source = RosSource(attribute_map.type, RosStart("source", attribute_map.type), joins)
    target = JausTarget(message)
    return _MapTranslation(
        body, surroundings, attribute_map, source, target, body.policies.owner, _nested_method
    )


def _nested_method(translation: Translation, attribute_map: bridge.AttributeMap) -> str:
    """Returns the method that translates a message inside another one.

    Args:
        attribute_map: The `bridge.AttributeMap` of the message inside.
    """
    surroundings, owner = translation.surroundings, translation.body.policies.owner
    key = (owner, attribute_map, translation.to_ros)
    if key in surroundings.nested:
        return surroundings.nested[key].name
    message = surroundings.view_of(attribute_map.message)
    type_name = surroundings.type_name(attribute_map.type)
    ends = (message.class_name, type_name)
    source, target = ends if translation.to_ros else ends[::-1]
    name = surroundings.attributes.claim(f"_{owner}_{snake_case(attribute_map.name)}")
    words = (f"{message.jaus_name} ({message.code_text})", short_name(attribute_map.type))
    source_words, target_words = words if translation.to_ros else words[::-1]
    about = printable(attribute_map.documentation or "")
    text = "\n\n".join(filter(None, [f"{source_words} to {target_words}.", about]))
    # Entered before its statements are made, so that a message within itself finds its method.
    nested = surroundings.nested[key] = NestedTranslation(name, source, target, text)
    body = Body(translation.body.policies)
    if translation.to_ros:
        _map_to_ros(body, attribute_map, message, type_name, {}, surroundings)
    else:
        _map_to_jaus(body, attribute_map, message, {}, surroundings)
    nested.lines = printed(body.steps)
    return name


def _refuse_limits(body: Body, attribute_map: bridge.AttributeMap) -> None:
    """Adds the refusal of limits, which a topic would carry as if they were the command.

    Where the map carries the CommandType as well, the ROS side can tell them apart.
    """
    carried = {
        path
        for assignment in spelled_out(attribute_map, to_ros=True)
        if isinstance(assignment, bridge.FieldAssignment)
        for path in paths_of(assignment.source)
    }
    if "CommandType" not in carried:
        current = Equal(Place("source", ("command_type",)), CURRENT_COMMAND)
        body.add(Require(current, "ConversionError", ("a limit, not the current command",)))


def add_message(translation: Translation, assignment: bridge.MessageAssignment) -> None:
    """Adds the statements that translate a message which a JAUS field carries."""
    (_to_ros if translation.to_ros else _to_jaus)(translation, assignment)


def _to_ros(translation: Translation, assignment: bridge.MessageAssignment) -> None:
    body, source = translation.body, translation.source
    surroundings = translation.surroundings
    field: Any = source.carried(assignment.source.strip())  # type: ignore[union-attr]
    message = surroundings.view_of(assignment.map.message)
    method = translation.nested_method(translation, assignment.map)
    with body.under(field.conditions):
        data = field.place
        if field.kind == FORMAT:
            text = f"{field.path} carries no JAUS message"
            is_message = Equal(data.at("format_index"), field.message_format)
            body.add(Require(is_message, "ConversionError", (text,)))
            data = data.at("data")
        decoded = Decode(message.class_name, Read(data, OCTETS))
        path = assignment.target.strip()
        translation.target.prepare(body, path)
        translation.target.put(body, path, Translate(method, decoded))


def _to_jaus(translation: Translation, assignment: bridge.MessageAssignment) -> None:
    body = translation.body
    path = assignment.target.strip()
    target: Any = translation.target
    target.prepare(body, path)
    value: Value = translation.source.value(assignment.source.strip(), NO_POLICY)
    method = translation.nested_method(translation, assignment.map)
    with body.under(value.conditions):
        payload = Encode(Translate(method, value.expression))
        target.put(body, path, target.carrier(path, payload, body.policies.of_wholes))
