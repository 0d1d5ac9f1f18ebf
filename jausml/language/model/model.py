"""Models: the elements of some documents, and where each of them stands."""

from __future__ import annotations

import gc
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from hashlib import sha256
from operator import itemgetter
from pathlib import Path
from typing import Any, TypeVar

from ordered_set import OrderedSet

from jausml.language.metamodel import FeatureTable, Metamodels
from jausml.language.metamodel.classes.ecore import EClass, EObject
from jausml.language.metamodel.filling import contents
from jausml.language.model.diagnostics import Location
from jausml.language.model.documents import Document
from jausml.language.model.xmi.parsing import Node

ElementT = TypeVar("ElementT", bound="EObject")
MadeT = TypeVar("MadeT")
ByClass = dict["EClass", list[tuple[int, Any]]]
_Lists = dict["EClass", list[tuple[int, bool, list[tuple[int, Any]]]]]

UNKNOWN_PATH = "<model>"
"""The path of elements that no document holds."""


@dataclass(frozen=True, slots=True)
class Origins:
    """The elements of one document."""

    nodes: dict[EObject, tuple[Document, Node]]
    identifiers: dict[EObject, str]


class Model:
    """The elements of the documents that were read.

    Elements are pyecore objects of the metamodels: `element.name`, `eGet`, `eContainer()` and the
    rest of pyecore's reflection work on them. Their `eResource` is None; this class knows the
    documents.
    """

    def __init__(self, documents: Sequence[Document], metamodels: Metamodels) -> None:
        self.documents = list(documents)
        self.metamodels = metamodels
        self.unread: Mapping[int, set[str]] = {}
        """Features whose values were not all read, by id of the element; "" stands for any."""
        self._origin: dict[EObject, tuple[Document, Node]] = {}
        self._ids: dict[EObject, str] = {}
        self._by_class: _Lists | None = None
        self._products: dict[Any, Any] = {}

    def adopt(self, document: Document, node: Node) -> None:
        """Remembers where an element was read; for the reader."""
        self._by_class = None
        self._products.clear()
        self._origin[node.obj] = (document, node)

    def origins_of(self, document: Document) -> Origins:
        """Returns the elements of a document, for another model that shares them."""
        elements = list(self.elements_of(document))
        nodes = {element: self._origin[element] for element in elements}
        return Origins(
            nodes, {element: self._ids[element] for element in elements if element in self._ids}
        )

    def share(self, origins: Origins) -> None:
        """Remembers the elements of a document that another model has too; for the reader."""
        self._by_class = None
        self._products.clear()
        self._origin.update(origins.nodes)
        self._ids.update(origins.identifiers)

    def node_of(self, obj: EObject) -> Node | None:
        """Returns the light node of which an element was built, None for one that was not read."""
        origin = self._origin.get(obj)
        return None if origin is None else origin[1]

    def join(self, other: Model) -> None:
        """Makes the documents of another model documents of this one, which may refer to them."""
        for document in other.documents:
            self.documents.append(document)
            self.share(other.origins_of(document))

    def name_by_id(self, obj: EObject, identifier: str) -> None:
        """Remembers the id of an element; for the reader."""
        self._ids.setdefault(obj, identifier)

    def identifier(self, obj: EObject) -> str | None:
        """Returns the id of an element, None when it has none."""
        return self._ids.get(obj)

    @property
    def roots(self) -> list[EObject]:
        """The root elements of all documents, in the order of the documents."""
        return [root for document in self.documents for root in document.roots]

    @property
    def root(self) -> EObject | None:
        """The first root element of the first document, None when it has none."""
        roots = self.documents[0].roots if self.documents else []
        return roots[0] if roots else None

    def document_of(self, obj: EObject | None) -> Document | None:
        """Returns the document that holds an element; None for one that was not read."""
        while obj is not None:
            origin = self._origin.get(obj)
            if origin is not None:
                return origin[0]
            obj = obj.eContainer()
        return None

    def is_library(self, obj: EObject) -> bool:
        """Tells whether an element belongs to the shipped library."""
        document = self.document_of(obj)
        return document is not None and document.is_library

    def elements(self, *, library: bool = True) -> Iterator[EObject]:
        """Yields all elements in document order."""
        for document in self.documents:
            if library or not document.is_library:
                yield from self.elements_of(document)

    def elements_of(self, document: Document) -> Iterator[EObject]:
        """Yields the elements of one document, in order."""
        for node in document.root_nodes:
            yield from _built(node)

    def instances(self, kind: type[ElementT], *, library: bool = True) -> list[ElementT]:
        """Returns the elements of a class and of the classes that specialise it.

        Returns:
            The elements in document order. Elements that were added since are not among them.
        """
        wanted = {table.eclass for table in self.metamodels.class_of(kind).subtypes}
        by_class = self._by_class
        if by_class is None:
            by_class = self._by_class = self._lists()  # whole: another thread may ask meanwhile
        lists = [entry for eclass in by_class.keys() & wanted for entry in by_class[eclass]]
        entries = [
            (number, position, obj)
            for number, is_library, instance_list in lists
            if library or not is_library
            for position, obj in instance_list
        ]
        return [obj for _, _, obj in sorted(entries, key=itemgetter(0, 1))]

    def _lists(self) -> _Lists:
        """Returns by class the elements of each document that has some, with its number."""
        lists_by_class: _Lists = {}
        for number, document in enumerate(self.documents):
            for eclass, instance_list in self._classes_of(document).items():
                lists_by_class.setdefault(eclass, []).append(
                    (number, document.is_library, instance_list)
                )
        return lists_by_class

    def _classes_of(self, document: Document) -> ByClass:
        """Returns the elements of a document by class, with their positions."""
        if document.by_class is not None:
            return document.by_class
        elements_by_class: ByClass = {}
        for position, obj in enumerate(self.elements_of(document)):
            elements_by_class.setdefault(obj.eClass, []).append((position, obj))
        if document.is_shared:
            document.by_class = elements_by_class
        return elements_by_class

    def derived(self, make: Callable[[Model], MadeT]) -> MadeT:
        """Returns the result of a function of the model, computed once until something is read."""
        if make not in self._products:
            self._products[make] = make(self)
        result: MadeT = self._products[make]
        return result

    def location(
        self, obj: EObject | None, feature: str | None = None, position: int = 0
    ) -> Location:
        """Returns the location of an element, or of the value of one of its features.

        Args:
            obj: An element. One that was not read is placed where its nearest owner stands.
            feature: Name of a feature; its XML attribute or child element is looked for,
                and the element's own place is the answer when there is neither.
        """
        origin = self._origin_of(obj)
        while origin is None and obj is not None:
            feature = None
            obj = obj.eContainer()
            origin = self._origin_of(obj)
        if origin is None:
            return Location(UNKNOWN_PATH)
        document, node = origin
        if feature is None:
            return document.location(node)
        if node.get(feature) is not None:
            return document.location(node, ("", feature))
        children = document.children(node, feature)
        return document.location(children[min(position, len(children) - 1)] if children else node)

    def _origin_of(self, obj: EObject | None) -> tuple[Document, Node] | None:
        return None if obj is None else self._origin.get(obj)

    def element_path(self, obj: EObject | None) -> str:
        """Returns the path of an element by names, such as `robot/bridge/maps[2]`.

        An element without a name stands there by its feature, with its index (from 0) when the
        feature is multi-valued; a root element without a name by its class.
        """
        steps: list[str] = []
        while obj is not None:
            steps.append(getattr(obj, "name", None) or self._unnamed_step(obj))
            obj = obj.eContainer()
        return "/".join(reversed(steps))

    def fragment(self, obj: EObject) -> str:
        """Returns the XMI fragment of an element within its document.

        It is the element's id when it has one, else the path of features from the root, as EMF
        writes it (`//@services.0/@inputs.1`). Empty for elements that were not read.
        """
        return self._ids.get(obj) or self.path_of(obj)

    def path_of(self, obj: EObject) -> str:
        """Returns the fragment of an element by features, whether it has an id or not."""
        document = self.document_of(obj)
        if document is None:
            return ""
        steps: list[str] = []
        while (position := document.root_position(obj)) is None:
            owner = obj.eContainer()
            if owner is None:
                return ""
            feature = self._containment(obj, owner)
            index = f".{_position(owner, feature, obj)}" if feature.many else ""
            steps.append(f"@{feature.name}{index}")
            obj = owner
        steps.append("/" + (str(position) if len(document.root_nodes) > 1 else ""))
        return "/".join(reversed(steps))

    def _containment(self, obj: EObject, owner: EObject) -> FeatureTable:
        return self.metamodels.class_of(owner).features[obj.eContainmentFeature().name]

    def _unnamed_step(self, obj: EObject) -> str:
        owner = obj.eContainer()
        if owner is None:
            return obj.eClass.name
        feature = self._containment(obj, owner)
        return f"{feature.name}[{_position(owner, feature, obj)}]" if feature.many else feature.name

    def owned(self, obj: EObject) -> list[EObject]:
        """Returns the elements that an element owns, in metamodel order of the features.

        pyecore's own `eContents` yields them in the order of a set, which differs between runs.
        """
        elements: list[EObject] = []
        for table in self.metamodels.class_of(obj).contained:
            elements.extend(contents(obj, table))
        return elements


def _position(owner: EObject, feature: FeatureTable, obj: EObject) -> int:
    values = getattr(owner, feature.name)
    # To be asked for its index, an ordered set looks first whether it is given several.
    return int(values.map[obj] if isinstance(values, OrderedSet) else values.index(obj))


def _built(node: Node) -> Iterator[EObject]:
    pending = [node]
    while pending:
        current = pending.pop()
        if current.obj is not None:
            yield current.obj
            pending.extend(reversed(current.children))


_PATH = "trial.xmi"


def made_model(metamodels: Metamodels, root: EObject, *inner: EObject) -> Model:
    """Returns a model of one document without a file."""
    document = Document(Path(_PATH), _PATH, is_library=False, is_input=True)
    model = Model([document], metamodels)
    top = _node(root, None)
    document.root_nodes.append(top)
    model.adopt(document, top)
    for element in inner:
        node = _node(element, top)
        top.children.append(node)
        model.adopt(document, node)
    return model


def _node(element: EObject, parent: Node | None) -> Node:
    node = Node("", [], {}, parent, (1, 1, 0))
    node.obj = element
    return node


@contextmanager
def without_collector() -> Iterator[None]:
    """Keeps the collector from walking large data again and again while it grows."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


def digests(model: Model) -> dict[str, str]:
    """Returns the sha256 of each file of a model, those of the library left out, as `sha256sum`.

    Returns:
        Digests by path, relative to the folder of the first file, in the order of the paths.
    """
    own = [document for document in model.documents if not document.is_library]
    folder = model.documents[0].path.parent
    digests_by_path = {
        os.path.relpath(document.path, folder).replace(os.sep, "/"): sha256(
            document.data
        ).hexdigest()
        for document in own
    }
    return dict(sorted(digests_by_path.items()))
