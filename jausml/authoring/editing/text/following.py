"""References by name that follow when what they name gets another name."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from functools import cache
from typing import Any, cast

from jausml.authoring.editing.commands import ElementCommand, Rename
from jausml.authoring.editing.drafts import Context
from jausml.authoring.editing.text.naming import Naming, named_references
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.names import name_of
from jausml.language.model.notation import BY_NAME
from jausml.language.model.xmi.parsing import Node
from jausml.language.text.reading.document import TextDocument
from jausml.language.text.tree import Call, Href, Item, Name
from jausml.language.text.writing.spelling import is_name

_PARTING = re.compile("([./])")

_ROLES = ("request", "response", "goal", "result", "feedback")
"""Steps that say which part of a service or an action is meant."""

_FOLDERS = ("msg", "srv", "action")  # steps that a ROS name may have, and that name nothing


def words_for(
    commands: Sequence[ElementCommand], context: Context, names: Naming
) -> dict[int, Name | Href]:
    """Returns the names that stand for others once elements have new ones, by id of their spans."""
    named = {}
    for command in commands:
        obj = context.find(command.element) if isinstance(command, Rename) else None
        if obj is not None and isinstance(command, Rename):
            named[obj] = command.name
    words: dict[int, Name | Href] = {}
    old = {step for element in named for step in _steps(name_of(element))}
    written = cast("TextDocument", context.document.written)
    for node, child in named_references(context.document) if named else ():
        text = child.get(BY_NAME)
        # Few references have a step of an old name, and finding the target is costly.
        if text is None or not old.intersection(_steps(text)):
            continue
        target, span = _target(node, child, context, names), written.value_span(child)
        new = renamed(text, target, named) if target is not None else text
        if target is not None and span is not None and new != text:
            words[id(span)] = Name(new) if is_name(new) else names.href(target)
    return words


def _target(node: Node, child: Node, context: Context, names: Naming) -> EObject | None:
    """Returns the element that a reference was resolved to."""
    feature = context.model.metamodels.class_of(node.obj).features[child.tag]
    value: Any = getattr(node.obj, feature.name)
    if not feature.many:
        return cast("EObject | None", value)
    alike = [node_child for node_child in node.children if node_child.tag == child.tag]
    targets = list(value)
    # A name that led nowhere has no target, so positions agree only if none is missing.
    if len(targets) == len(alike):
        return cast(
            "EObject",
            targets[next(index for index, element in enumerate(alike) if element is child)],
        )
    return names.meant(child.get(BY_NAME) or "", node.obj, feature)


def with_words(value: Any, words: Mapping[int, Name | Href]) -> Any:
    """Returns a part of a syntax tree in which names stand for others.

    `words`: by the ids of the spans of the names that they stand for.
    """
    if isinstance(value, Name):
        return words.get(id(value.span), value)
    if isinstance(value, list | tuple):
        elements = [with_words(element, words) for element in value]
        is_same = all(one is other for one, other in zip(value, elements, strict=True))
        # What stays must be the same object, since spans are known by their ids.
        return value if is_same else tuple(elements) if isinstance(value, tuple) else elements
    if not isinstance(value, Item | Call):
        return value
    kind: Any = type(value)
    parts = {name: getattr(value, name) for name in _parts(kind)}
    new = {name: with_words(part, words) for name, part in parts.items()}
    changed = {name: part for name, part in new.items() if part is not parts[name]}
    return replace(value, **changed) if changed else value


@cache
def _parts(kind: Any) -> tuple[str, ...]:
    # Comments and layout hold no names.
    beside = {field.name for field in fields(Item)} | {"closing"}
    return tuple(field.name for field in fields(kind) if field.name not in beside)


def renamed(text: str, target: EObject, named: dict[EObject, str]) -> str:
    """Returns the name of an element once elements have other names."""
    parts = _PARTING.split(text)  # steps, with what parts them between
    end = len(parts)
    element: EObject | None = target
    # From the last step to the first, since owners follow outwards.
    while element is not None and end > 0:
        name = _PARTING.split(name_of(element))
        start = end - len(name)
        # Elements without a name have no step.
        if name != [""] and parts[max(start, 0) : end] == name:
            if element in named:
                # Emptied, not taken out: the indices of the steps before must stay.
                parts[start:end] = [named[element], *[""] * (len(name) - 1)]
            end = start - 1
            if end > 0 and parts[end - 1] in _FOLDERS and parts[end] == "/":
                end -= 2
        elif name != [""] and element is target and parts[-1] in _ROLES:
            end -= 2
        elif name != [""]:
            return text
        element = element.eContainer()
    return "".join(parts)


def _steps(name: str) -> list[str]:
    return _PARTING.split(name)[::2]
