"""The fields of ROS messages for people, as `text` has those of JAUS messages."""

from __future__ import annotations

from collections.abc import Iterator

from jausml.language.interfaces.definitions import FieldType
from jausml.language.metamodel.classes import ros
from jausml.language.semantics.paths.markers import in_words
from jausml.language.semantics.paths.ros_paths import ros_name
from jausml.live.messages.text import Row


def ros_rows(
    kind: ros.MessageType, before: str = "", around: tuple[ros.MessageType, ...] = ()
) -> Iterator[Row]:
    """Yields the fields of a ROS type from the outermost inwards, a type in itself once."""
    for field in kind.fields:
        inner = field.messageType if isinstance(field, ros.MessageField) else None
        word = "" if inner is None else ros_name(inner)
        if isinstance(field, ros.PrimitiveField):
            word = field.type.name
        array, size = field.arrayKind.name, int(field.arraySize or 0)
        bound = int(getattr(field, "stringBound", 0) or 0)
        row = Row(
            f"{before}{field.name}",
            len(around),
            str(FieldType(word, "", bound, array, size)),
            units=str(field.units or ""),
            documentation=str(field.documentation or ""),
            markers=tuple(map(in_words, field.markers)),
        )
        yield row
        if inner is not None and inner not in (kind, *around):
            step = f"{row.path}{'' if array == 'single' else '[]'}."
            yield from ros_rows(inner, step, (*around, kind))
