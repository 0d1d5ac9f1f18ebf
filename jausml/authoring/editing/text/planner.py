"""Planner of changes of texts: the syntax tree is changed, and laid out as a whole.

Unchanged nodes are those that were parsed. Changed ones are written as by the writer of texts, and
keep their comments.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, cast

from jausml.authoring.editing.applying import converted
from jausml.authoring.editing.commands import (
    Add,
    EditError,
    ElementCommand,
    Move,
    Remove,
    Rename,
    Set,
)
from jausml.authoring.editing.drafts import Context
from jausml.authoring.editing.reading import encoded
from jausml.authoring.editing.text.blocks import Blocks
from jausml.authoring.editing.text.following import with_words, words_for
from jausml.authoring.editing.text.naming import Naming
from jausml.authoring.editing.text.pieces import heading_of
from jausml.authoring.editing.working_copy import ElementCopy
from jausml.language.metamodel.classes import bridge
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.metamodel.filling import contents
from jausml.language.model.names import name_of
from jausml.language.model.refs import Ref
from jausml.language.semantics.connections.exchanges import CONNECTION, FEATURES
from jausml.language.text.keywords import keyword_of
from jausml.language.text.reading.document import TextDocument
from jausml.language.text.tree import Element, Import, Item, Name, SyntaxTree
from jausml.language.text.writing.layout import lay_out


def print_text(commands: Sequence[ElementCommand], context: Context) -> bytes | None:
    """Returns the text after commands, all of one state; None where it stays as it is."""
    tree = _Plan(context).tree(commands)
    return encoded(lay_out(tree), context.document.data) if tree is not None else None


def is_laid_out_text(context: Context) -> bool:
    """Tells whether a text is laid out as `print_text` does it."""
    document = context.document
    tree = cast("TextDocument", document.written).tree
    return encoded(lay_out(tree), document.data) == document.data


class _Plan:
    """Plan of one text."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._copies = context.working_copy.copies
        self._names = Naming(context)
        self._blocks = Blocks(context, self._names)
        self._is_touched = False

    def tree(self, commands: Sequence[ElementCommand]) -> SyntaxTree | None:
        """Returns the tree after commands, None where they do not concern the text."""
        for command in commands:
            self._note(command)
        words = words_for(commands, self._context, self._names)
        if not self._is_touched and not words:
            return None
        tree = self._blocks.written.tree
        items: list[Any] = self._blocks.items(tree.items) if self._is_touched else [*tree.items]
        self._keep_roots(items)
        imports = [Import(location) for location in self._names.imports]
        if imports:
            at = max(
                (index + 1 for index, item in enumerate(items) if isinstance(item, Import)),
                default=0,
            )
            behind = items[at : at + 1]
            if behind:
                # The heading comment stays the first.
                heading = heading_of(behind[0]) if not at else []
                own = behind[0].comments[len(heading) :]
                imports[0].comments = heading
                behind = [replace(behind[0], spaced=True, comments=own)]
            items = [*items[:at], *imports, *behind, *items[at + 1 :]]
        return SyntaxTree(with_words(items, words) if words else items, tree.closing)

    def _note(self, command: ElementCommand) -> None:
        """Notes the changes of a command in this text."""
        obj = self._own(command.owner if isinstance(command, Add) else command.element)
        if obj is None:
            return
        copy = self._copies[obj]
        if isinstance(command, Rename):
            if command.name != name_of(obj):
                self._change(copy, "name", is_said=True)
        elif isinstance(command, Set):
            if not self._is_so(obj, command):
                self._change(copy, command.feature, is_said=bool(command.values))
        elif isinstance(command, Add):
            [new_copy] = [owned for owned in copy.owned[command.feature] if owned.obj is None]
            self._place(new_copy)
        elif isinstance(command, Move):
            self._move(copy, obj, command)
        elif isinstance(command, Remove):
            self._take(copy, obj)

    def _own(self, ref: Ref) -> EObject | None:
        """Returns an element of this text, None for one of another file."""
        obj = self._context.find(ref)
        return obj if obj is not None and self._context.is_own(obj) else None

    def _is_so(self, obj: EObject, command: Set) -> bool:
        """Tells whether the text has the values of a command already."""
        table = self._context.model.metamodels.class_of(obj)
        feature, node = table.features[command.feature], self._context.model.node_of(obj)
        is_said = node is not None and any(child.tag == feature.name for child in node.children)
        if not command.values:
            return not is_said
        if feature.is_reference:
            values: list[Any] = [self._names.find(value) for value in command.values]
        else:
            values = converted(command.values, feature)
        old = list(contents(obj, feature)) if feature.many else [getattr(obj, feature.name)]
        # An inferred value follows from others, which may change.
        is_open = table.qualified_name == CONNECTION and feature.name in FEATURES
        must_be_said = is_open or feature.unsettable
        return old == values and (is_said or not must_be_said)

    def _change(self, copy: ElementCopy, name: str, *, is_said: bool) -> None:
        if self._blocks.part(copy) is None:
            raise self._blocks.refusal(copy)
        self._blocks.changed.setdefault(copy, {})[name] = is_said
        self._touch(copy)

    def _place(self, copy: ElementCopy) -> None:
        self._blocks.placed.append(copy)
        self._touch(cast("ElementCopy", copy.owner))

    def _take(self, copy: ElementCopy, obj: EObject) -> None:
        part, owner = self._blocks.part(copy), obj.eContainer()
        if part is None:
            raise self._blocks.refusal(copy)
        self._blocks.gone.add(id(part))
        self._is_touched = True
        if owner is not None:
            self._touch(self._copies[owner])

    def _move(self, copy: ElementCopy, obj: EObject, command: Move) -> None:
        owner = self._own(command.owner)
        if owner is None:
            what = name_of(obj) or obj.eClass.name
            reason = f"{what} is named in {self._context.file} by where it stands in that text"
            raise EditError(f"{reason}: copy it into the other file, and remove it here")
        is_here = obj.eContainer() is owner and obj.eContainmentFeature().name == copy.feature
        table = self._context.model.metamodels.class_of(owner)
        before = list(contents(owner, table.features[copy.feature]))
        # It has this place already; a move would make its block anew.
        if is_here and before.index(obj) == len(copy.siblings[0]):
            return
        _check_names(obj, owner)
        self._take(copy, obj)
        self._place(copy)

    def _touch(self, copy: ElementCopy) -> None:
        """Marks the block of an element, and those around it, to be made anew."""
        self._is_touched = True
        around: ElementCopy | None = copy
        while around is not None:
            part = self._blocks.part(around)
            if part is not None:
                self._blocks.touched[id(part)] = around
            around = around.owner

    def _keep_roots(self, items: list[Item]) -> None:
        """Writes roots that the text no longer implies."""
        for root in self._blocks.implied:
            owned = self._context.model.owned(cast("EObject", root.obj))
            before = [part for part in map(self._blocks.part_of, owned) if part is not None]
            left = [copy for some in root.owned.values() for copy in some]
            # A root without parts is not implied, and would be lost with its name.
            if before and all(copy.obj and self._blocks.part(copy) is None for copy in left):
                items.append(Element(Name(keyword_of(root.table.name)), Name(root.name)))


def _check_names(obj: EObject, owner: EObject) -> None:
    """Refuses a move to a map where the names of conversions mean other quantities and tables."""
    if not isinstance(owner, bridge.AttributeMap) or obj.eContainer() is owner:
        return
    there = {str(quantity.name): quantity for quantity in (*owner.quantities, *owner.tables)}
    for conversion in getattr(obj, "conversions", ()):
        for named in (conversion.quantity, conversion.table):
            if named is not None and there.get(str(named.name), named) is not named:
                raise EditError(f"'{named.name}' is another one in map '{owner.name}'")
