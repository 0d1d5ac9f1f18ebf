"""Builder of elements from light nodes: classes, containment, ids, values and references.

Values are converted and set. References are only noted (`Reference`), since what they name may not
be read yet.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, cast

from jausml.language.metamodel import (
    ClassTable,
    DataTypeTable,
    FeatureKind,
    FeatureTable,
    Metamodels,
)
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.metamodel.filling import add_values, holds, link, new_object, set_value
from jausml.language.model.diagnostics import ReadFault, Related
from jausml.language.model.documents import Document
from jausml.language.model.model import Model
from jausml.language.model.notation import BY_NAME
from jausml.language.model.reading.classes import ClassFinder, is_xmi, target_class
from jausml.language.model.reading.problems import NodePlace, ReadingProblems, XmlAttribute
from jausml.language.model.values import convert, nearest, show, suggest_or_list
from jausml.language.model.xmi.parsing import Node
from jausml.language.model.xmi.printing import XSI

_TRUE = ("true", "1")


@dataclass(slots=True)
class Reference:
    """A reference that is written in a document.

    Attributes:
        uri: URI of the document referred to, without fragment; empty for this document.
        name: The name, where the reference is one by name.
        direct: The contained element itself, which waits for its place among others.
    """

    place: NodePlace
    owner: EObject
    feature: FeatureTable
    uri: str = ""
    fragment: str = ""
    name: str = ""
    direct: Any = None


@dataclass(slots=True)
class Mention:
    """A document that one refers to which was read before."""

    place: NodePlace
    uri: str
    name: str = ""


class ElementBuilder:
    """Builds the elements of one document."""

    def __init__(
        self,
        metamodels: Metamodels,
        model: Model,
        problems: ReadingProblems,
        references: list[Reference | Mention],
        document: Document,
    ) -> None:
        self._packages = metamodels.packages
        self._model = model
        self._problems = problems
        self._references = references
        self._document = document
        self._classes = ClassFinder(metamodels, problems, document)

    def build(self, root: Node) -> None:
        """Builds the elements from the XML root element."""
        self._classes.check_schema_location(root)
        self._classes.check_prefixes(root)
        document = self._document
        if is_xmi(root.namespace) and root.tag == "XMI":
            document.root_nodes = list(root.children)
            if not root.children:
                self._report("JML011", root, "the document has no model element")
        else:
            document.root_nodes = [root]
        self.build_roots(document.root_nodes)

    def build_roots(self, nodes: Sequence[Node]) -> None:
        """Builds the elements of root nodes of the document."""
        for node in nodes:
            table = self._classes.of_root(node)
            if table is not None:
                self._element(node, table)

    def _element(self, node: Node, table: ClassTable) -> None:
        node.obj = new_object(table)
        self._model.adopt(self._document, node)
        # What attributes gave counts for child elements too: a feature may be written in both ways.
        feature_names: set[str] = set()
        attributes = node.attributes
        features = table.features
        for index in range(0, len(attributes), 2):
            name = attributes[index]
            feature = features.get(name)
            if feature is None:
                self._other_attribute(node, table, name, attributes[index + 1])
            elif not feature.settable:
                self._refuse(node, feature, NodePlace(self._document, node, ("", name)))
            else:
                feature_names.add(name)
                self._assign_attribute(node, feature, attributes[index + 1])
        if node.children or node.text:
            self._children(node, table, feature_names)
        # Last, when the value of the id is known, whatever the order of the attributes.
        if table.id_feature is not None and table.id_feature.name in feature_names:
            identifier = getattr(node.obj, table.id_feature.name)
            if identifier is not None:
                self._identify(node, str(identifier), None)

    def _other_attribute(self, node: Node, table: ClassTable, name: str, value: str) -> None:
        """Handles an XML attribute that is no feature."""
        namespace, _, local = name.rpartition(" ")
        if namespace == XSI:
            return
        if is_xmi(namespace):
            if local in ("id", "uuid"):
                self._identify(node, value, (namespace, local))
        else:
            self._unknown_feature(node, table, node, local, (namespace, local))

    def _unknown_feature(
        self,
        owner: Node,
        table: ClassTable,
        node: Node,
        name: str,
        attribute: XmlAttribute | None = None,
    ) -> None:
        near = nearest(name, table.features)
        if near:
            # A misspelt feature is one error, not a missing feature as well.
            self._problems.mark_unread(owner.obj, near)
        hint = suggest_or_list(name, table.features)
        self._report("JML103", node, f"unknown feature '{name}' of {table.name}", hint, attribute)

    def _identify(self, node: Node, identifier: str, attribute: XmlAttribute | None) -> None:
        self._model.name_by_id(node.obj, identifier)
        holder = self._document.ids.setdefault(identifier, node)
        if holder is not node:
            first = Related(self._document.location(holder), "the first element of this id")
            place = NodePlace(self._document, node, attribute)
            message = f"duplicate id {show(identifier)}"
            self._problems.report("JML201", place, message, related=(first,))

    def _children(self, node: Node, table: ClassTable, feature_names: set[str]) -> None:
        if node.text and not node.text.isspace():
            message = f"text {show(node.text.strip())} has no meaning in {table.name}"
            hint = "put documentation into an attribute; Eclipse drops this text"
            self._report("JML012", node, message, hint)
        waiting: set[str] = set()
        for child in node.children:
            if child.prefixes is not node.prefixes:
                self._classes.check_prefixes(child)
            feature = table.features.get(child.tag)
            if feature is None or (child.namespace and child.namespace not in self._packages):
                self._unknown_feature(node, table, child, child.tag)
            elif not feature.settable:
                self._refuse(node, feature, NodePlace(self._document, child))
            elif feature.many or feature.name not in feature_names:
                feature_names.add(feature.name)
                self._child(node, child, feature, waiting)
            else:
                message = f"second value of the single-valued feature '{feature.name}'"
                place = NodePlace(self._document, child)
                self._lose(node.obj, feature, "JML111", place, f"{message} of {table.name}")

    def _child(self, node: Node, child: Node, feature: FeatureTable, waiting: set[str]) -> None:
        if feature.kind is FeatureKind.ATTRIBUTE:
            self._assign_value(node, child, feature)
        elif feature.kind is FeatureKind.CONTAINMENT:
            self._contained(node, child, feature, waiting)
        else:
            self._assign_reference(node, child, feature)

    def _contained(self, node: Node, child: Node, feature: FeatureTable, waiting: set[str]) -> None:
        href = child.get("href")
        # Text notations need no class beside an href: the element referred to has its own.
        if href is not None and not self._document.is_xml:
            waiting.add(feature.name)
            self._href(node, child, feature, href)
            return
        table = self._classes.of_feature(child, feature, node)
        if table is None:
            self._problems.mark_unread(node.obj, feature.name)
            return
        # A class may have a feature of this name, which is then meant.
        if href is not None and "href" not in table.features:
            waiting.add(feature.name)
            self._href(node, child, feature, href)
            return
        self._element(child, table)
        if feature.name in waiting:
            # Its place is behind an element of another document, which is not there yet.
            place = NodePlace(self._document, child)
            self._references.append(Reference(place, node.obj, feature, direct=child.obj))
        else:
            link(node.obj, feature, child.obj)

    def _refuse(self, owner: Node, feature: FeatureTable, place: NodePlace) -> None:
        message = f"feature '{feature.name}' of {_class(owner)} cannot be set"
        hint = "remove it: its value follows from the rest of the model"
        self._lose(owner.obj, feature, "JML112", place, message, hint)

    def _assign_attribute(self, node: Node, feature: FeatureTable, text: str) -> None:
        """Takes the value of an XML attribute."""
        place = NodePlace(self._document, node, ("", feature.name))
        if feature.kind is FeatureKind.CONTAINMENT:
            message = f"feature '{feature.name}' of {_class(node)} owns its elements"
            self._lose(node.obj, feature, "JML114", place, message, "write them as child elements")
        elif feature.kind is not FeatureKind.ATTRIBUTE:
            self._note_all(place, node.obj, feature, text)
        elif feature.many:
            self._set_all(place, node.obj, feature, text.split())
        else:
            self._set(place, node.obj, feature, text)

    def _assign_value(self, node: Node, child: Node, feature: FeatureTable) -> None:
        """Takes the text of a child element as the value of an attribute."""
        if _is_nil(child):
            # As in EMF, a number or enumeration cannot be null: it keeps its default.
            if not feature.many and cast("DataTypeTable", feature.data_type).nullable:
                set_value(node.obj, feature, None)
        elif child.children:
            inner = NodePlace(self._document, child.children[0])
            message = f"attribute '{feature.name}' of {_class(node)} has a value, no elements"
            self._lose(node.obj, feature, "JML103", inner, message)
        elif feature.many:
            # Space in the text of an element is its value, so it is not split as attributes are.
            self._set_all(NodePlace(self._document, child), node.obj, feature, [child.text])
        else:
            self._set(NodePlace(self._document, child), node.obj, feature, child.text)

    def _assign_reference(self, node: Node, child: Node, feature: FeatureTable) -> None:
        """Takes a child element of a reference: `href`, `xmi:idref` or xsi:nil."""
        href = child.get("href")
        identifier = _idref(child)
        name = child.get(BY_NAME)
        if name is not None:
            place = NodePlace(self._document, child)
            self._references.append(Reference(place, node.obj, feature, name=name))
        elif href is not None and not self._document.is_xml:
            self._href(node, child, feature, href)
        # EMF makes a placeholder before it opens the file, so the class must be concrete.
        elif href is not None:
            if self._classes.of_feature(child, feature, node) is None:
                self._problems.mark_unread(node.obj, feature.name)
            else:
                self._href(node, child, feature, href)
        elif identifier is not None:
            attribute, value = identifier
            place = NodePlace(self._document, child, attribute)
            self._references.append(Reference(place, node.obj, feature, "", value.strip()))
        elif not _is_nil(child):
            message = f"feature '{feature.name}' of {_class(node)} refers to elements, it owns none"
            hint = f'write {feature.name}="fragment" or <{feature.name} href="file#fragment"/>'
            place = NodePlace(self._document, child)
            self._lose(node.obj, feature, "JML115", place, message, hint)

    def _href(self, node: Node, child: Node, feature: FeatureTable, href: str) -> None:
        """Notes the href of a child element."""
        uri, _, fragment = href.strip().partition("#")
        place = NodePlace(self._document, child, ("", "href"))
        self._references.append(Reference(place, node.obj, feature, uri, fragment))

    def _note_all(self, place: NodePlace, obj: EObject, feature: FeatureTable, text: str) -> None:
        """Notes blank-separated references: `id`, `//@a.0`, `#id` or `prefix:Class file#id`."""
        targets: list[tuple[str, str]] = []
        typed = False
        for token in text.split():
            uri, hash_sign, fragment = token.partition("#")
            if hash_sign:
                # A class before the file serves the placeholder; `typed` says that one was written.
                if uri and not typed and not self._can_stand_in(place, obj, feature):
                    return
                targets.append((uri, fragment))
                typed = False
            # A colon without a slash ends the prefix of a class; paths and URIs have slashes.
            elif ":" in token and "/" not in token:
                typed = True
                if self._classes.of_name(place, token) is None:
                    self._problems.mark_unread(obj, feature.name)
                    return
            else:
                targets.append(("", token))
        if len(targets) > 1 and not feature.many:
            what = f"the single-valued feature '{feature.name}' of {obj.eClass.name}"
            self._lose(obj, feature, "JML111", place, f"{len(targets)} values for {what}")
            return
        for uri, fragment in targets:
            self._references.append(Reference(place, obj, feature, uri, fragment))

    def _can_stand_in(self, place: NodePlace, obj: EObject, feature: FeatureTable) -> bool:
        """EMF makes a placeholder of the feature's class for `file#id` without a class."""
        if not target_class(feature).abstract:
            return True
        message = f"class {feature.type_name} is abstract"
        hint = "write prefix:Class before the file, or a child element with xsi:type and href"
        self._lose(obj, feature, "JML104", place, message, hint)
        return False

    def _set(self, place: NodePlace, obj: EObject, feature: FeatureTable, text: str) -> None:
        value, fault = convert(text, cast("DataTypeTable", feature.data_type))
        if fault is None:
            set_value(obj, feature, value)
        else:
            self._report_value(place, obj, feature, fault)

    def _set_all(
        self, place: NodePlace, obj: EObject, feature: FeatureTable, texts: list[str]
    ) -> None:
        data_type = cast("DataTypeTable", feature.data_type)
        values = []
        for text in texts:
            value, fault = convert(text, data_type)
            if fault is None:
                values.append(value)
            else:
                self._report_value(place, obj, feature, fault)
        if feature.unique:
            self._check_repeated(place, obj, feature, values)
        add_values(obj, feature, values)

    def _report_value(
        self, place: NodePlace, obj: EObject, feature: FeatureTable, fault: ReadFault
    ) -> None:
        what = f"wrong value of '{feature.name}' of {obj.eClass.name}"
        self._lose(obj, feature, fault.rule, place, f"{what}: {fault.message}", fault.hint)

    def _check_repeated(
        self, place: NodePlace, obj: EObject, feature: FeatureTable, values: list[Any]
    ) -> None:
        """Reports a value that the set of a unique feature will hold once only."""
        seen: list[Any] = []
        for value in values:
            if value in seen or holds(obj, feature, value):
                message = f"feature '{feature.name}' of {obj.eClass.name} lists '{value}' twice"
                self._problems.report("JML213", place, message)
            seen.append(value)

    def _lose(
        self,
        obj: EObject,
        feature: FeatureTable,
        rule: str,
        place: NodePlace,
        message: str,
        hint: str = "",
    ) -> None:
        """Reports why a feature of an element is unread."""
        self._problems.mark_unread(obj, feature.name)
        self._problems.report(rule, place, message, hint)

    def _report(
        self,
        rule: str,
        node: Node,
        message: str,
        hint: str = "",
        attribute: XmlAttribute | None = None,
    ) -> None:
        self._problems.report(rule, NodePlace(self._document, node, attribute), message, hint)


def _class(node: Node) -> str:
    return str(node.obj.eClass.name)


def _is_nil(node: Node) -> bool:
    return (node.get(f"{XSI} nil") or "").strip() in _TRUE


def _idref(node: Node) -> tuple[XmlAttribute, str] | None:
    for index in range(0, len(node.attributes), 2):
        namespace, _, local = node.attributes[index].rpartition(" ")
        if local == "idref" and is_xmi(namespace):
            return (namespace, local), node.attributes[index + 1]
    return None
