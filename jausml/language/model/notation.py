"""Notations of models besides XMI: readers of documents that are no XML.

A notation turns text into the light nodes that the XMI parser makes, so that one builder checks
classes, features, values, bounds and references of both. What XMI cannot say stands in nodes as an
attribute of the namespace `NOTATION`: a reference by name.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from jausml.language.metamodel import ClassTable, FeatureTable, Metamodels
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.diagnostics import ReadFault, RuleInfo
from jausml.language.model.xmi.parsing import Node

NOTATION = "http://www.jausml.org/notation"
BY_NAME = f"{NOTATION} name"
"""The attribute of a node that refers to an element by its name."""


@dataclass(frozen=True, slots=True)
class Fault(ReadFault):
    """A fault that a notation finds in a document.

    Attributes:
        feature: The feature of that element whose value is lost, or empty.
        hides: Whether any feature of that element may be lost, since it could not be read.
    """

    owner: Node | None = None
    feature: str = ""
    hides: bool = False


@dataclass(frozen=True, slots=True)
class ImportedDocument:
    """The URI of a document whose names another one uses, and the place of its import."""

    uri: str
    line: int
    column: int


@dataclass(frozen=True, slots=True)
class Explanation:
    """Why a name means nothing in a document.

    Attributes:
        is_certain: Whether that is it, and none of the names that are much like this one.
    """

    hint: str = ""
    is_certain: bool = False


class Known(Protocol):
    """Names that the documents around a document have."""

    def find(self, qualified_class: str, name: str) -> Sequence[EObject]:
        """Returns the elements of a class that a name means in the document.

        Returns:
            None of them, the one, or all that it may mean.
        """

    def alike(self, qualified_class: str, name: str) -> Sequence[str]:
        """Returns known names of a class that are much like a name, the nearest first."""

    def message_codes(self) -> set[int]:
        """Returns the codes of the messages of the document, its imports and the library."""


class Written(Protocol):
    """A document that a notation has read."""

    @property
    def roots(self) -> Sequence[Node]:
        """The nodes of the root elements."""

    @property
    def faults(self) -> Sequence[Fault]:
        """The faults of the text."""

    @property
    def imports(self) -> Sequence[ImportedDocument]:
        """The documents that it imports."""

    def declare(self, known: Known) -> tuple[Sequence[Node], Sequence[Fault]]:
        """Returns further root nodes, of used elements that are not known.

        It is called once, when all documents are built and before references are resolved.
        """

    def explain(self, qualified_class: str, name: str) -> Explanation:
        """Returns why the document may know no element of a name."""

    def check(self) -> Sequence[Fault]:
        """Completes open features of the document, and returns the faults of its elements.

        It is called once, when all references are resolved.
        """


class Notation(Protocol):
    """A way to write models, told by the ending of file names."""

    @property
    def suffixes(self) -> tuple[str, ...]:
        """The endings, such as `.ros2jaus`."""

    @property
    def rules(self) -> Mapping[str, RuleInfo]:
        """The rules of its findings, by id."""

    def how_to_give(self, table: ClassTable, feature: FeatureTable) -> str:
        """Returns how a feature of a class is given a value, for a hint where it has none."""

    def read(self, data: bytes, path: Path, metamodels: Metamodels) -> Written:
        """Reads a document.

        Args:
            path: The file, for the names that it gives to what has none.
        """
