"""Comparison of the types in a recording with those of a model.

A type that has changed since the recording has the same name, but its bytes would be read as wrong
values: its fields may have another order or size.
"""

from __future__ import annotations

from collections.abc import Mapping

from jausml.language.interfaces.definitions import FIXED, SINGLE, FieldDefinition, FieldType
from jausml.language.metamodel.classes import ros
from jausml.live.recording.mcap_files import RecordingError
from jausml.live.recording.mcap_reading import RecordedDefinition
from jausml.live.recording.ros_definitions import full_name, modelled_definition
from jausml.live.recording.ros_values import defined_fields, defined_parts

_OCTETS = frozenset({"byte", "char"})  # other names of uint8

_MOST_SHOWN = 400


class RecordedTypes:
    """Comparison of the types of recorded messages with those of a model."""

    def __init__(self, types: Mapping[str, ros.MessageType]) -> None:
        """Begins without a comparison.

        Args:
            types: Types of the model by topic; others are not compared.
        """
        self._types = types
        self._known: dict[tuple[str, str, RecordedDefinition], str] = {}

    def difference(self, topic: str, kind: str, definition: RecordedDefinition) -> str:
        """Returns why a message cannot be read by the type of the model; empty if it can.

        Args:
            kind: The full name of its type.
            definition: Its recorded definition; without one, only the name is compared.
        """
        key = topic, kind, definition
        if key not in self._known:
            wanted = self._types.get(topic)
            self._known[key] = _difference(kind, definition, wanted) if wanted is not None else ""
        return self._known[key]


def _difference(kind: str, definition: RecordedDefinition, wanted: ros.MessageType) -> str:
    if kind != full_name(wanted):
        return f"has the type {kind}, not {full_name(wanted)}"
    if not definition.text.strip() and definition.encoding in ("", "ros2msg"):
        return ""
    if definition.encoding != "ros2msg":
        return f"has a definition of {kind} in '{definition.encoding[:20]}', which is not read"
    try:
        texts = definition.text, modelled_definition(wanted)
        recorded, modelled = (defined_parts(kind, text) for text in texts)
        return _differing(recorded, modelled, next(iter(recorded)), next(iter(modelled)))
    except RecordingError as error:
        return f"has a definition of {kind} that cannot be compared: {error}"


def _differing(
    recorded: Mapping[str, str], modelled: Mapping[str, str], own: str, other: str
) -> str:
    """Returns, in words, a difference of two types that changes their bytes; else empty."""
    fields = defined_fields(own, recorded), defined_fields(other, modelled)
    forms = [[(field.name, *_form(field.type)) for field in some] for some in fields]
    if forms[0] != forms[1]:
        return f"has {own} recorded as {_shown(fields[0])}, and the model has {_shown(fields[1])}"
    for ours, theirs in zip(*fields, strict=True):
        if not ours.type.is_primitive:
            names = (_name(field.type, of) for field, of in ((ours, own), (theirs, other)))
            difference = _differing(recorded, modelled, *names)
            if difference:
                return difference
    return ""


def _form(kind: FieldType) -> tuple[str, str, int]:
    """Returns type, kind and size of an array as far as they decide the bytes of a field."""
    name = kind.name if kind.is_primitive else ""
    if kind.array in (SINGLE, FIXED):
        return "uint8" if name in _OCTETS else name, kind.array, kind.array_size
    return "uint8" if name in _OCTETS else name, "sequence", 0


def _name(kind: FieldType, owner: str) -> str:
    return f"{kind.package or owner.partition('/')[0]}/{kind.name}"


def _shown(fields: list[FieldDefinition]) -> str:
    text = ", ".join(f"{field.type} {field.name}" for field in fields) or "nothing"
    return f"'{text if len(text) <= _MOST_SHOWN else text[: _MOST_SHOWN - 1] + '…'}'"
