"""Finds the XML element that a fragment names, as EMF does for objects.

Fragments are followed over XML elements and not over model elements, so that a fragment that passes
a faulty element still counts positions as its author did.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from urllib.parse import unquote

from jausml.model.documents import Document
from jausml.model.parsing import Node

Follow = Callable[[Document, Node], "tuple[Document, Node] | None"]
"""Replaces a child element with an href by the element of the document that it names."""

_STEP = re.compile(r"@([^\[\].]+)(?:\.([0-9]+)|\[(.*)\])?", re.DOTALL)
_PREDICATE = re.compile(r"\s*([^=,]+?)\s*=\s*(?:'([^']*)'|\"([^\"]*)\")\s*(?:,|$)")


def find(document: Document, fragment: str, follow: Follow) -> tuple[Document, Node] | None:
    """Finds an element by fragment.

    Args:
        document: The document to look in.
        fragment: An id (`_x1`), a path (`/`, `//@a.0/@b`, `/1`, `//@a[name='b']`), or names from
            the root on (`//Name`).
        follow: How to step over a child element that lies in another document.

    Returns:
        The document and the XML element, None when there is none.
    """
    fragment = _without_query(fragment)
    if not fragment:
        return None
    if not fragment.startswith("/"):
        node = document.ids.get(fragment) or document.ids.get(unquote(fragment))
        return (document, node) if node is not None else None
    _, root_step, *steps = fragment.split("/")
    if root_step and not root_step.isdecimal():
        return None
    position = int(root_step) if root_step else 0
    if position >= len(document.root_nodes):
        return None
    found: tuple[Document, Node] | None = (document, document.root_nodes[position])
    for step in steps:
        if found is None:
            return None
        found = _step(*found, step)
        if found is not None and found[1].get("href") is not None:
            found = follow(*found) or found
    return found


def _without_query(fragment: str) -> str:
    """Drops the description that EMF may add to a fragment as `...?text?`."""
    if len(fragment) > 1 and fragment.endswith("?"):
        start = fragment.rfind("?", 0, -1)
        return fragment[:start] if start > 0 else fragment
    return fragment


def _step(document: Document, node: Node, step: str) -> tuple[Document, Node] | None:
    match = _STEP.fullmatch(step)
    if match is None:
        named = [child for child in node.children if _matches(child, "name", unquote(step))]
        return (document, named[0]) if step and named else None
    tag, index, predicate = match.groups()
    children = document.children(node, tag)
    if predicate is not None:
        children = [child for child in children if _holds(child, predicate)]
    position = int(index) if index is not None else 0
    return (document, children[position]) if position < len(children) else None


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
