"""XML of JSIDL: elements, and the documents of them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from jausml.language.importers.jsidl.vocabulary import folded
from jausml.language.metamodel.classes import jaus

Documented: TypeAlias = "jaus.NamedElement | jaus.Value | jaus.Transition | jaus.Action"

NAMESPACE = "urn:jaus:jsidl:1.1"


def element(
    tag: str, children: Iterable[Element] = (), /, **attributes: str | int | float | bool | None
) -> Element:
    """Makes an element; attributes without a value are left out."""
    node = ElementTree.Element(tag)
    for name, value in attributes.items():
        if value is not None:
            node.set(name, _text(value))
    node.extend(children)
    return node


def text_element(tag: str, text: str | None) -> Element:
    """Makes an element that holds a text."""
    node = ElementTree.Element(tag)
    node.text = folded(text) or None
    return node


def explained(node: Element, *explaining: Documented) -> Element:
    """Sets the `interpretation` of an element by the documentation of its sources."""
    texts = (folded(explanation.documentation) for explanation in explaining)
    if text := " ".join(filter(None, texts)):
        node.set("interpretation", text)
    return node


def document(root: Element) -> bytes:
    """Returns a root element as the bytes of a document."""
    root.set("xmlns", NAMESPACE)
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'.encode()


def _text(value: str | float) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float) and value.is_integer() and abs(value) < 2**53:
        return str(int(value))
    return str(value)
