"""References as an XMI file writes them: words of an attribute, or child elements."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.language.model.reading.classes import is_xmi

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.authoring.editing.forest import Thing
    from jausml.authoring.editing.xmi.names import Names
    from jausml.authoring.editing.xmi.source import Attribute, Source
    from jausml.language.model.refs import Ref
    from jausml.language.model.xmi.parsing import Node

_WORD = re.compile(r"\S+")
_PATH = re.compile(r"/(?:[0-9]+)?(?:/@[^/.@\[\]?]+(?:\.[0-9]+)?)*")


@dataclass(frozen=True, slots=True)
class Item:
    """One reference as it is written.

    Attributes:
        target: What it means, None when it leads nowhere.
        start: Offset of the fragment in characters.
        text: All of it, for words of an attribute: class and file included.
        node: The child element, None for a word of an attribute.
    """

    target: Thing | Ref | None
    fragment: str
    start: int
    end: int
    text: str = ""
    node: Node | None = None

    @property
    def is_path(self) -> bool:
        """Whether it is a path by features, as EMF writes it."""
        return _PATH.fullmatch(self.fragment) is not None

    @property
    def is_odd(self) -> bool:
        """Whether it is neither such a path nor an id."""
        return "/" in self.fragment and not self.is_path


def items(node: Node, feature: str, source: Source, names: Names) -> list[Item]:
    """Returns the references of a feature, in order."""
    found: list[Item] = []
    if node.get(feature) is not None:
        attribute = source.element(node).attribute(feature)
        if attribute is not None:
            found += _words(attribute, source, names)
    for child in node.children:
        if child.tag == feature:
            found += _of_element(child, source, names)
    return found


def is_odd(node: Node, feature: str) -> bool:
    """Tells whether a reference may be written otherwise than by a path or an id."""
    if "[" in (node.get(feature) or "") or "//" in (node.get(feature) or "").replace("//@", ""):
        return True
    hrefs = (each.get("href") for each in node.children if each.tag == feature)
    return any(each is not None and _is_odd_href(each) for each in hrefs)


def _is_odd_href(href: str) -> bool:
    fragment = href.partition("#")[2]
    return fragment.startswith("/") and _PATH.fullmatch(fragment) is None


def _words(attribute: Attribute, source: Source, names: Names) -> Iterator[Item]:
    written = source.text[attribute.value : attribute.end]
    kind = None
    for match in _WORD.finditer(written):
        word = match.group()
        uri, hash_sign, fragment = word.partition("#")
        if not hash_sign and ":" in word and "/" not in word:
            kind = match  # the class of the reference that follows
            continue
        if not hash_sign:
            uri, fragment = "", word
        end = attribute.value + match.end()
        text = written[kind.start() if kind is not None else match.start() : match.end()]
        yield Item(names.target(uri, fragment), fragment, end - len(fragment), end, text)
        kind = None


def _of_element(child: Node, source: Source, names: Names) -> Iterator[Item]:
    for attribute in source.element(child).attributes:
        prefix, _, local = attribute.name.rpartition(":")
        written = source.text[attribute.value : attribute.end]
        stripped = written.strip()
        if attribute.name == "href":
            uri, _, fragment = stripped.partition("#")
        elif local == "idref" and is_xmi(child.prefixes.get(prefix, "")):
            uri, fragment = "", stripped
        else:
            continue
        end = attribute.value + len(written.rstrip())
        yield Item(names.target(uri, fragment), fragment, end - len(fragment), end, node=child)
        return
