"""Upgrades of text, which names no version: what has an old name gets the new one."""

from __future__ import annotations

from itertools import accumulate
from typing import TYPE_CHECKING

from jausml.authoring.projects.upgrading.steps import UpgradeError, new_name
from jausml.language.text.keywords import classes_by_keyword
from jausml.language.text.reading.parsing import parse
from jausml.language.text.tree import Element, Feature, is_map, lists_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.authoring.projects.upgrading.steps import Step
    from jausml.language.metamodel import ClassTable, Metamodels
    from jausml.language.text.tree import Item, Name

_MAP = "bridge.AttributeMap"


def upgraded_text(data: bytes, file: str, metamodels: Metamodels, steps: Sequence[Step]) -> bytes:
    """Returns a text whose features have their present names; the very bytes where they have.

    Args:
        data: The file.
        file: Its name.
        metamodels: The present metamodels.
        steps: The table of upgrades.

    Raises:
        UpgradeError: It cannot be parsed.
    """
    try:
        text = data.decode("utf-8")
    except ValueError as error:
        raise UpgradeError(f"{file}: it is no UTF-8") from error
    parsed = parse(text)
    if parsed.faults:
        span = parsed.faults[0].span
        raise UpgradeError(f"{file}:{span.line}:{span.column}: {parsed.faults[0].message}")
    if not any(step.renamed for step in steps):
        return data
    mark = len(text) - len(text.removeprefix("\ufeff"))
    lines = [mark, *accumulate(map(len, text[mark:].splitlines(keepends=True)), initial=mark)][1:]
    changes = []
    for name, new in _renamed(parsed.document.items, None, _Classes(metamodels), steps):
        start = lines[name.span.line - 1] + name.span.column - 1
        changes.append((start, start + len(name.text), new))
    for start, end, new in sorted(changes, reverse=True):
        text = text[:start] + new + text[end:]
    return text.encode("utf-8")


class _Classes:
    """The classes that blocks stand for."""

    def __init__(self, metamodels: Metamodels) -> None:
        self._by_keyword = classes_by_keyword(metamodels)
        self._classes = metamodels.classes

    def of(self, block: Element, owner: ClassTable | None, feature: str) -> ClassTable | None:
        """Returns the class of a block, None for one that is not known."""
        if block.keyword is not None:
            return self._by_keyword.get(block.keyword.text)
        if is_map(block.items):
            return self._classes[_MAP]
        found = owner.features.get(feature) if owner is not None else None
        return found.target if found is not None else None


def _renamed(
    items: Sequence[Item], owner: ClassTable | None, classes: _Classes, steps: Sequence[Step]
) -> Iterator[tuple[Name, str]]:
    """Yields the names of features that change, each with the new one."""
    for item in items:
        if isinstance(item, Element):
            yield from _renamed(item.items, classes.of(item, owner, ""), classes, steps)
        elif isinstance(item, Feature):
            name = item.name.text
            new = new_name(owner, name, steps) if owner is not None else name
            if new != name:
                yield item.name, new
            for each in item.values:
                if isinstance(each, Element):
                    table = classes.of(each, owner, new)
                    yield from _renamed(each.items, table, classes, steps)
        else:
            for inner, _ in lists_of(item):
                yield from _renamed(inner, owner, classes, steps)
