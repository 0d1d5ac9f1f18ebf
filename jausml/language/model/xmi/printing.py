"""Layout of XMI documents, as EMF has it: attributes, child elements, namespaces."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Generic, TypeVar

from jausml.language.metamodel import ClassTable, FeatureKind, FeatureTable, Metamodels

_ESCAPES = {"&": "&amp;", "<": "&lt;", '"': "&quot;", "\n": "&#xA;", "\r": "&#xD;", "\t": "&#x9;"}
_ESCAPED = re.compile('[&<"\n\r\t]')
_TEXT_ESCAPES = {"&": "&amp;", "<": "&lt;", "\r": "&#xD;", "]]>": "]]&gt;"}
_TEXT_ESCAPED = re.compile("[&<\r]|]]>")
_NOT_XML = re.compile("[\0-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")
_XMI = ' xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"'
XSI = "http://www.w3.org/2001/XMLSchema-instance"

ElementT = TypeVar("ElementT")


class UnwritableError(ValueError):
    """A model holds what XMI cannot say: a character, or a reference to no document."""


class DocumentPrinter(Generic[ElementT]):
    """Printer of elements as EMF saves them; subclasses have their values and names."""

    def __init__(self, metamodels: Metamodels) -> None:
        self.metamodels = metamodels
        self.prefixes: set[str] = set()
        self.has_types = False

    # What subclasses say

    def table_of(self, element: ElementT) -> ClassTable:
        """Returns the class of an element."""
        raise NotImplementedError

    def identifier_of(self, element: ElementT) -> str | None:
        """Returns the `xmi:id` of an element, None without one."""
        raise NotImplementedError

    def values_of(self, element: ElementT, feature: FeatureTable) -> Sequence[str | None]:
        """Returns the values of an attribute that must be written, None for no value."""
        raise NotImplementedError

    def targets_of(self, element: ElementT, feature: FeatureTable) -> Sequence[ElementT]:
        """Returns the elements that a feature refers to, or owns."""
        raise NotImplementedError

    def fragment_of(self, target: ElementT) -> str | None:
        """Returns how an element of the document is referred to, None for others."""
        raise NotImplementedError

    def href_of(self, target: ElementT) -> str:
        """Returns the URI and fragment of an element."""
        raise NotImplementedError

    def is_apart(self, element: ElementT) -> bool:
        """Tells whether an owned element is the root of another document, which keeps it."""
        raise NotImplementedError

    def namespaces(self) -> Mapping[str, str]:
        """Returns the namespaces of the document by prefix, in order."""
        packages = self.metamodels.packages.values()
        pairs = sorted(
            (package.name, package.ns_uri) for package in packages if package.name in self.prefixes
        )
        return {**({"xsi": XSI} if self.has_types else {}), **dict(pairs)}

    def further_attributes(self) -> str:
        """Returns further attributes of the root, each behind a blank."""
        return ""

    # Layout

    def lines_of_document(self, roots: Sequence[ElementT], *, is_wrapped: bool) -> list[str]:
        """Returns the lines of root elements.

        `is_wrapped`: whether they stand in `xmi:XMI`.
        """
        lines: list[str] = []
        for root in roots:
            tag = self.tag(self.table_of(root))
            # The namespaces are known only when all is written: they replace this mark.
            # No document can hold the character NUL, so no text of the model is mistaken for it.
            mark = "" if is_wrapped else "\0"
            lines += self.lines_of(root, tag, mark, "  " if is_wrapped else "")
        further = self.further_attributes()
        declared = self.namespaces().items()
        head = _XMI + "".join(
            f' xmlns:{prefix}="{attribute_text(uri)}"' for prefix, uri in declared
        )
        head += further
        if is_wrapped:
            end = [*lines, "</xmi:XMI>"] if lines else []
            return [f"<xmi:XMI{head}{'' if lines else '/'}>", *end]
        return [line.replace("\0", head, 1) for line in lines]

    def lines_of(self, element: ElementT, tag: str, head: str, indent: str) -> Iterator[str]:
        """Yields the lines of an element."""
        identifier = self.identifier_of(element)
        if identifier is not None:
            head += f' xmi:id="{attribute_text(identifier)}"'
        inner = []
        for feature in self.table_of(element).features.values():
            text = self.attribute(element, feature)
            if text is None:
                inner.append(feature)
            else:
                head += f' {feature.name}="{attribute_text(text)}"'
        lines = (
            line
            for inner_feature in inner
            for line in self.children(element, inner_feature, indent + "  ")
        )
        # Whether an element is empty is known only with its first child, which may never come.
        first = next(lines, None)
        if first is None:
            yield f"{indent}<{tag}{head}/>"
            return
        yield f"{indent}<{tag}{head}>"
        yield first
        yield from lines
        # The tag may carry its xsi:type, which an end tag has not.
        yield f"{indent}</{tag.partition(' ')[0]}>"

    def attribute(self, element: ElementT, feature: FeatureTable) -> str | None:
        """Returns the XML attribute of a feature, None where it has child elements."""
        if feature.kind is FeatureKind.ATTRIBUTE:
            values = () if feature.many else self.values_of(element, feature)
            return values[0] if values else None
        if feature.kind is not FeatureKind.CROSS_REFERENCE:
            return None
        fragments = [self.fragment_of(target) for target in self.targets_of(element, feature)]
        here = [fragment for fragment in fragments if fragment is not None]
        # EMF writes all targets as attributes or all as elements, never some of each.
        return " ".join(here) if here and len(here) == len(fragments) else None

    def children(self, element: ElementT, feature: FeatureTable, indent: str) -> Iterator[str]:
        """Yields the lines of the child elements of a feature."""
        name = feature.name
        if feature.kind is FeatureKind.ATTRIBUTE:
            for text in self.values_of(element, feature):
                self.has_types |= text is None
                content = ' xsi:nil="true"/>' if text is None else f">{element_text(text)}</{name}>"
                yield f"{indent}<{name}{content}"
            return
        for target in self.targets_of(element, feature):
            if feature.kind is FeatureKind.CONTAINMENT and not self.is_apart(target):
                yield from self.lines_of(target, self.child_tag(target, feature), "", indent)
            else:
                href = attribute_text(self.href_of(target))
                yield f'{indent}<{self.child_tag(target, feature)} href="{href}"/>'

    def tag(self, table: ClassTable) -> str:
        """Returns the qualified name of a class as XML has it."""
        self.prefixes.add(table.package.name)
        return table.qualified_name.replace(".", ":")

    def child_tag(self, element: ElementT, feature: FeatureTable) -> str:
        """Returns the name of a child element, with its class where that is not obvious."""
        table = self.table_of(element)
        if table is feature.target:
            return feature.name
        self.has_types = True
        return f'{feature.name} xsi:type="{self.tag(table)}"'


def attribute_text(text: str) -> str:
    """Returns a text as it stands between the quotation marks of an XML attribute."""
    return _ESCAPED.sub(lambda match: _ESCAPES[match.group()], _checked(text))


def element_text(text: str) -> str:
    """Returns a text as it stands in an XML element."""
    return _TEXT_ESCAPED.sub(lambda match: _TEXT_ESCAPES[match.group()], _checked(text))


def _checked(text: str) -> str:
    wrong = _NOT_XML.search(text)
    if wrong:
        raise UnwritableError(f"XML cannot hold the character {wrong.group()!r}")
    return text
