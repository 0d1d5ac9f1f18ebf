"""Light nodes to model elements: classes, containment and ids."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.metamodel import ClassTable, FeatureKind, FeatureTable, Metamodels
from jausml.metamodel.filling import link, new_object
from jausml.model.diagnostics import Related
from jausml.model.reading.assigning import Assigner, Reference
from jausml.model.reading.naming import XSI, ClassFinder, is_xmi
from jausml.model.reading.problems import Attribute, Place, Problems
from jausml.model.values import nearest, show

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.model.documents import Document
    from jausml.model.model import Model
    from jausml.model.xmi.parsing import Node


class DocumentBuilder:
    """Builds the elements of one document.

    Args:
        metamodels: The metamodels of the elements.
        model: The model that adopts them.
        problems: Where findings go.
        references: Where the references of the document are added, in document order.
        document: The document.
    """

    def __init__(
        self,
        metamodels: Metamodels,
        model: Model,
        problems: Problems,
        references: list[Reference],
        document: Document,
    ) -> None:
        self._packages = metamodels.packages
        self._model = model
        self._problems = problems
        self._references = references
        self._document = document
        self._classes = ClassFinder(metamodels, problems, document)
        self._assigner = Assigner(document, self._classes, problems, references)

    def build(self, root: Node) -> None:
        """Builds the elements from the XML root element."""
        self._check_schema_location(root)
        self._check_prefixes(root)
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
        given: set[str] = set()
        attributes = node.attributes
        features = table.features
        for index in range(0, len(attributes), 2):
            name = attributes[index]
            feature = features.get(name)
            if feature is None:
                self._other_attribute(node, table, name, attributes[index + 1])
            elif self._accepts(node, table, feature, ("", name), node):
                given.add(name)
                self._assigner.from_attribute(node, feature, attributes[index + 1])
        if node.children or node.text:
            self._children(node, table, given)
        if table.id_feature is not None and table.id_feature.name in given:
            identifier = getattr(node.obj, table.id_feature.name)
            if identifier is not None:
                self._identify(node, str(identifier), None)

    def _other_attribute(self, node: Node, table: ClassTable, name: str, value: str) -> None:
        """Handles an XML attribute that is no feature."""
        namespace, _, local = name.rpartition(" ")
        if is_xmi(namespace):
            if local in ("id", "uuid"):
                self._identify(node, value, (namespace, local))
        elif namespace != XSI:
            self._unknown_feature(node, table, node, local, (namespace, local))

    def _unknown_feature(
        self,
        owner: Node,
        table: ClassTable,
        node: Node,
        name: str,
        attribute: Attribute | None = None,
    ) -> None:
        near = nearest(name, table.features)
        if near:
            # A misspelt feature is one error, not a missing feature as well.
            self._problems.spoil(owner.obj, near)
        hint = f"did you mean '{near}'?" if near else ""
        self._report("JML103", node, f"unknown feature '{name}' of {table.name}", hint, attribute)

    def _identify(self, node: Node, identifier: str, attribute: Attribute | None) -> None:
        self._model.name_by_id(node.obj, identifier)
        holder = self._document.ids.setdefault(identifier, node)
        if holder is not node:
            first = Related(self._document.location(holder), "the first element of this id")
            place = Place(self._document, node, attribute)
            message = f"duplicate id {show(identifier)}"
            self._problems.report("JML201", place, message, related=(first,))

    def _children(self, node: Node, table: ClassTable, given: set[str]) -> None:
        if node.text and not node.text.isspace():
            message = f"text {show(node.text.strip())} has no meaning in {table.name}"
            hint = "put documentation into an attribute; Eclipse drops this text"
            self._report("JML012", node, message, hint)
        waiting: set[str] = set()
        for child in node.children:
            if child.prefixes is not node.prefixes:
                self._check_prefixes(child)
            feature = table.features.get(child.tag)
            if feature is None or (child.namespace and child.namespace not in self._packages):
                self._unknown_feature(node, table, child, child.tag)
            elif self._accepts(child, table, feature, None, node):
                if feature.many or feature.name not in given:
                    given.add(feature.name)
                    self._child(node, child, feature, waiting)
                else:
                    message = f"second value of the single-valued feature '{feature.name}'"
                    self._report("JML111", child, f"{message} of {table.name}")

    def _child(self, node: Node, child: Node, feature: FeatureTable, waiting: set[str]) -> None:
        if feature.kind is FeatureKind.ATTRIBUTE:
            self._assigner.from_value_element(node, child, feature)
        elif feature.kind is FeatureKind.CONTAINMENT:
            self._contained(node, child, feature, waiting)
        else:
            self._assigner.from_reference_element(node, child, feature)

    def _contained(self, node: Node, child: Node, feature: FeatureTable, waiting: set[str]) -> None:
        href = child.get("href")
        if href is not None and not self._document.is_xml:
            waiting.add(feature.name)
            self._assigner.href(node, child, feature, href)
            return
        table = self._classes.of_feature(child, feature, str(node.obj.eClass.name))
        if table is None:
            self._problems.spoil(node.obj, feature.name)
            return
        if href is not None and "href" not in table.features:
            waiting.add(feature.name)
            self._assigner.href(node, child, feature, href)
            return
        self._element(child, table)
        if feature.name in waiting:
            # Its place is behind an element of another document, which is not there yet.
            place = Place(self._document, child)
            self._references.append(Reference(place, node.obj, feature, direct=child.obj))
        else:
            link(node.obj, feature, child.obj)

    def _accepts(
        self,
        node: Node,
        table: ClassTable,
        feature: FeatureTable,
        attribute: Attribute | None,
        owner: Node,
    ) -> bool:
        if not feature.settable:
            self._problems.spoil(owner.obj, feature.name)
            message = f"feature '{feature.name}' of {table.name} cannot be set"
            hint = "remove it: its value follows from the rest of the model"
            self._report("JML112", node, message, hint, attribute)
        return feature.settable

    def _check_schema_location(self, root: Node) -> None:
        words = (root.get(f"{XSI} schemaLocation") or "").split()
        for namespace, place in zip(words[::2], words[1::2], strict=False):
            package = self._packages.get(namespace)
            file_name = place.partition("#")[0].rpartition("/")[2]
            if package is not None and file_name != package.file_name:
                message = f"schemaLocation names {show(place)} for {namespace}"
                hint = f"jausml uses its own {package.file_name}"
                self._report("JML010", root, message, hint, (XSI, "schemaLocation"))

    def _check_prefixes(self, node: Node) -> None:
        """EMF knows xsi and xmi by these very prefixes."""
        for prefix, belongs in (("xsi", XSI.__eq__), ("xmi", is_xmi)):
            other = [name for name, uri in node.prefixes.items() if belongs(uri)]
            if other and prefix not in other:
                message = f"Eclipse does not take prefix '{other[0]}' for '{prefix}'"
                self._report("JML013", node, message, f"rename '{other[0]}' to '{prefix}'")

    def _report(
        self,
        rule: str,
        node: Node,
        message: str,
        hint: str = "",
        attribute: Attribute | None = None,
    ) -> None:
        self._problems.report(rule, Place(self._document, node, attribute), message, hint)
