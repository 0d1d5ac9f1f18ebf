"""Planner of changes of ros2jaus texts."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, cast

from jausml.authoring.editing.applying import converted
from jausml.authoring.editing.commands import Add, EditError, Move, Rename, Set
from jausml.authoring.editing.text.edited import EditedText, FeatureChange, InsertionPoints
from jausml.authoring.editing.text.mapping import ENDS, MapChanges
from jausml.authoring.editing.text.naming import named_references
from jausml.authoring.editing.text.placing import Adding, Moving, Removing
from jausml.authoring.editing.text.values import DOCUMENTATION, NAME, Heads, Values
from jausml.language.model.names import name_of
from jausml.language.model.notation import BY_NAME
from jausml.language.text.tree import Assignment, Element, Entry, Ignored, Name, Table, Vector
from jausml.language.text.writing.layout import simple
from jausml.language.text.writing.spelling import is_comment, is_name
from jausml.language.text.writing.unparsing import MAP

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.authoring.editing.commands import ElementCommand
    from jausml.authoring.editing.drafts import Context
    from jausml.authoring.editing.splices import Splice
    from jausml.language.metamodel import FeatureTable
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.refs import Ref
    from jausml.language.model.xmi.parsing import Node

_PARTING = re.compile("([./])")

_ROLES = ("request", "response", "goal", "result", "feedback")
"""Steps that say which part of a service or an action is meant."""

_FOLDERS = ("msg", "srv", "action")
"""Steps that a ROS name may have, and that name nothing."""


def plan_text(commands: Sequence[ElementCommand], context: Context) -> list[Splice]:
    """Returns what is to change in a text so that commands hold, all of the same state."""
    return _Plan(context).run(commands)


class _Plan:
    """Plan of the changes of one text."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._edited = EditedText(context)
        points = InsertionPoints(self._edited)
        self._values = Values(self._edited, points)
        self._heads = Heads(self._edited, self._values)
        self._mapping = MapChanges(self._edited, self._values)
        self._adding = Adding(self._edited, points, self._mapping)
        self._removing = Removing(self._edited)
        self._moving = Moving(self._edited, points, self._adding, self._removing)

    def run(self, commands: Sequence[ElementCommand]) -> list[Splice]:
        """Returns the splices of commands."""
        gone = []
        for command in commands:
            obj = self._own(command.owner if isinstance(command, Add) else command.element)
            if obj is None:
                continue
            if isinstance(command, Set):
                self._set(obj, command)
            elif isinstance(command, Rename):
                self._put(obj, self._edited.table(obj).features[NAME], [command.name])
            elif isinstance(command, Add):
                self._add(obj, command)
            elif isinstance(command, Move):
                self._move(obj, command)
            else:
                gone.append(obj)
        if gone:
            self._removing.remove(gone)
        self._follow(commands)
        self._edited.add_imports()
        return self._edited.edits.splices()

    def _own(self, ref: Ref) -> EObject | None:
        """Returns an element that stands in this text, None where it stands elsewhere."""
        obj = self._context.find(ref)
        return obj if obj is not None and self._context.is_own(obj) else None

    def _set(self, obj: EObject, command: Set) -> None:
        feature = self._edited.table(obj).features[command.feature]
        if feature.is_reference:
            values: list[Any] = [self._edited.names.find(each) for each in command.values]
        else:
            values = converted(command.values, feature)
        self._put(obj, feature, values)

    def _put(self, obj: EObject, feature: FeatureTable, values: Sequence[Any]) -> None:
        """Gives an element other values of a feature."""
        part = self._edited.part(obj)
        change = FeatureChange(self._edited, obj, part, feature, values)
        if feature.name == NAME and not feature.many:
            self._put_name(change)
        elif feature.name == DOCUMENTATION:
            self._document(change)
        elif self._is_said_by_end(change):
            return
        elif isinstance(part, Element):
            self._values.set(change)
        else:
            self._mapping.set(change)

    def _put_name(self, change: FeatureChange) -> None:
        is_sayable = change.value is not None and is_name(change.value)
        if isinstance(change.part, Table | Vector) and not is_sayable:
            self._mapping.rewrite(change)
        else:
            self._heads.set_name(change.obj, change.part, change.value)

    def _document(self, change: FeatureChange) -> None:
        is_sayable = change.value is None or is_comment(change.value)
        if isinstance(change.part, Assignment | Ignored) and not is_sayable:
            self._heads.set_documentation(change.obj, change.part, None)
            self._mapping.say_as_block(change.obj, change.made)
        elif isinstance(change.part, Table | Vector | Entry) and not is_sayable:
            self._mapping.rewrite(change)
        else:
            self._heads.set_documentation(change.obj, change.part, change.value)

    def _is_said_by_end(self, change: FeatureChange) -> bool:
        """Sets a message or a type of a map where an end says it."""
        part, name = change.part, change.feature.name
        is_end = self._edited.table(change.obj).qualified_name == MAP and name in ENDS
        if not is_end or not isinstance(part, Element) or self._values.items(part, name):
            return False
        return self._mapping.set_end(change, part)

    def _add(self, owner: EObject, command: Add) -> None:
        [made] = [e for e in self._edited.copy(owner).owned[command.feature] if e.obj is None]
        self._adding.add(made)

    def _move(self, obj: EObject, command: Move) -> None:
        if self._own(command.owner) is None:
            what = name_of(obj) or obj.eClass.name
            reason = f"{what} is named in {self._context.file} by where it stands in that text"
            raise EditError(f"{reason}: copy it into the other file, and remove it here")
        self._moving.move(self._edited.copy(obj))

    def _follow(self, commands: Sequence[ElementCommand]) -> None:
        named = {}
        for command in commands:
            if isinstance(command, Rename):
                obj = self._context.find(command.element)
                if obj is not None:
                    named[obj] = command.name
        if named:
            Following(self._edited).rename(named)


class Following:
    """Writes references by name anew."""

    def __init__(self, edited: EditedText) -> None:
        self._edited = edited

    def rename(self, named: dict[EObject, str]) -> None:
        """Has references follow."""
        old = {step for each in named for step in _steps(name_of(each))}
        for node, child in named_references(self._edited.context.document):
            text = child.get(BY_NAME)
            if text is None or not old.intersection(_steps(text)):
                continue
            target = self._target(node, child)
            if target is not None:
                self._rename(child, text, target, named)

    def _rename(
        self,
        child: Node,
        text: str,
        target: EObject,
        named: dict[EObject, str],
    ) -> None:
        span = self._edited.written.value_span(child)
        new = renamed(text, target, named)
        if span is None or new == text:
            return
        written = simple(Name(new) if is_name(new) else self._edited.names.href(target))
        start, end = self._edited.source.range_of(span)
        self._edited.edits.replace(start, end, written)

    def _target(self, node: Node, child: Node) -> EObject | None:
        """Returns the element that a reference was resolved to."""
        feature = self._edited.table(node.obj).features[child.tag]
        value: Any = getattr(node.obj, feature.name)
        if not feature.many:
            return cast("EObject | None", value)
        alike = [each for each in node.children if each.tag == child.tag]
        targets = list(value)
        if len(targets) == len(alike):
            return cast("EObject", targets[next(i for i, e in enumerate(alike) if e is child)])
        return self._edited.names.meant(child.get(BY_NAME) or "", node.obj, feature)


def renamed(text: str, target: EObject, named: dict[EObject, str]) -> str:
    """Returns the name of an element once elements have other names."""
    parts = _PARTING.split(text)  # steps, with what parts them between
    end = len(parts)
    each: EObject | None = target
    while each is not None and end > 0:
        name = _PARTING.split(name_of(each))
        start = end - len(name)
        if name != [""] and parts[max(start, 0) : end] == name:
            if each in named:
                parts[start:end] = [named[each], *[""] * (len(name) - 1)]
            end = start - 1
            if end > 0 and parts[end - 1] in _FOLDERS and parts[end] == "/":
                end -= 2
        elif name != [""] and each is target and parts[-1] in _ROLES:
            end -= 2
        elif name != [""]:
            return text
        each = each.eContainer()
    return "".join(parts)


def _steps(name: str) -> list[str]:
    return _PARTING.split(name)[::2]
