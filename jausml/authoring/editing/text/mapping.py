"""Changes of what maps write in a notation of their own: arrows, conversions, tables, vectors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from jausml.authoring.editing.commands import EditError
from jausml.language.metamodel.classes import bridge
from jausml.language.text.tree import (
    Assignment,
    Call,
    Direction,
    Element,
    End,
    Entry,
    Ignored,
    Name,
    Table,
    Vector,
    VectorEntry,
)
from jausml.language.text.writing.layout import shown_call, shown_way, simple
from jausml.language.text.writing.spelling import path
from jausml.language.text.writing.unparsing import table_entry, vector_entry

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.authoring.editing.text.edited import EditedText, FeatureChange
    from jausml.authoring.editing.text.values import Values
    from jausml.language.metamodel.classes.ecore import EObject

ENDS = {"message": True, "type": False}
"""The features of a map that its ends say, and whether each is the JAUS end."""


class MapChanges:
    """Sets features of maps and of what they own."""

    def __init__(self, edited: EditedText, values: Values) -> None:
        self._edited = edited
        self._values = values

    def set_end(self, change: FeatureChange, part: Element) -> bool:
        """Gives a map another message or type; returns whether an end says it."""
        feature = change.feature
        is_jaus = ENDS[feature.name]
        ends = (each for each in part.items if isinstance(each, End))
        end = next((each for each in ends if each.is_jaus == is_jaus), None)
        target = getattr(change.made, feature.name)
        if target is None:
            if end is not None:
                body, _ = self._edited.outline.place(end)
                self._edited.blocks.remove(body, [end])
            return end is not None
        name = self._edited.names.name(change.obj, target, feature)
        if not isinstance(name, Name):
            return False
        if end is None:
            new = End(is_jaus, name, None)
            first = next((each for each in part.items if isinstance(each, End)), None)
            self._edited.add_item(part, None if is_jaus else first, new)
        elif end.members is None and not end.features:
            start, stop = self._edited.source.range_of(end.type.span)
            self._edited.edits.replace(start, stop, simple(name))
        else:
            # The members that are listed are those of the other message.
            self._edited.put(end, End(is_jaus, name, None))
        return True

    def set(self, change: FeatureChange) -> None:
        """Gives something that has no plain block other values of a feature."""
        part, made, feature = change.part, change.made, change.feature
        if isinstance(part, Assignment | Ignored):
            self._set_assignment(change, part)
        elif isinstance(part, Call):
            self._set_call(change.obj, part, made)
        elif (
            isinstance(part, Entry)
            and (entry := table_entry(cast("bridge.TableEntry", made))) is not None
        ):
            side = "jaus" if feature.name == "jaus" else "ros"
            self._put(getattr(part, side), simple(getattr(entry, side)))
        elif (
            isinstance(part, VectorEntry)
            and (new := vector_entry(cast("bridge.VectorValue", made))) is not None
        ):
            self._set_vector_entry(part, new, feature.name)
        elif isinstance(part, Vector) and feature.name == "direction" and change.values:
            self._set_way(part, to_ros=change.value.name == "jausToRos")
        elif isinstance(part, Entry | VectorEntry | Table | Vector):
            self.rewrite(change)
        else:
            raise EditError(f"{feature.name} follows from the rest of the text: edit it there")

    def rewrite(self, change: FeatureChange) -> None:
        """Writes a table or a vector anew, as a uniform block where only that says it."""
        whole: EObject | None = change.obj
        while whole is not None and not isinstance(whole, bridge.ValueTable | bridge.TestVector):
            whole = whole.eContainer()
        if whole is None:
            raise EditError(f"text cannot say this value of {change.feature.name} here")
        made = self._edited.detached(self._edited.copy(whole))
        maps = self._edited.maps
        new = (
            maps.table(made)
            if isinstance(made, bridge.ValueTable)
            else maps.vector(cast("bridge.TestVector", made))
        )
        self._edited.put(self._edited.outline.item_of(self._edited.part(whole)), new)

    def _set_assignment(self, change: FeatureChange, part: Assignment | Ignored) -> None:
        feature = change.feature
        new = self._edited.maps.arrow(cast("bridge.Assignment", change.made))
        if new is None or type(new) is not type(part):
            self.say_as_block(change.obj, change.made)
        elif isinstance(part, Ignored) and isinstance(new, Ignored):
            self._put(part.target, path(new.target.text))
        elif isinstance(part, Assignment) and isinstance(new, Assignment):
            if feature.name == "target":
                self._put_all(part.targets, ", ".join(map(simple, new.targets)))
            elif feature.name in ("source", "value"):
                self._put_all(part.sources, ", ".join(map(simple, new.sources)))
            else:
                self._values.set(change)

    def say_as_block(self, obj: EObject, made: EObject) -> None:
        """Writes an assignment as a uniform block, which parts its direction in two."""
        edited = self._edited
        item = edited.outline.item_of(edited.part(obj))
        name = obj.eContainmentFeature().name
        feature = edited.table(cast("EObject", obj.eContainer())).features[name]
        new = edited.elements.value_item(made, feature)
        body, _ = edited.outline.place(item)
        owner = body.owner
        if not isinstance(owner, Direction):
            edited.put(item, new)
            return
        indent = edited.source.indent_of(edited.outline.start(owner))
        lines = "\n".join(edited.blocks.lines(new, indent))
        start, end = edited.outline.whole_start(item), edited.outline.whole_end(item)
        first = edited.source.before_space(start, body.start)
        again = f"\n{indent}{shown_way(owner)} ("
        edited.edits.replace(first, end, f"\n{indent})\n{lines}{again}")

    def _set_call(self, obj: EObject, part: Call, made: EObject) -> None:
        call = self._edited.maps.call(cast("bridge.Conversion", made))
        if call is not None:
            self._put(part, shown_call(call))
            return
        self.put_conversions(cast("EObject", obj.eContainer()))

    def put_conversions(self, owner: EObject) -> None:
        """Writes an assignment anew, with the conversions that it will have."""
        new = self._edited.detached(self._edited.copy(owner))
        arrow = self._edited.maps.arrow(cast("bridge.Assignment", new))
        item = self._edited.outline.item_of(self._edited.part(owner))
        if arrow is None:
            self.say_as_block(owner, new)
        else:
            self._edited.put(item, arrow)

    def _set_vector_entry(self, part: VectorEntry, new: VectorEntry, feature: str) -> None:
        if feature == "path":
            self._put(part.path, path(new.path.text))
        elif feature == "value":
            self._put(part.value, simple(new.value))
        elif part.tolerance is not None and new.tolerance is not None:
            self._put(part.tolerance, simple(new.tolerance))
        elif new.tolerance is not None:
            end = self._edited.source.range_of(part.value.span)[1]
            self._edited.edits.insert(end, f" ~ {simple(new.tolerance)}")
        elif part.tolerance is not None:
            start = self._edited.source.range_of(part.value.span)[1]
            self._edited.edits.delete(start, self._edited.source.range_of(part.tolerance.span)[1])

    def _set_way(self, part: Vector, *, to_ros: bool) -> None:
        body = self._edited.outline.body(part)
        start = self._edited.source.range_of(part.name.span)[1]
        way = shown_way(Direction(to_ros))
        if body is not None:
            self._edited.edits.replace(start, body.start - 1, f" {way} ")

    def _put(self, part: Any, text: str) -> None:
        start, end = self._edited.source.range_of(part.span)
        self._edited.edits.replace(start, end, text)

    def _put_all(self, parts: Sequence[Any], text: str) -> None:
        source = self._edited.source
        start, end = source.range_of(parts[0].span)[0], source.range_of(parts[-1].span)[1]
        if source.text[start:end] != text:
            self._edited.edits.replace(start, end, text)
