"""Puts what a document writes into features: values at once, references for later.

Values are converted and set. References are only noted (`Reference`), since what they name may not
be read yet.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

from jausml.metamodel import DataTypeTable, FeatureKind, FeatureTable
from jausml.metamodel.filling import holds, set_value, set_values
from jausml.model.notation import BY_NAME
from jausml.model.reading.naming import XSI, ClassFinder, is_xmi, target_class
from jausml.model.reading.problems import Attribute, Place, Problems
from jausml.model.values import convert

if TYPE_CHECKING:
    from jausml.metamodel.classes.ecore import EObject
    from jausml.model.documents import Document
    from jausml.model.xmi.parsing import Node

_TRUE = ("true", "1")


@dataclass(slots=True)
class Reference:
    """A reference that is written in a document.

    Attributes:
        place: Where.
        owner: The element that refers.
        feature: The reference.
        uri: URI of the document referred to, without fragment; empty for this document.
        fragment: The fragment or id.
        name: The name, where the reference is one by name.
        direct: The contained element itself, which waits for its place among others.
    """

    place: Place
    owner: EObject
    feature: FeatureTable
    uri: str = ""
    fragment: str = ""
    name: str = ""
    direct: Any = None


class Assigner:
    """Fills the features of the elements of one document."""

    def __init__(
        self,
        document: Document,
        classes: ClassFinder,
        problems: Problems,
        references: list[Reference],
    ) -> None:
        self._document = document
        self._classes = classes
        self._problems = problems
        self._references = references

    def from_attribute(self, node: Node, feature: FeatureTable, text: str) -> None:
        """Takes the value of an XML attribute."""
        attribute = ("", feature.name)
        if feature.kind is FeatureKind.ATTRIBUTE:
            texts = text.split() if feature.many else [text]
            self._set(node, attribute, node.obj, feature, texts)
        elif feature.kind is FeatureKind.CONTAINMENT:
            self._problems.spoil(node.obj, feature.name)
            message = f"feature '{feature.name}' of {_class(node)} owns its elements"
            place = Place(self._document, node, attribute)
            self._problems.report("JML114", place, message, "write them as child elements")
        else:
            self._local(Place(self._document, node, attribute), node.obj, feature, text)

    def from_value_element(self, node: Node, child: Node, feature: FeatureTable) -> None:
        """Takes the text of a child element as the value of an attribute."""
        if _is_nil(child):
            # As in EMF, a number or enumeration cannot be null: it keeps its default.
            if not feature.many and cast("DataTypeTable", feature.data_type).nullable:
                set_value(node.obj, feature, None)
        elif child.children:
            self._problems.spoil(node.obj, feature.name)
            inner = Place(self._document, child.children[0])
            message = f"attribute '{feature.name}' of {_class(node)} has a value, no elements"
            self._problems.report("JML103", inner, message)
        else:
            self._set(child, None, node.obj, feature, [child.text])

    def from_reference_element(self, node: Node, child: Node, feature: FeatureTable) -> None:
        """Takes a child element of a reference: `href`, `xmi:idref` or xsi:nil."""
        href = child.get("href")
        identifier = _idref(child)
        name = child.get(BY_NAME)
        if name is not None:
            place = Place(self._document, child)
            self._references.append(Reference(place, node.obj, feature, name=name))
        elif href is not None and not self._document.is_xml:
            self.href(node, child, feature, href)
        elif href is not None:
            if self._classes.of_feature(child, feature, _class(node)) is None:
                self._problems.spoil(node.obj, feature.name)
            else:
                self.href(node, child, feature, href)
        elif identifier is not None:
            attribute, value = identifier
            place = Place(self._document, child, attribute)
            self._note(place, node.obj, feature, "", value.strip())
        elif not _is_nil(child):
            self._problems.spoil(node.obj, feature.name)
            self._problems.report(
                "JML115",
                Place(self._document, child),
                f"feature '{feature.name}' of {_class(node)} refers to elements, it owns none",
                f'write {feature.name}="fragment" or <{feature.name} href="file#fragment"/>',
            )

    def href(self, node: Node, child: Node, feature: FeatureTable, href: str) -> None:
        """Notes the href of a child element."""
        uri, _, fragment = href.strip().partition("#")
        place = Place(self._document, child, ("", "href"))
        self._note(place, node.obj, feature, uri, fragment)

    def _local(self, place: Place, obj: EObject, feature: FeatureTable, text: str) -> None:
        """Notes blank-separated references: `id`, `//@a.0`, `#id` or `prefix:Class file#id`."""
        found: list[tuple[str, str]] = []
        typed = False
        for token in text.split():
            uri, hash_sign, fragment = token.partition("#")
            if hash_sign:
                if uri and not typed and not self._can_stand_in(place, obj, feature):
                    return
                found.append((uri, fragment))
                typed = False
            elif ":" in token and "/" not in token:
                typed = True
                if self._classes.of_name(place, token) is None:
                    self._problems.spoil(obj, feature.name)
                    return
            else:
                found.append(("", token))
        if len(found) > 1 and not feature.many:
            self._problems.spoil(obj, feature.name)
            what = f"the single-valued feature '{feature.name}' of {obj.eClass.name}"
            self._problems.report("JML111", place, f"{len(found)} values for {what}")
            return
        for uri, fragment in found:
            self._note(place, obj, feature, uri, fragment)

    def _can_stand_in(self, place: Place, obj: EObject, feature: FeatureTable) -> bool:
        """EMF makes a placeholder of the feature's class for `file#id` without a class."""
        if not target_class(feature).abstract:
            return True
        self._problems.spoil(obj, feature.name)
        message = f"class {feature.type_name} is abstract"
        hint = "write prefix:Class before the file, or a child element with xsi:type and href"
        self._problems.report("JML104", place, message, hint)
        return False

    def _note(
        self, place: Place, obj: EObject, feature: FeatureTable, uri: str, fragment: str
    ) -> None:
        self._references.append(Reference(place, obj, feature, uri, fragment))

    def _set(
        self,
        node: Node,
        attribute: Attribute | None,
        obj: EObject,
        feature: FeatureTable,
        texts: list[str],
    ) -> None:
        data_type = cast("DataTypeTable", feature.data_type)
        values = []
        for text in texts:
            value, fault = convert(text, data_type)
            if fault is None:
                values.append(value)
            else:
                self._problems.spoil(obj, feature.name)
                place = Place(self._document, node, attribute)
                what = f"wrong value of '{feature.name}' of {obj.eClass.name}"
                self._problems.report(fault.rule, place, f"{what}: {fault.reason}", fault.hint)
        if feature.many:
            if feature.unique:
                self._check_repeated(Place(self._document, node, attribute), obj, feature, values)
            set_values(obj, feature, values)
        elif values:
            set_value(obj, feature, values[0])

    def _check_repeated(
        self, place: Place, obj: EObject, feature: FeatureTable, values: list[Any]
    ) -> None:
        """Reports a value that the set of a unique feature will hold once only."""
        seen: list[Any] = []
        for value in values:
            if value in seen or holds(obj, feature, value):
                message = f"feature '{feature.name}' of {obj.eClass.name} lists '{value}' twice"
                self._problems.report("JML213", place, message)
            seen.append(value)


def _class(node: Node) -> str:
    return str(node.obj.eClass.name)


def _is_nil(node: Node) -> bool:
    return (node.get(f"{XSI} nil") or "").strip() in _TRUE


def _idref(node: Node) -> tuple[Attribute, str] | None:
    for index in range(0, len(node.attributes), 2):
        namespace, _, local = node.attributes[index].rpartition(" ")
        if local == "idref" and is_xmi(namespace):
            return (namespace, local), node.attributes[index + 1]
    return None
