"""Finder of the XML element that a fragment names, as EMF does it for objects.

Fragments are followed over XML elements and not over model elements, so that a fragment that passes
a faulty element still counts positions as its author did.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING
from urllib.parse import unquote

from jausml.language.metamodel import FeatureKind
from jausml.language.model.documents import Document
from jausml.language.model.xmi.parsing import Node

if TYPE_CHECKING:
    from jausml.language.metamodel import Metamodels

Follow = Callable[[Document, Node], "Found | None"]
"""Steps from a child element with an href to the element of the document that it names."""

_STEP = re.compile(r"@([^\[\].]+)(?:\.([0-9]{1,9})|\[(.*)\])?", re.DOTALL)
_PREDICATE = re.compile(r"\s*([^=,]+?)\s*=\s*(?:'([^']*)'|\"([^\"]*)\")\s*(?:,|$)")


@dataclass(frozen=True, slots=True)
class Found:
    """The element that a fragment names.

    Attributes:
        by_name: True when the fragment uses names, which EMF does not resolve in models.
    """

    document: Document
    node: Node
    by_name: bool = False


class FragmentFinder:
    """Finds elements by fragment."""

    def __init__(self, metamodels: Metamodels, follow: Follow) -> None:
        self._metamodels = metamodels
        self._follow = follow

    def find(self, document: Document, fragment: str) -> Found | None:
        """Finds an element.

        Returns:
            The element, None when there is none.
        """
        fragment = _without_description(fragment)
        if not fragment.startswith("/"):
            node = document.ids.get(fragment) or document.ids.get(unquote(fragment))
            return Found(document, node) if node is not None else None
        _, root_step, *steps = fragment.split("/")
        if root_step and not re.fullmatch("[0-9]{1,9}", root_step):
            return None
        position = int(root_step) if root_step else 0
        if position >= len(document.root_nodes):
            return None
        found: Found | None = Found(document, document.root_nodes[position])
        for step in steps:
            if found is None or found.node.obj is None:
                return found
            found = self._step(found, step)
            if found is not None and found.node.get("href") is not None:
                found = self._follow(found.document, found.node) or found
        return found

    def _step(self, at: Found, step: str) -> Found | None:
        match = _STEP.fullmatch(step)
        if match is None:
            wanted = unquote(step)
            named = [child for child in at.node.children if _matches(child, "name", wanted)]
            return Found(at.document, named[0], by_name=True) if step and named else None
        tag, index, predicate = match.groups()
        feature = self._metamodels.class_of(at.node.obj).features.get(tag)
        indexed = index is not None or predicate is not None
        if feature is not None and (
            feature.kind is not FeatureKind.CONTAINMENT or feature.many != indexed
        ):
            return None
        children = at.document.children(at.node, tag)
        if predicate is not None:
            children = [child for child in children if _holds(child, predicate)]
        position = int(index) if index is not None else 0
        if position >= len(children):
            return None
        return Found(at.document, children[position], at.by_name)


def _without_description(fragment: str) -> str:
    """Drops the description that EMF may add to a fragment as `...?text?`."""
    if len(fragment) > 1 and fragment.endswith("?"):
        start = fragment.rfind("?", 0, -1)
        return fragment[:start] if start > 0 else fragment
    return fragment


def _holds(node: Node, predicate: str) -> bool:
    at = 0
    while match := _PREDICATE.match(predicate, at):
        key, single, double = match.groups()
        if not _matches(node, key, unquote(single if single is not None else double)):
            return False
        at = match.end()
    return at == len(predicate) and at > 0


def _matches(node: Node, key: str, value: str) -> bool:
    written = node.get(key)
    if written is None:
        element = next((child for child in node.children if child.tag == key), None)
        written = element.text if element is not None else None
    return written == value
