"""Names by which a text refers to elements once it is changed; references follow new ones."""

from __future__ import annotations

import copy
from collections.abc import Iterator

from jausml.authoring.editing.drafts import Context
from jausml.language.metamodel import ClassTable, FeatureTable
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.documents import Document
from jausml.language.model.model import Model
from jausml.language.model.notation import BY_NAME
from jausml.language.model.xmi.parsing import Node
from jausml.language.model.xmi.writer import external_href
from jausml.language.text.tree import Href, Name, Text
from jausml.language.text.writing.references import DocumentNames


class Naming(DocumentNames):
    """Names elements for a text; where a name alone does not do, an import is noted."""

    def __init__(self, context: Context) -> None:
        # Imports are noted in a copy: the document stays as it is.
        document = copy.copy(context.document)
        document.imports = list(document.imports)
        super().__init__(context.model, document)
        self._context = context
        self._home_document = context.document
        self._apart: dict[EObject, Model] = {}
        self._references: list[tuple[str, EObject, EObject, ClassTable]] = []
        self.imports: list[Name | Text] = []

    def find(self, ref: str) -> EObject:
        """Returns the element of a ref, of the library too."""
        element = self._context.find(ref)
        if element is None:
            element, model = self._context.locate(ref)
            self._apart[element] = model
        return element

    def name(self, owner: EObject, target: EObject, feature: FeatureTable) -> Name | Href:
        """Returns how an element is referred to: by name, if need be after an import."""
        short_name = self.short_name(owner, target, feature)
        if short_name is None and self._import(target):
            short_name = self.short_name(owner, target, feature)
        if short_name is not None:
            if feature.target is not None:
                self._references.append((short_name, target, owner, feature.target))
            return Name(short_name)
        home = self._apart.get(target)
        return self.href(target) if home is None else Href(self._foreign(target, home))

    def meant(self, text: str, owner: EObject, feature: FeatureTable) -> EObject | None:
        """Returns the element that a name means now, None for no or several ones."""
        candidates: list[EObject] = []
        if feature.target is not None:
            candidates = self._finder.find(text, feature.target, self._document, owner)
        return candidates[0] if len(candidates) == 1 else None

    def _foreign(self, target: EObject, home: Model) -> str:
        return external_href(target, home, self._folder)

    def _home(self) -> Document | None:
        return self._home_document

    def _place(self, target: EObject) -> str | None:
        is_here = self._model.document_of(target) is self._home_document
        return self._model.fragment(target) if is_here else None

    def _import(self, target: EObject) -> bool:
        """Notes an import of the document of an element, unless that changes other names."""
        model = self._apart.get(target, self._model)
        document = model.document_of(target)
        imports = self._document.imports
        if document is None or document is self._home_document or document in imports:
            return False
        imports.append(document)
        if self._is_misleading():
            imports.pop()
            return False
        self.imports.append(self.import_of(document))
        return True

    def _is_misleading(self) -> bool:
        """Tells whether the last import changes the meaning of a name.

        Two versions of a service may be named in one edit, so names that it gave count too.
        """
        classes = self._model.metamodels
        names = {
            getattr(element, "name", None)
            for root in self._document.imports[-1].roots
            for element in (root, *root.eAllContents())
        }
        for node, child in named_references(self._home_document):
            text = child.get(BY_NAME) or ""
            # An import can change the meaning of nothing but the names that it brings.
            if text.replace("/", ".").rpartition(".")[2] not in names:
                continue
            wanted = classes.class_of(node.obj).features[child.tag].target
            candidates = self._finder.find(text, wanted, self._document, node.obj) if wanted else []
            if candidates != self._finder_before(text, node, child):
                return True
        return any(
            self._finder.find(text, wanted, self._document, owner) != [target]
            for text, target, owner, wanted in self._references
        )

    def _finder_before(self, text: str, node: Node, child: Node) -> list[EObject]:
        feature = self._model.metamodels.class_of(node.obj).features[child.tag]
        before = copy.copy(self._document)
        before.imports = self._document.imports[:-1]
        wanted = feature.target
        return self._finder.find(text, wanted, before, node.obj) if wanted is not None else []


def named_references(document: Document) -> Iterator[tuple[Node, Node]]:
    """Yields the references by name or by href of a text: node of the element, and their own."""
    pending = list(document.root_nodes)
    while pending:
        node = pending.pop()
        for child in node.children:
            if child.obj is not None:
                pending.append(child)
            elif node.obj is not None and child.tag in _features(node):
                yield node, child


def _features(node: Node) -> set[str]:
    return {
        child.tag
        for child in node.children
        if child.get(BY_NAME) is not None or child.get("href") is not None
    }
