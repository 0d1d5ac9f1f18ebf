"""Check of JSIDL files against the vocabulary, before anything is made of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.importers.jsidl.findings import Findings, Place
from jausml.language.importers.jsidl.vocabulary import (
    NAMESPACES,
    PLUS,
    ROOTS,
    VOCABULARY,
    ElementRule,
)
from jausml.language.model.values import nearest, show, suggest

if TYPE_CHECKING:
    from jausml.language.model.documents import Document
    from jausml.language.model.xmi.parsing import Node


def is_jsidl(root: Node) -> bool:
    """Tells by its namespace whether a root element is one of JSIDL."""
    return root.namespace in (*NAMESPACES, PLUS)


def check_document(document: Document, root: Node, findings: Findings) -> bool:
    """Checks all elements and attributes of a file, and drops what editors added.

    Args:
        root: Its root element; elements that were reported or belong to editors are taken out.

    Returns:
        Whether the file is a JSIDL file at all.
    """
    place = Place(document, root)
    if not is_jsidl(root):
        message = f"<{root.tag}> is of namespace {show(root.namespace)}, not of JSIDL"
        if not root.namespace:
            message = f"<{root.tag}> has no namespace"
        findings.report("JML601", place, message, f'write xmlns="{NAMESPACES[0]}"')
        return False
    if root.tag not in ROOTS:
        message = f"<{root.tag}> is not the root of a JSIDL file"
        hint = suggest(root.tag, ROOTS) or f"one of {', '.join(ROOTS)}"
        findings.report("JML601", place, message, hint)
        return False
    pending = [root]
    while pending:
        node = pending.pop()
        rule = VOCABULARY[node.tag]
        _check_attributes(Place(document, node), rule, findings)
        node.children = [
            child for child in node.children if _is_known(Place(document, child), rule, findings)
        ]
        pending += node.children
        if not rule.has_text and node.text.strip():
            message = f"text {show(node.text.strip())} has no meaning in <{node.tag}>"
            findings.report("JML602", Place(document, node), message)
    return True


def _is_known(place: Place, rule: ElementRule, findings: Findings) -> bool:
    node = place.node
    if node.namespace in NAMESPACES or (node.namespace == PLUS and node.tag in rule.children):
        if node.tag in rule.children:
            return True
        parent = node.parent.tag if node.parent is not None else ""
        message = f"<{parent}> has no element <{node.tag}>"
        findings.report("JML602", place, message, suggest(node.tag, rule.children))
    elif node.namespace != PLUS:
        message = f"<{node.tag}> of namespace {show(node.namespace)} is no part of JSIDL"
        findings.report("JML602", place, message)
    return False


def _check_attributes(place: Place, rule: ElementRule, findings: Findings) -> None:
    node = place.node
    names = [name for name in node.attributes[::2] if " " not in name]
    missing = sorted(name for name in rule.required if name not in names)
    for name in names:
        # Editors keep the look of their diagrams in attributes mx...
        if name in rule.attributes or name.startswith("mx"):
            continue
        near = nearest(name, missing) or nearest(name, rule.attributes)
        if near in missing:
            missing.remove(near)
        hint = f"did you mean '{near}'?" if near else ""
        message = f"<{node.tag}> has no attribute '{name}'"
        findings.report("JML603", place.at(name), message, hint)
    for name in missing:
        findings.report("JML604", place, f"<{node.tag}>{_name(node)} has no '{name}'")
    for name, value in rule.assumed.items():
        if name not in names:
            message = f"<{node.tag}>{_name(node)} has no '{name}'"
            findings.report("JML621", place, message, f"'{value}' is assumed")


def _name(node: Node) -> str:
    name = node.get("name")
    return f" {show(name)}" if name else ""
