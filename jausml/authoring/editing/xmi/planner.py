"""Planner of changes of XMI files."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, cast

from jausml.authoring.editing.commands import Add, Move, Remove, Rename, Set
from jausml.authoring.editing.splices import common_ends
from jausml.authoring.editing.working_copy import ElementCopy
from jausml.authoring.editing.xmi.names import (
    Names,
    element_lines,
    file_of,
    is_odd,
    items,
    reference_line,
    value_line,
)
from jausml.authoring.editing.xmi.source import Edits, Source
from jausml.language.metamodel import FeatureKind
from jausml.language.model.values import convert
from jausml.language.model.xmi.writer import attribute_text, lexical

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.authoring.editing.commands import ElementCommand
    from jausml.authoring.editing.drafts import Context
    from jausml.authoring.editing.splices import Splice
    from jausml.authoring.editing.xmi.names import Item
    from jausml.authoring.editing.xmi.source import Line
    from jausml.language.metamodel import DataTypeTable, FeatureTable
    from jausml.language.model.refs import Ref
    from jausml.language.model.xmi.parsing import Node

_NAME = "name"


def plan_xmi(commands: Sequence[ElementCommand], context: Context) -> list[Splice]:
    """Returns what is to change in an XMI file so that commands hold, all of one state."""
    return _Plan(context).run(commands) if context.document.root_nodes else []


class _Plan:
    """Plan of the changes of one file."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._working_copy = context.working_copy
        self._metamodels = context.model.metamodels
        self._source = Source(context.document, context.file)
        root = context.document.root_nodes[0]
        self._root = root.parent or root
        self._edits = Edits(self._source, self._root)
        self._names = Names(context, self._edits, self._root)
        self._set: set[tuple[ElementCopy, str]] = set()

    def run(self, commands: Sequence[ElementCommand]) -> list[Splice]:
        for each in commands:
            if isinstance(each, Remove):
                self._remove(each)
            elif isinstance(each, Set):
                self._change(each.element, each.feature)
            elif isinstance(each, Rename):
                self._change(each.element, _NAME)
        if any(not isinstance(each, Set) for each in commands):
            self._follow()
        # What moves takes along what was changed in it.
        for each in commands:
            if isinstance(each, Add):
                self._add(each)
            elif isinstance(each, Move):
                self._move(each)
        self._names.declare()
        return self._edits.splices()

    def _remove(self, command: Remove) -> None:
        copy = self._copy(command.element)
        if copy is not None and self._is_own(copy):
            self._edits.remove(self._node(copy))

    def _copy(self, ref: Ref) -> ElementCopy | None:
        return self._working_copy.find(ref)

    def _is_own(self, copy: ElementCopy) -> bool:
        """Tells whether a copy stands in the file as it is."""
        return copy.obj is not None and copy.file == self._context.file

    def _node(self, copy: ElementCopy) -> Node:
        return cast("Node", self._context.model.node_of(copy.obj))  # type: ignore[arg-type]

    def _change(self, ref: Ref, name: str) -> None:
        copy = self._copy(ref)
        if copy is None or not self._is_own(copy):
            return
        feature = copy.table.features[name]
        self._set.add((copy, name))
        if feature.kind is not FeatureKind.ATTRIBUTE:
            self._set_references(copy, feature)
        elif feature.many:
            self._set_values(copy, feature)
        else:
            self._set_value(copy, feature)

    def _set_value(self, copy: ElementCopy, feature: FeatureTable) -> None:
        node = self._node(copy)
        element = self._source.element(node)
        written = element.attribute(feature.name)
        values = copy.values.get(feature.name, ())
        text = values[0] if values else None
        if written is not None and _means(node.get(feature.name), feature) == values:
            return
        children = [each for each in node.children if each.tag == feature.name]
        if children:
            self._replace_children(copy, feature, children, self._value_lines(copy, feature))
        elif text is None:
            if written is not None:
                self._edits.remove_attribute(written)
        elif written is not None:
            self._edits.set_value(written, text)
        else:
            self._edits.add_attribute(element, feature.name, text, _later(copy, feature))

    def _set_values(self, copy: ElementCopy, feature: FeatureTable) -> None:
        node = self._node(copy)
        values = copy.values.get(feature.name, ())
        written = self._source.element(node).attribute(feature.name)
        if written is not None:
            words = tuple((node.get(feature.name) or "").split())
            if words == values:
                return
            if values and all(each and each.split() == [each] for each in values if each):
                self._edits.set_value(written, " ".join(each or "" for each in values))
                return
            self._edits.remove_attribute(written)
        children = [each for each in node.children if each.tag == feature.name]
        self._replace_children(copy, feature, children, self._value_lines(copy, feature))

    def _value_lines(self, copy: ElementCopy, feature: FeatureTable) -> list[str]:
        values = copy.values.get(feature.name, ())
        return [value_line(each, feature, self._names) for each in values]

    def _set_references(self, copy: ElementCopy, feature: FeatureTable) -> None:
        node = self._node(copy)
        targets = copy.references.get(feature.name, [])
        found = items(node, feature.name, self._source, self._names)
        if targets == [each.target for each in found] and all(map(self._is_right, found)):
            return
        words = [each for each in found if each.node is None]
        children = [each.node for each in found if each.node is not None]
        written = self._source.element(node).attribute(feature.name)
        # Elements of other files are referred to by child elements, those of this one are not.
        is_apart = not any(e.target and self._names.is_local(e.target) for e in found if e.node)
        if targets and is_apart and all(map(self._names.is_local, targets)):
            for child in children:
                self._edits.remove(child)
            text = " ".join(self._word(each, words) for each in targets)
            if written is not None:
                self._edits.set_value(written, text)
            else:
                element = self._source.element(node)
                self._edits.add_attribute(element, feature.name, text, _later(copy, feature))
            return
        if written is not None:
            self._edits.remove_attribute(written)
        kept = {each.target: each for each in found if each.node is not None and each.target}
        new = [self._element_text(each, kept.get(each), feature) for each in targets]
        self._replace_children(copy, feature, children, new)

    def _word(self, target: ElementCopy | Ref, words: list[Item]) -> str:
        known = next((each.text for each in words if each.target == target), "")
        is_kept = known and self._is_right(next(e for e in words if e.target == target))
        return known if is_kept else self._names.fragment(target)

    def _element_text(
        self, target: ElementCopy | Ref, item: Item | None, feature: FeatureTable
    ) -> str:
        """Returns a reference as an element: as it is written now, if that will be right."""
        if item is not None and item.node is not None and self._is_right(item):
            element = self._source.element(item.node)
            return self._source.text[element.start : element.end]
        return reference_line(target, feature, self._names)

    def _replace_children(
        self, copy: ElementCopy, feature: FeatureTable, old: Sequence[Node], new: Sequence[str]
    ) -> None:
        """Makes child elements of others, and leaves those that are among both."""
        texts = [self._text(each) for each in old]
        front, back = common_ends(texts, new)
        ours = list(old[front : len(old) - back])
        theirs = list(new[front : len(new) - back])
        paired = min(len(ours), len(theirs))
        for node, text in zip(ours, theirs, strict=False):
            self._edits.replace(node, text)
        for node in ours[paired:]:
            self._edits.remove(node)
        if theirs[paired:]:
            at = front + paired
            after = old[at - 1] if at else None
            before = old[at] if after is None and at < len(old) else None
            added: list[Line] = [(0, each) for each in theirs[paired:]]
            self._insert(copy, feature, after, before, added)

    def _text(self, node: Node) -> str:
        element = self._source.element(node)
        return self._source.text[element.start : element.end]

    def _add(self, command: Add) -> None:
        owner = self._copy(command.owner)
        if owner is not None and self._is_own(owner):
            made = [each for each in owner.owned[command.feature] if each.obj is None]
            for each in made:
                self._insert_copy(each, self._new_lines(each))

    def _move(self, command: Move) -> None:
        copy = self._copy(command.element)
        if copy is None:
            return
        owner = cast("ElementCopy", copy.owner)
        is_here = owner.root.file == self._context.file
        if self._is_own(copy):
            node = self._node(copy)
            is_same = is_here and self._is_same_feature(copy, node)
            added = self._edits.moved(node) if is_same else self._new_lines(copy)
            self._edits.remove(node)
        else:
            added = self._new_lines(copy)
        if is_here:
            self._insert_copy(copy, added)

    def _is_same_feature(self, copy: ElementCopy, node: Node) -> bool:
        """Tells whether a moved element is written in the new place as in the old one."""
        before = node.parent.obj if node.parent is not None else None
        feature = self._metamodels.class_of(before).features[node.tag] if before else None
        owner = cast("ElementCopy", copy.owner)
        after = owner.table.features[copy.feature]
        return feature is not None and feature.name == after.name and feature.target is after.target

    def _new_lines(self, copy: ElementCopy) -> list[Line]:
        owner = cast("ElementCopy", copy.owner)
        return element_lines(copy, owner.table.features[copy.feature], self._names)

    def _insert_copy(self, copy: ElementCopy, added: list[Line]) -> None:
        """Puts an element in its place among its siblings."""
        owner = cast("ElementCopy", copy.owner)
        earlier, later = copy.siblings
        after = next(filter(None, map(self._staying, reversed(earlier))), None)
        before = next(filter(None, map(self._staying, later)), None)
        feature = owner.table.features[copy.feature]
        self._insert(owner, feature, after, before if after is None else None, added)

    def _staying(self, copy: ElementCopy) -> Node | None:
        """Returns the element of a copy that stays where it is."""
        if not self._is_own(copy):
            return None
        node = self._node(copy)
        return None if self._edits.is_removed(node) else node

    def _insert(
        self,
        owner: ElementCopy,
        feature: FeatureTable,
        after: Node | None,
        before: Node | None,
        added: list[Line],
    ) -> None:
        node = self._node(owner)
        if after is None and before is None:
            order = {name: index for index, name in enumerate(owner.table.features)}
            staying = [each for each in node.children if not self._edits.is_removed(each)]
            earlier = [e for e in staying if order.get(e.tag, -1) < order[feature.name]]
            after = earlier[-1] if earlier else None
            before = staying[0] if staying and after is None else None
        self._edits.insert(node, after, before, added)

    def _follow(self) -> None:
        """Has references of the file follow what they refer to."""
        before, after = self._context.paths, self._paths
        shifted = {each for each, path in before.items() if after.get(each) != path}
        shifted |= {each for each in after if each.root.file != each.file}
        for roots in self._working_copy.roots.values():
            for copy in (each for root in roots for each in root.everything()):
                if self._is_own(copy):
                    self._follow_references(copy, shifted)

    @cached_property
    def _paths(self) -> dict[ElementCopy, str]:
        return self._working_copy.paths()

    def _follow_references(self, copy: ElementCopy, shifted: set[ElementCopy]) -> None:
        node = self._node(copy)
        for name, targets in copy.references.items():
            if (copy, name) in self._set:
                continue
            if not any(each in shifted for each in targets) and not is_odd(node, name):
                continue
            if any(file_of(each) != each.file for each in targets if isinstance(each, ElementCopy)):
                self._set_references(copy, copy.table.features[name])
                continue
            for item in items(node, name, self._source, self._names):
                if item.target is not None and not self._is_right(item):
                    fragment = attribute_text(self._names.fragment(item.target))
                    self._edits.put(item.start, item.end, fragment)

    def _is_right(self, item: Item) -> bool:
        """Tells whether a reference will still mean what it means."""
        target = item.target
        if not isinstance(target, ElementCopy):
            return True
        if target.root.file != target.file:
            return False
        if item.is_path:
            return self._context.paths.get(target) == self._paths.get(target)
        return not item.is_odd


def _later(copy: ElementCopy, feature: FeatureTable) -> set[str]:
    """Returns the features of an element that the metamodel has behind one."""
    order = list(copy.table.features)
    return set(order[order.index(feature.name) + 1 :])


def _means(text: str | None, feature: FeatureTable) -> tuple[str, ...] | None:
    value, fault = convert(text or "", cast("DataTypeTable", feature.data_type))
    return (lexical(value, feature),) if fault is None else None
