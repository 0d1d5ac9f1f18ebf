"""Splices of the attributes of XML elements."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.model.xmi.writer import attribute_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.editing.splices import Splice
    from jausml.editing.xmi.source import Attribute, Element, Source


def value_splice(source: Source, attribute: Attribute, text: str) -> Splice:
    """Returns the splice that gives an attribute another value; its quotation marks stay."""
    escaped = attribute_text(text)
    if source.text[attribute.end] == "'":
        escaped = escaped.replace("&quot;", '"').replace("'", "&apos;")
    return source.splice(attribute.value, attribute.end, escaped)


def removal(source: Source, attribute: Attribute) -> Splice:
    """Returns the splice that takes an attribute away, with the whitespace before it."""
    return source.splice(attribute.start, attribute.end + 1, "")


def addition(
    source: Source, element: Element, name: str, text: str, order: Sequence[str]
) -> Splice:
    """Returns the splice that gives an element an attribute which it has not.

    Args:
        source: The text.
        element: The element.
        name: The name of the attribute.
        text: Its value.
        order: The names of the features of the element in the order of the metamodel: it goes
            behind those before it, and behind all that is no feature.
    """
    later = set(order[order.index(name) + 1 :])
    before = [each for each in element.attributes if each.name not in later]
    last = before[-1] if before else None
    at = last.end + 1 if last is not None else element.start + 1 + len(element.name)
    # Where each attribute has a line of its own, so has the new one.
    is_apart = last is not None and last is not element.attributes[0] and "\n" in last.before
    gap = last.before.replace("\r\n", "\n") if last is not None and is_apart else " "
    return source.splice(at, at, f'{gap}{name}="{attribute_text(text)}"')
