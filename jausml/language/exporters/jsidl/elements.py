"""Elements of JSIDL, and documents of them."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, TypeAlias
from xml.etree import ElementTree

from jausml.language.importers.jsidl.attributes import NUMERIC_TYPES, folded

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from xml.etree.ElementTree import Element

    from jausml.language.metamodel.classes import jaus

    Documented: TypeAlias = jaus.NamedElement | jaus.Value | jaus.Transition | jaus.Action

NAMESPACE = "urn:jaus:jsidl:1.1"

TYPE_NAMES: Mapping[str, str] = MappingProxyType(
    {ours: theirs for theirs, ours in NUMERIC_TYPES.items()}
)
"""The numeric types of JSIDL by those of the model."""


def element(
    tag: str, children: Iterable[Element] = (), /, **attributes: str | int | float | bool | None
) -> Element:
    """Makes an element; attributes without a value are left out."""
    made = ElementTree.Element(tag)
    for name, value in attributes.items():
        if value is not None:
            made.set(name, _text(value))
    made.extend(children)
    return made


def text_element(tag: str, text: str | None) -> Element:
    """Makes an element that holds a text."""
    made = ElementTree.Element(tag)
    made.text = folded(text) or None
    return made


def explained(made: Element, *explaining: Documented) -> Element:
    """Gives an element an `interpretation`, if what it stands for is documented."""
    texts = (folded(each.documentation) for each in explaining)
    if text := " ".join(filter(None, texts)):
        made.set("interpretation", text)
    return made


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
