"""References of a text that follow elements which get another name."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, cast

from jausml.authoring.editing.text.naming import named_references
from jausml.language.model.names import name_of
from jausml.language.model.notation import BY_NAME
from jausml.language.text.tree import Name
from jausml.language.text.writing.layout import simple
from jausml.language.text.writing.literals import is_name

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.authoring.editing.text.desk import Desk
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.xmi.parsing import Node

_PARTING = re.compile("([./])")
_ROLES = ("request", "response", "goal", "result", "feedback")
"""Steps that say which part of a service or an action is meant."""
_FOLDERS = ("msg", "srv", "action")
"""Steps that a ROS name may have, and that name nothing."""


class Following:
    """Writes references by name anew."""

    def __init__(self, desk: Desk) -> None:
        self._desk = desk

    def rename(self, named: Mapping[EObject, str]) -> None:
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
        named: Mapping[EObject, str],
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


def renamed(text: str, target: EObject, named: Mapping[EObject, str]) -> str:
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
