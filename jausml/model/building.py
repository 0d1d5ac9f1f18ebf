"""Light nodes to model elements: classes, attributes and containment.

References are only noted here (`Reference`); they are resolved when all documents are read.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

from jausml.metamodel import ClassTable, DataTypeTable, FeatureKind, FeatureTable, Metamodels
from jausml.metamodel.filling import link, new_object, set_value, set_values
from jausml.model.diagnostics import Related
from jausml.model.naming import XML, XSI, ClassFinder, concrete_names, is_xmi
from jausml.model.values import convert, show, suggest

if TYPE_CHECKING:
    from jausml.model.documents import Document
    from jausml.model.model import Model
    from jausml.model.parsing import Node
    from jausml.model.problems import Attribute, Problems

_NIL = ("true", "1")


@dataclass(slots=True)
class Reference:
    """A reference that is written in a document.

    Attributes:
        document: The document.
        node: The XML element where it is written.
        attribute: The XML attribute, None when it is an element of its own.
        owner: The element that refers.
        feature: The reference.
        uri: URI of the document referred to, without fragment; empty for this document.
        fragment: The fragment or id.
        direct: The contained element itself, which waits for its place among others.
    """

    document: Document
    node: Node
    attribute: Attribute | None
    owner: Any
    feature: FeatureTable
    uri: str = ""
    fragment: str = ""
    direct: Any = None


class Builder:
    """Builds the elements of documents.

    Attributes:
        references: The references of all documents built so far, in document order.
    """

    def __init__(self, metamodels: Metamodels, model: Model, problems: Problems) -> None:
        self._metamodels = metamodels
        self._model = model
        self._problems = problems
        self._classes = ClassFinder(metamodels, problems)
        self.references: list[Reference] = []

    def build(self, document: Document, root: Node) -> None:
        """Builds the elements of a document from its XML root element."""
        self._check_schema_location(document, root)
        if is_xmi(root.namespace) and root.tag == "XMI":
            document.root_nodes = list(root.children)
            if not root.children:
                message = "the document has no model element"
                self._problems.at_node("JML011", document, root, message)
        else:
            document.root_nodes = [root]
        for node in document.root_nodes:
            table = self._typed(document, node) or (
                None if self._type_of(node) else self._classes.of_root(document, node)
            )
            if table is not None and self._instantiable(document, node, table):
                self._element(document, node, table)

    def _element(self, document: Document, node: Node, table: ClassTable) -> None:
        obj = node.obj = new_object(table)
        self._model.adopt(document, node)
        given: set[str] = set()
        attributes = node.attributes
        features = table.features
        for index in range(0, len(attributes), 2):
            name = attributes[index]
            feature = features.get(name)
            if feature is None:
                self._other_attribute(document, node, table, name, attributes[index + 1])
            elif self._accepts(document, node, table, feature, ("", name)):
                given.add(name)
                self._from_attribute(document, node, feature, attributes[index + 1])
        self._children(document, node, table, given)
        if table.id_feature is not None and table.id_feature.name in given:
            self._identify(document, node, str(getattr(obj, table.id_feature.name)), ("", ""))

    # -- XML attributes --------------------------------------------------------------------------

    def _from_attribute(
        self, document: Document, node: Node, feature: FeatureTable, text: str
    ) -> None:
        attribute = ("", feature.name)
        if feature.kind is FeatureKind.ATTRIBUTE:
            texts = text.split() if feature.many else [text]
            self._set(document, node, node.obj, feature, texts, attribute)
        elif feature.kind is FeatureKind.CONTAINMENT:
            self._report(
                "JML114",
                document,
                node,
                f"feature '{feature.name}' of {_class(node)} owns its elements",
                "write them as child elements",
                feature=feature,
                attribute=attribute,
            )
        else:
            self._tokens(document, node, node.obj, feature, text, attribute)

    def _other_attribute(
        self, document: Document, node: Node, table: ClassTable, name: str, value: str
    ) -> None:
        """Handles an XML attribute that is no feature."""
        namespace, _, local = name.rpartition(" ")
        if is_xmi(namespace):
            if local in ("id", "uuid"):
                self._identify(document, node, value, (namespace, local))
        elif namespace not in (XSI, XML):
            self._report(
                "JML103",
                document,
                node,
                f"unknown feature '{local}' of {table.name}",
                suggest(local, list(table.features)),
                attribute=(namespace, local),
            )

    def _identify(
        self, document: Document, node: Node, identifier: str, attribute: Attribute
    ) -> None:
        holder = document.ids.setdefault(identifier, node)
        self._model.name_by_id(node.obj, identifier)
        if holder is not node:
            first = Related(document.location(holder), "the first element of this id")
            self._report(
                "JML201",
                document,
                node,
                f"duplicate id {show(identifier)}",
                attribute=attribute if attribute[1] else None,
                related=(first,),
            )

    # -- child elements --------------------------------------------------------------------------

    def _children(self, document: Document, node: Node, table: ClassTable, given: set[str]) -> None:
        if node.text and not node.text.isspace():
            message = f"text {show(node.text.strip())} has no meaning in {table.name}"
            hint = "put documentation into an attribute; Eclipse drops this text"
            self._problems.at_node("JML012", document, node, message, hint)
        waiting: set[str] = set()
        for child in node.children:
            feature = table.features.get(child.tag)
            if feature is None or not self._is_feature_tag(child):
                self._report(
                    "JML103",
                    document,
                    child,
                    f"unknown feature '{child.tag}' of {table.name}",
                    suggest(child.tag, list(table.features)),
                )
            elif self._accepts(document, child, table, feature, None, owner=node):
                if not feature.many and feature.name in given:
                    message = f"second value of the single-valued feature '{feature.name}'"
                    self._report("JML111", document, child, f"{message} of {table.name}")
                    continue
                given.add(feature.name)
                self._child(document, node, child, feature, waiting)

    def _is_feature_tag(self, child: Node) -> bool:
        return not child.namespace or child.namespace in self._metamodels.packages

    def _child(
        self,
        document: Document,
        node: Node,
        child: Node,
        feature: FeatureTable,
        waiting: set[str],
    ) -> None:
        if feature.kind is FeatureKind.ATTRIBUTE:
            self._attribute_element(document, node, child, feature)
        elif feature.kind is FeatureKind.CONTAINMENT:
            self._contained(document, node, child, feature, waiting)
        else:
            self._reference_element(document, node, child, feature)

    def _attribute_element(
        self, document: Document, node: Node, child: Node, feature: FeatureTable
    ) -> None:
        if (child.get(f"{XSI} nil") or "").strip() in _NIL:
            if not feature.many:
                set_value(node.obj, feature, None)
            return
        for inner in child.children:
            message = f"attribute '{feature.name}' of {_class(node)} has a value, no elements"
            self._report("JML103", document, inner, message)
        if child.children:
            self._problems.spoil(node.obj, feature.name)
        else:
            self._set(document, child, node.obj, feature, [child.text], None)

    def _contained(
        self,
        document: Document,
        node: Node,
        child: Node,
        feature: FeatureTable,
        waiting: set[str],
    ) -> None:
        table = _target(feature)
        if self._type_of(child):
            named = self._typed(document, child, feature, node.obj)
            if named is None:
                self._problems.spoil(node.obj, feature.name)
                return
            table = named
        if not self._instantiable(document, child, table):
            self._problems.spoil(node.obj, feature.name)
            return
        href = child.get("href")
        if href is not None and "href" not in table.features:
            waiting.add(feature.name)
            self._href(document, node.obj, child, feature, href)
            return
        self._element(document, child, table)
        if feature.name in waiting:
            # Its place is behind an element of another document, which is not there yet.
            reference = Reference(document, child, None, node.obj, feature, direct=child.obj)
            self.references.append(reference)
        else:
            link(node.obj, feature, child.obj)

    def _reference_element(
        self, document: Document, node: Node, child: Node, feature: FeatureTable
    ) -> None:
        href = child.get("href")
        local = next(
            (
                child.attributes[index + 1]
                for index in range(0, len(child.attributes), 2)
                if child.attributes[index].endswith(" idref")
            ),
            child.text.strip(),
        )
        if href is not None:
            table = feature.target
            if self._type_of(child):
                table = self._typed(document, child, feature, node.obj)
            if table is None or not self._instantiable(document, child, table):
                self._problems.spoil(node.obj, feature.name)
                return
            self._href(document, node.obj, child, feature, href)
        elif local:
            self._tokens(document, child, node.obj, feature, local, None)
        elif (child.get(f"{XSI} nil") or "").strip() not in _NIL:
            self._report(
                "JML115",
                document,
                child,
                f"feature '{feature.name}' of {_class(node)} refers to elements, it owns none",
                'write an XML attribute with a fragment, or href="file#fragment"',
                feature=feature,
                owner=node,
            )

    # -- common ----------------------------------------------------------------------------------

    def _set(
        self,
        document: Document,
        node: Node,
        obj: Any,
        feature: FeatureTable,
        texts: list[str],
        attribute: Attribute | None,
    ) -> None:
        """Converts and sets values of an attribute."""
        data_type = cast("DataTypeTable", feature.data_type)
        values = []
        for text in texts:
            value, fault = convert(text, data_type)
            if fault is None:
                values.append(value)
                continue
            where = f"value of '{feature.name}' of {obj.eClass.name}"
            message = f"wrong {where}: {fault.reason}"
            self._problems.spoil(obj, feature.name)
            self._problems.at_node(
                fault.rule, document, node, message, fault.hint, attribute=attribute
            )
        if feature.many:
            set_values(obj, feature, values)
        elif values:
            set_value(obj, feature, values[0])

    def _tokens(
        self,
        document: Document,
        node: Node,
        obj: Any,
        feature: FeatureTable,
        text: str,
        attribute: Attribute | None,
    ) -> None:
        """Notes blank-separated references: `id`, `//@a.0`, `#id` or `prefix:Class file#id`."""
        found = []
        for token in text.split():
            uri, hash_sign, fragment = token.partition("#")
            if hash_sign:
                found.append((uri, fragment))
            elif ":" in token and not token.startswith("/") and token not in document.ids:
                self._classes.of_type(document, node, token, attribute or ("", feature.name))
            else:
                found.append(("", token))
        if len(found) > 1 and not feature.many:
            self._report(
                "JML111",
                document,
                node,
                f"{len(found)} values for the single-valued feature '{feature.name}'"
                f" of {obj.eClass.name}",
                attribute=attribute,
            )
            self._problems.spoil(obj, feature.name)
            return
        for uri, fragment in found:
            reference = Reference(document, node, attribute, obj, feature, uri, fragment)
            self.references.append(reference)

    def _href(
        self, document: Document, owner: Any, node: Node, feature: FeatureTable, href: str
    ) -> None:
        uri, _, fragment = href.strip().partition("#")
        self.references.append(
            Reference(document, node, ("", "href"), owner, feature, uri, fragment)
        )

    def _accepts(
        self,
        document: Document,
        node: Node,
        table: ClassTable,
        feature: FeatureTable,
        attribute: Attribute | None,
        owner: Node | None = None,
    ) -> bool:
        if feature.settable:
            return True
        self._report(
            "JML112",
            document,
            node,
            f"feature '{feature.name}' of {table.name} cannot be set",
            "remove it: its value follows from the rest of the model",
            feature=feature,
            attribute=attribute,
            owner=owner,
        )
        return False

    def _type_of(self, node: Node) -> str | None:
        attributes = node.attributes
        for index in range(0, len(attributes), 2):
            if attributes[index].endswith(" type"):
                namespace = attributes[index].rpartition(" ")[0]
                if namespace == XSI or is_xmi(namespace):
                    return attributes[index]
        return None

    def _typed(
        self,
        document: Document,
        node: Node,
        feature: FeatureTable | None = None,
        owner: Any = None,
    ) -> ClassTable | None:
        """Returns the class that xsi:type names, if it fits the feature."""
        name = self._type_of(node)
        if name is None:
            return None
        namespace, _, local = name.rpartition(" ")
        attribute = (namespace, local)
        table = self._classes.of_type(document, node, node.get(name) or "", attribute)
        if table is None or feature is None or table in _target(feature).subtypes:
            return table
        self._problems.at_node(
            "JML113",
            document,
            node,
            f"{table.qualified_name} is no {feature.type_name}, which feature '{feature.name}'"
            f" of {owner.eClass.name} takes",
            f"one of {concrete_names(_target(feature))}",
            attribute=attribute,
        )
        return None

    def _instantiable(self, document: Document, node: Node, table: ClassTable) -> bool:
        if not table.abstract:
            return True
        name = self._type_of(node)
        namespace, _, local = (name or "").rpartition(" ")
        self._problems.at_node(
            "JML104",
            document,
            node,
            f"class {table.qualified_name} is abstract",
            f"name a concrete class by xsi:type: {concrete_names(table)}",
            attribute=(namespace, local) if name else None,
        )
        return False

    def _check_schema_location(self, document: Document, root: Node) -> None:
        words = (root.get(f"{XSI} schemaLocation") or "").split()
        for namespace, place in zip(words[::2], words[1::2], strict=False):
            package = self._metamodels.packages.get(namespace)
            file_name = place.partition("#")[0].rpartition("/")[2]
            if package is not None and file_name != package.file_name:
                self._problems.at_node(
                    "JML010",
                    document,
                    root,
                    f"schemaLocation names {show(place)} for {namespace}",
                    f"jausml uses its own {package.file_name}",
                    attribute=(XSI, "schemaLocation"),
                )

    def _report(
        self,
        rule: str,
        document: Document,
        node: Node,
        message: str,
        hint: str = "",
        *,
        feature: FeatureTable | None = None,
        owner: Node | None = None,
        attribute: Attribute | None = None,
        related: tuple[Related, ...] = (),
    ) -> None:
        if feature is not None:
            self._problems.spoil((owner or node).obj, feature.name)
        self._problems.at_node(
            rule, document, node, message, hint, attribute=attribute, related=related
        )


def _class(node: Node) -> str:
    return str(node.obj.eClass.name)


def _target(feature: FeatureTable) -> ClassTable:
    return cast("ClassTable", feature.target)
