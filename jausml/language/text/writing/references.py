"""Elements as uniform blocks of ros2jaus text, with the shortest names of others and their imports.

Which name leads where is decided by `NameFinder`, as for text that is read.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Any, TypeAlias, cast

from jausml.language.metamodel import ClassTable, FeatureKind, FeatureTable, Metamodels
from jausml.language.metamodel.classes import bridge, ros
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.metamodel.filling import count
from jausml.language.model.diagnostics import ReadFault
from jausml.language.model.documents import Document
from jausml.language.model.library import LIBRARY_URI, library_root
from jausml.language.model.model import Model
from jausml.language.model.names import NameFinder, name_of
from jausml.language.model.reading.reader import read_models
from jausml.language.model.xmi.parsing import Node
from jausml.language.model.xmi.writer import external_href, is_written
from jausml.language.semantics.connections.exchanges import FEATURES, unstated
from jausml.language.text.keywords import keyword_of, owning_features
from jausml.language.text.tree import BlockItem, Element, Feature, Href, Name, Text, Value, is_map
from jausml.language.text.writing.layout import space
from jausml.language.text.writing.spelling import (
    IN_THE_HEAD,
    attribute_value,
    documented,
    head_name,
    is_name,
    needs_feature,
)

Special: TypeAlias = "Callable[[Any], Iterator[BlockItem]]"

_Reference: TypeAlias = "tuple[EObject, EObject, FeatureTable]"
"""An element, the target of its reference, and the feature."""

_PACKAGED = frozenset({"ros.MessageType", "ros.ServiceType", "ros.ActionType"})


class DocumentNames:
    """Names elements for a document that was read."""

    def __init__(self, model: Model, document: Document) -> None:
        self._model = model
        self._document = document
        self._folder = document.path.parent
        self._library = Path(os.path.realpath(library_root()))
        self._finder = NameFinder(model, self._open_library)

    def name(self, owner: EObject, target: EObject, feature: FeatureTable) -> Name | Href:
        """Returns the reference to an element: its shortest name, else file and fragment."""
        short_name = self.short_name(owner, target, feature)
        return Name(short_name) if short_name is not None else self.href(target)

    def href(self, target: EObject) -> Href:
        """Returns how an element is referred to by file and fragment."""
        place = self._place(target)
        if place is not None:
            return Href(f"#{place}")
        return Href(external_href(target, self._model, self._folder))

    def is_apart(self, obj: EObject) -> bool:
        """Tells whether an owned element is the root of another document, which keeps it."""
        document = self._model.document_of(obj)
        if document is None or document is self._home():
            return False
        return document.root_position(obj) is not None

    def short_name(self, owner: EObject, target: EObject, feature: FeatureTable) -> str | None:
        """Returns the shortest name of an element, None when no name leads to it."""
        wanted = cast("ClassTable", feature.target)
        for text in self._candidates(target):
            elements = is_name(text) and self._finder.find(text, wanted, self._document, owner)
            # A name counts only if the reader of the text is led to this very element.
            if elements == [target]:
                return text
        return None

    def import_of(self, document: Document) -> Name | Text:
        """Returns the import of another document, by which its names can be used."""
        if document.is_library:
            place = document.path.relative_to(self._library).with_suffix("")
            return Name(".".join(place.parts))
        return Text(Path(os.path.relpath(document.path, self._folder)).as_posix())

    def _home(self) -> Document | None:
        """Returns the document of which the model has the elements."""
        return self._document

    def _place(self, target: EObject) -> str | None:
        """Returns the fragment of an element of the document, None for others."""
        is_here = self._model.document_of(target) is self._document
        return self._model.fragment(target) if is_here else None

    def _candidates(self, target: EObject) -> Iterator[str]:
        """Yields the names of an element, the best first: ROS types of elsewhere by package."""
        steps = _path(target)
        qualified_class = self._model.metamodels.class_of(target).qualified_name
        # Types of other packages are called by package and type, as ROS does it.
        if qualified_class in _PACKAGED and self._place(target) is None and len(steps) > 1:
            if isinstance(target.eContainer(), ros.ServiceType | ros.ActionType):
                yield f"{steps[-3]}/{steps[-2]}.{target.eContainmentFeature().name}"
            else:
                yield f"{steps[-2]}/{steps[-1]}"
        for length in range(1, len(steps) + 1):
            yield ".".join(steps[-length:])

    def _open_library(self, uri: str) -> Document | ReadFault:
        path = self._library / uri.removeprefix(LIBRARY_URI)
        for document in self._model.documents:
            if document.path == path:
                return document
        return _library_document(path, self._model.metamodels)


class ReferenceNames(DocumentNames):
    """Names elements for a document that is to be written."""

    def __init__(self, roots: Sequence[EObject], model: Model, path: Path) -> None:
        document = Document(
            Path(os.path.realpath(path)), str(path), is_library=False, is_input=True
        )
        super().__init__(model, document)
        self._read_from = model.document_of(roots[0]) if roots else None
        self._fragments = self._name_fragments(roots)
        self._document.root_nodes = [self._node(root, None) for root in roots]
        self._import()

    @property
    def imports(self) -> list[Name | Text]:
        """The imports of the document: parts of the library, then files by their paths."""
        imports = sorted(self._document.imports, key=lambda document: not document.is_library)
        return [self.import_of(document) for document in imports]

    def _home(self) -> Document | None:
        return self._read_from

    def _place(self, target: EObject) -> str | None:
        return self._fragments.get(target)

    def _import(self) -> None:
        """Imports the files that are referred to, and of the library what has no name otherwise.

        Where two versions of a service are referred to, names stand for those that are referred
        to more often; the others have theirs by file and fragment.
        """
        outside = [
            reference for reference in self._references() if reference[1] not in self._fragments
        ]
        uses = Counter(self._model.document_of(target) for _, target, _ in outside)
        documents = [used for used in self._model.documents if used in uses]
        imports = self._document.imports
        imports += [own_document for own_document in documents if not own_document.is_library]
        shipped = [reference for reference in outside if self._model.is_library(reference[1])]
        named = self._count_named(shipped)
        library = [
            library_document for library_document in documents if library_document.is_library
        ]
        for document in sorted(
            library,
            key=lambda library_document: (-uses[library_document], str(library_document.path)),
        ):
            if named == len(shipped):
                break
            imports.append(document)
            before, named = named, self._count_named(shipped)
            # An import that names nothing more would only make other names ambiguous.
            if named <= before:
                named = before
                imports.pop()

    def _count_named(self, references: Sequence[_Reference]) -> int:
        return sum(self.short_name(*reference) is not None for reference in references)

    def _references(self) -> Iterator[_Reference]:
        for obj in self._fragments:
            for feature in self._model.metamodels.class_of(obj).features.values():
                if feature.kind is FeatureKind.CROSS_REFERENCE and count(obj, feature):
                    value = getattr(obj, feature.name)
                    for target in value if feature.many else [value]:
                        yield obj, target, feature

    def _owned(self, obj: EObject) -> Iterator[tuple[EObject, str]]:
        """Yields the elements that an element owns in this document, with the step to each."""
        for feature in self._model.metamodels.class_of(obj).features.values():
            if feature.kind is FeatureKind.CONTAINMENT and count(obj, feature):
                value = getattr(obj, feature.name)
                steps = [(value, f"@{feature.name}")]
                if feature.many:
                    steps = [
                        (child, f"@{feature.name}.{index}") for index, child in enumerate(value)
                    ]
                yield from (step for step in steps if not self.is_apart(step[0]))

    def _name_fragments(self, roots: Sequence[EObject]) -> dict[EObject, str]:
        """Returns the elements in document order with their paths by features, as EMF has them."""
        fragments: dict[EObject, str] = {}
        several = len(roots) > 1
        pending = [(root, f"/{index}" if several else "/") for index, root in enumerate(roots)][
            ::-1
        ]
        while pending:
            obj, at = pending.pop()
            fragments[obj] = at
            pending += [(element, f"{at}/{step}") for element, step in self._owned(obj)][::-1]
        return fragments

    def _node(self, obj: EObject, parent: Node | None) -> Node:
        """Returns an element and all that it owns as light nodes, which a document consists of."""
        node = Node("", [], {}, parent, (1, 1, 0))
        node.obj = obj
        node.children = [self._node(element, node) for element, _ in self._owned(obj)]
        return node


@cache
def _library_document(path: Path, metamodels: Metamodels) -> Document:
    """Returns a file of the library that the model does not have: its names count all the same."""
    return read_models([path], metamodels=metamodels).model.documents[0]


def _path(obj: EObject) -> list[str]:
    """Returns the names that lead to an element; empty when it has none itself."""
    if not name_of(obj):
        return []
    steps: list[str] = []
    around: EObject | None = obj
    while around is not None:
        steps.append(name_of(around))
        around = around.eContainer()
    return [step for step in reversed(steps) if step]


ROOT = Name("root")
"""The feature of a document that makes a root of an element which could not stand there alone."""

_VALUES = (FeatureKind.ATTRIBUTE, FeatureKind.CROSS_REFERENCE)
STANDING = frozenset(
    {"system.System", "bridge.MapLibrary", "jaus.ServiceSet", "ros.InterfacePackage"}
)
"""The classes whose elements stand in a document without further words."""


class ElementWriter:
    """Writer of the blocks of one document."""

    def __init__(self, metamodels: Metamodels, names: DocumentNames) -> None:
        self._metamodels = metamodels
        self._names = names
        self.special: dict[str, Special] = {}
        """The writers of blocks in a notation of their own, by qualified class."""
        self.says_all = False
        """Whether connections say what follows from where they stand, too."""

    def root(self, obj: EObject) -> Element | Feature:
        """Returns a root element with all that it owns."""
        if self._metamodels.class_of(obj).qualified_name in STANDING:
            return self.element(obj)
        return documented(Feature(ROOT, [self._value(obj, with_class=True)]), obj)

    def alone(self, obj: EObject) -> Element | Feature:
        """Returns an element as it may stand in its owner, with its class and feature stated."""
        owner, feature = obj.eContainer(), obj.eContainmentFeature()
        if owner is None or feature is None:
            return self.root(obj)
        metamodels = self._metamodels
        is_obvious = self._is_obvious(
            owner, metamodels.class_of(owner).features[feature.name], metamodels.class_of(obj)
        )
        if is_obvious and head_name(obj) is not None:
            return self.element(obj)
        value = self._value(obj, with_class=True)
        return documented(Feature(Name(feature.name), [value]), obj)

    def element(self, obj: EObject) -> Element:
        """Returns an element as a block by itself."""
        table = self._metamodels.class_of(obj)
        keyword, name, items = Name(keyword_of(table.name)), head_name(obj), self._items(obj)
        if name is None:
            block = Element(None, keyword, items)
        else:
            block = Element(None if is_map(items) else keyword, name, items)
        return documented(block, obj)

    def values(self, obj: EObject, *, without: frozenset[str]) -> Iterator[Feature]:
        """Yields the attributes and references of an element as features."""
        following = None
        if isinstance(obj, bridge.Connection) and not self.says_all:
            following = unstated(obj)
        for feature in self._metamodels.class_of(obj).features.values():
            said_here = feature.name not in without or needs_feature(obj, feature.name)
            if not said_here or feature.kind not in _VALUES:
                continue
            # What follows from where a connection stands is left open, and follows again when read.
            if following is not None and feature.name in FEATURES:
                is_needed = feature.name not in following
            else:
                is_needed = is_written(obj, feature)
            if is_needed:
                yield self.feature(obj, feature)

    def _items(self, obj: EObject) -> list[BlockItem]:
        """Returns the items in the block of an element, values before owned elements."""
        table = self._metamodels.class_of(obj)
        if special := self.special.get(table.qualified_name):
            return list(special(obj))
        items: list[BlockItem] = [*self.values(obj, without=IN_THE_HEAD)]
        for feature in table.features.values():
            if feature.kind is FeatureKind.CONTAINMENT and is_written(obj, feature):
                items += self.owned(obj, feature)
        space(items)
        return items

    def children(self, obj: EObject, names: Sequence[str]) -> list[BlockItem]:
        """Returns the elements that an element owns by some features, as items."""
        features = self._metamodels.class_of(obj).features
        return [item for name in names for item in self.owned(obj, features[name])]

    def owned(self, obj: EObject, feature: FeatureTable) -> Iterator[BlockItem]:
        """Yields the elements of one feature."""
        value = getattr(obj, feature.name)
        for child in value if feature.many else [value]:
            if child is not None:
                yield self.item(obj, child, feature)

    def item(self, obj: EObject, element: EObject, feature: FeatureTable) -> Element | Feature:
        """Returns one of the elements of a feature of an element."""
        if self._names.is_apart(element):
            return Feature(Name(feature.name), [self._names.href(element)])
        table = self._metamodels.class_of(element)
        is_said_best = table is feature.target and _is_said_by(feature, table)
        is_unclear = table.qualified_name in self.special and head_name(element) is None
        if is_said_best or is_unclear or not self._is_obvious(obj, feature, table):
            return self.value_item(element, feature)
        return self.element(element)

    def value_item(self, obj: EObject, feature: FeatureTable) -> Feature:
        """Returns an owned element as the value of its feature, `inputs: new message_def A {}`."""
        with_class = (
            self._metamodels.class_of(obj) is not feature.target or head_name(obj) is not None
        )
        item = Feature(Name(feature.name), [self._value(obj, with_class=with_class)])
        return documented(item, obj)

    def _is_obvious(self, owner: EObject, feature: FeatureTable, table: ClassTable) -> bool:
        """Tells whether the feature of a block follows from its class."""
        return owning_features(self._metamodels.class_of(owner), table) == (feature.name,)

    def _value(self, obj: EObject, *, with_class: bool) -> Element:
        table = self._metamodels.class_of(obj)
        if not with_class:
            return Element(None, None, self._items(obj))
        return Element(Name(keyword_of(table.name)), head_name(obj), self._items(obj))

    def feature(self, obj: EObject, feature: FeatureTable) -> Feature:
        """Returns an attribute or a reference of an element with its values."""
        value = getattr(obj, feature.name)
        values = list(value) if feature.many else [value]
        written: list[Value] = []
        for item in values:
            if feature.kind is FeatureKind.CROSS_REFERENCE:
                written.append(self._names.name(obj, item, feature))
            elif feature.name in IN_THE_HEAD and item is not None:
                written.append(Text(item))
            else:
                written.append(attribute_value(item, feature))
        return Feature(Name(feature.name), written)


def _is_said_by(feature: FeatureTable, table: ClassTable) -> bool:
    """Tells whether `qos: { ... }` says more than `qos_profile { ... }`, which has no name."""
    is_keyword = feature.many and feature.name.startswith(keyword_of(table.name))
    return "name" not in table.features and not is_keyword
