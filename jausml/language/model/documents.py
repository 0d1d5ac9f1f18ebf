"""Documents: the files of a model, parsed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from jausml.language.metamodel.classes.ecore import EClass, EObject
from jausml.language.model.diagnostics import Location
from jausml.language.model.notation import Notation, Written
from jausml.language.model.xmi.parsing import Node, attribute_positions

_FEW = 8


class Document:
    """One file of a model.

    Attributes:
        ids: XML elements by xmi:id, and by the identifying attribute of their class.
        lacks_imports: True when a document that it imports could not be read.
        is_shared: True when other models may have its elements too, which nobody changes.
        by_name: Of one that is shared, its elements by the last steps of their names.
        by_class: Of one that is shared, its elements by class, with their positions.
    """

    def __init__(self, path: Path, display: str, *, is_library: bool, is_input: bool) -> None:
        self.path = path
        self.display = display
        self.is_library = is_library
        self.is_input = is_input
        self.data = b""
        self.encoding = "utf-8"
        self.root_nodes: list[Node] = []
        self.ids: dict[str, Node] = {}
        self.readable = False
        self.notation: Notation | None = None
        self.written: Written | None = None
        self.imports: list[Document] = []
        self.lacks_imports = False
        self.is_shared = False
        self.by_name: dict[str, list[EObject]] | None = None
        self.by_class: dict[EClass, list[tuple[int, Any]]] | None = None
        self._by_tag: dict[Node, dict[str, list[Node]]] = {}
        self._root_positions: dict[EObject, int] | None = None
        self._positions: dict[Node, dict[tuple[str, str], tuple[int, int]]] = {}

    def __repr__(self) -> str:
        return f"<document {self.display}>"

    @property
    def is_xml(self) -> bool:
        """Whether the document is XMI."""
        return self.notation is None

    @property
    def roots(self) -> list[EObject]:
        """The root elements that could be built, in order."""
        return [node.obj for node in self.root_nodes if node.obj is not None]

    def root_position(self, obj: EObject) -> int | None:
        """Returns the position of a root element among the roots, None for other elements."""
        if self._root_positions is None:
            self._root_positions = {root: index for index, root in enumerate(self.roots)}
        return self._root_positions.get(obj)

    def location(self, node: Node, attribute: tuple[str, str] | None = None) -> Location:
        """Returns the place of an XML element, or of its attribute (namespace, local name).

        Other notations give each value an element of its own.
        """
        if attribute is None or not self.is_xml:
            return Location(self.display, node.line, node.column)
        known = self._positions.get(node)
        if known is None:
            known = self._positions[node] = attribute_positions(self.data, self.encoding, node)
        return Location(self.display, *known.get(attribute, (node.line, node.column)))

    def children(self, node: Node, tag: str) -> list[Node]:
        """Returns the child elements of a name, in order."""
        if len(node.children) <= _FEW:
            return [child for child in node.children if child.tag == tag]
        index = self._by_tag.get(node)
        if index is None:
            index = {}
            for child in node.children:
                index.setdefault(child.tag, []).append(child)
            self._by_tag[node] = index  # whole: another thread may ask meanwhile
        return index.get(tag, [])
