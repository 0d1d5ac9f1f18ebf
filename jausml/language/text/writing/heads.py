"""Heads of blocks: the name of an element, and its documentation as a comment."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from jausml.language.text.tree import Item, Name
from jausml.language.text.writing.literals import is_name
from jausml.language.text.writing.spelling import can_document

if TYPE_CHECKING:
    from jausml.language.metamodel.classes.ecore import EObject

IN_THE_HEAD = frozenset({"name", "documentation"})
"""Features that stand before the block, where a name and a comment can hold them."""

_AnyItem = TypeVar("_AnyItem", bound=Item)


def head_name(obj: EObject) -> Name | None:
    """Returns the name that stands behind the keyword of an element, None where none can."""
    name = getattr(obj, "name", None)
    return Name(name) if name is not None and is_name(name) else None


def is_comment(text: str | None) -> bool:
    """Tells whether a documentation comment says exactly a text, and shows all of it."""
    return text is not None and text.replace("\n", "").isprintable() and can_document(text)


def needs_feature(obj: EObject, feature: str) -> bool:
    """Tells whether a name or documentation is one that only a feature can hold."""
    if feature == "name":
        return not is_name(getattr(obj, "name", None))
    return feature == "documentation" and not is_comment(getattr(obj, "documentation", None))


def documented(item: _AnyItem, obj: EObject) -> _AnyItem:
    """Returns an item with the documentation of its element, where a comment can hold it."""
    text = getattr(obj, "documentation", None)
    if text is not None and is_comment(text):
        item.documentation = text
    return item
