"""Planner of changes of ros2jaus texts."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, cast

from jausml.authoring.editing.commands import Add, EditError, Move, Remove, Rename, Set
from jausml.authoring.editing.sketches import assign, converted, copied, drawn, feature_of, owning
from jausml.authoring.editing.text.adding import Adding
from jausml.authoring.editing.text.edited import Desk, Places
from jausml.authoring.editing.text.mapping import ENDS, Mapping
from jausml.authoring.editing.text.moving import Moving, Removing
from jausml.authoring.editing.text.naming import named_references
from jausml.authoring.editing.text.values import DOCUMENTATION, NAME, Heads, Values
from jausml.language.metamodel import FeatureKind
from jausml.language.metamodel.classes import bridge
from jausml.language.metamodel.filling import contents, hang, set_value
from jausml.language.model.names import name_of
from jausml.language.model.notation import BY_NAME
from jausml.language.model.xmi.writer import UnwritableError
from jausml.language.semantics.ways import FEATURES, settle
from jausml.language.text.tree import Assignment, Element, Entry, Ignored, Name, Table, Vector
from jausml.language.text.writing.heads import is_comment
from jausml.language.text.writing.layout import simple
from jausml.language.text.writing.literals import is_name
from jausml.language.text.writing.maps import MAP

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.authoring.editing.commands import Child, Command
    from jausml.authoring.editing.planning import Context
    from jausml.authoring.editing.splices import Splice
    from jausml.authoring.editing.text.outline import Part
    from jausml.language.metamodel import DataTypeTable, FeatureTable, Metamodels
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.xmi.parsing import Node


class TextPlanner:
    """Plans changes of ros2jaus texts, as `jausml.authoring.editing.planning.Planner` says."""

    def plan(self, commands: Sequence[Command], context: Context) -> list[Splice]:
        """Returns what is to change in one file so that commands hold."""
        try:
            return _Plan(context).run(commands)
        except UnwritableError as error:
            raise EditError(str(error)) from error


class _Plan:
    """Plan of the changes of one text."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._metamodels = context.model.metamodels
        self._desk = Desk(context)
        places = Places(self._desk)
        self._values = Values(self._desk, places)
        self._heads = Heads(self._desk, self._values)
        self._mapping = Mapping(self._desk, self._values)
        self._adding = Adding(self._desk, places, self._mapping)
        self._removing = Removing(self._desk)
        self._moving = Moving(self._desk, places, self._adding, self._removing)

    def run(self, commands: Sequence[Command]) -> list[Splice]:
        """Returns the splices of commands."""
        gone = [each for command in commands for each in self._own(command, Remove)]
        for command in commands:
            if isinstance(command, Set):
                for obj in self._own(command, Set):
                    self._set(obj, command)
            elif isinstance(command, Rename):
                for obj in self._own(command, Rename):
                    self._rename(obj, command.name)
            elif isinstance(command, Add):
                self._add(command)
            elif isinstance(command, Move):
                for obj in self._own(command, Move):
                    self._move(obj, command)
        if gone:
            self._removing.remove(gone)
        self._follow(commands)
        self._desk.add_imports()
        return self._desk.edits.splices()

    def _own(self, command: Command, kind: type[Set | Rename | Move | Remove]) -> list[EObject]:
        """Returns the element of a command of a kind, if it stands in this text."""
        if not isinstance(command, kind):
            return []
        obj = self._context.find(command.element)
        return [obj] if obj is not None and self._context.is_own(obj) else []

    def _set(self, obj: EObject, command: Set) -> None:
        feature = feature_of(self._desk.table(obj), command.feature)
        if feature.kind is FeatureKind.CONTAINMENT:
            raise EditError(f"{feature.name} owns elements: add, move and remove them")
        if feature.is_reference:
            if len(command.values) > 1 and not feature.many:
                raise EditError(f"{feature.name} takes one value")
            values = [self._desk.names.find(each, feature) for each in command.values]
        else:
            values = converted(command.values, feature)
        self._put(obj, feature, values)

    def _put(self, obj: EObject, feature: FeatureTable, values: Sequence[Any]) -> None:
        """Gives an element other values of a feature."""
        part = self._desk.part(obj)
        sketch, _ = copied(obj, self._metamodels, (obj, feature.name))
        assign(sketch, feature, values)
        value = values[0] if values else None
        if feature.name == NAME and not feature.many:
            self._put_name(obj, part, feature, value)
        elif feature.name == DOCUMENTATION:
            self._document(obj, part, sketch, feature, value)
        elif self._is_said_by_end(obj, part, sketch, feature):
            return
        elif isinstance(part, Element):
            self._values.set(obj, part, sketch, feature, values)
        else:
            self._mapping.set(obj, part, sketch, feature, values)

    def _put_name(self, obj: EObject, part: Part, feature: FeatureTable, name: str | None) -> None:
        if isinstance(part, Table | Vector) and (name is None or not is_name(name)):
            self._mapping.rewrite(obj, feature, [] if name is None else [name])
        else:
            self._heads.set_name(obj, part, name)

    def _document(
        self, obj: EObject, part: Part, sketch: EObject, feature: FeatureTable, text: str | None
    ) -> None:
        is_sayable = text is None or is_comment(text)
        if isinstance(part, Assignment | Ignored) and not is_sayable:
            self._heads.set_documentation(obj, part, None)
            self._mapping.say_as_block(obj, sketch)
        elif isinstance(part, Table | Vector | Entry) and not is_sayable:
            self._mapping.rewrite(obj, feature, [text])
        else:
            self._heads.set_documentation(obj, part, text)

    def _is_said_by_end(
        self, obj: EObject, part: Part, sketch: EObject, feature: FeatureTable
    ) -> bool:
        """Sets a message or a type of a map where an end says it."""
        is_end = self._desk.table(obj).qualified_name == MAP and feature.name in ENDS
        if not is_end or not isinstance(part, Element) or self._values.items(part, feature.name):
            return False
        return self._mapping.set_end(obj, part, sketch, feature)

    def _rename(self, obj: EObject, name: str) -> None:
        self._put(obj, feature_of(self._desk.table(obj), NAME), [name])

    def _add(self, command: Add) -> None:
        owner = self._context.find(command.owner)
        if owner is None or not self._context.is_own(owner):
            return
        table = self._desk.table(owner)
        feature = owning(table, command.feature, command.kind, self._metamodels)
        sketch = drawn(command, self._metamodels, self._desk.names.find)
        hang(sketch, owner, feature)
        _settle(sketch, command, self._metamodels)
        self._adding.add(owner, feature, sketch, command.position)

    def _move(self, obj: EObject, command: Move) -> None:
        owner = self._context.find(command.owner)
        if owner is None or not self._context.is_own(owner):
            what = name_of(obj) or obj.eClass.name
            reason = f"{what} is named in {self._context.file} by where it stands in that text"
            raise EditError(f"{reason}: copy it into the other file, and remove it here")
        around: EObject | None = owner
        while around is not None:
            if around is obj:
                raise EditError("an element cannot move into itself")
            around = around.eContainer()
        kind = self._desk.table(obj).qualified_name
        feature = owning(self._desk.table(owner), command.feature, kind, self._metamodels)
        self._moving.move(obj, owner, feature, command.position)

    def _follow(self, commands: Sequence[Command]) -> None:
        named = {}
        for command in commands:
            if isinstance(command, Rename):
                obj = self._context.find(command.element)
                if obj is not None:
                    named[obj] = command.name
        if named:
            Following(self._desk).rename(named)


def _settle(sketch: EObject, command: Add | Child, metamodels: Metamodels) -> None:
    """Gives new connections the way that follows from all else, where a command leaves it open.

    So the text leaves it open too.
    """
    table = metamodels.class_of(sketch)
    if isinstance(sketch, bridge.Connection):
        given = [next(iter(command.values.get(name, ())), None) for name in FEATURES]
        settled = settle(sketch, *given)
        for name in FEATURES:
            literals = cast("DataTypeTable", table.features[name].data_type).literals
            set_value(sketch, table.features[name], literals[getattr(settled, name)])
    owned = {name: iter(contents(sketch, each)) for name, each in table.features.items()}
    for child in command.children:
        _settle(next(owned[child.feature]), child, metamodels)


_PARTING = re.compile("([./])")


_ROLES = ("request", "response", "goal", "result", "feedback")
"""Steps that say which part of a service or an action is meant."""


_FOLDERS = ("msg", "srv", "action")
"""Steps that a ROS name may have, and that name nothing."""


class Following:
    """Writes references by name anew."""

    def __init__(self, desk: Desk) -> None:
        self._desk = desk

    def rename(self, named: dict[EObject, str]) -> None:
        """Has references follow."""
        old = {step for each in named for step in _steps(name_of(each))}
        for node, child in named_references(self._desk.context.document):
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
        span = self._desk.written.value_span(child)
        new = renamed(text, target, named)
        if span is None or new == text:
            return
        written = simple(Name(new) if is_name(new) else self._desk.names.href(target))
        start, end = self._desk.source.range_of(span)
        self._desk.edits.replace(start, end, written)

    def _target(self, node: Node, child: Node) -> EObject | None:
        """Returns the element that a reference was resolved to."""
        feature = self._desk.table(node.obj).features[child.tag]
        value: Any = getattr(node.obj, feature.name)
        if not feature.many:
            return cast("EObject | None", value)
        alike = [each for each in node.children if each.tag == child.tag]
        targets = list(value)
        if len(targets) == len(alike):
            return cast("EObject", targets[next(i for i, e in enumerate(alike) if e is child)])
        return self._desk.names.meant(child.get(BY_NAME) or "", node.obj, feature)


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
