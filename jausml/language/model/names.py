"""Finder of elements by name: from the inside of a document out, in its imports, in the library.

A name stands for the elements whose containment path by names is the name or ends with it:
`ReportLocalPose`, `LocalPoseSensor.ReportLocalPose`, `geometry_msgs/Twist`. The parts of services
and actions of ROS go by what they are too: `std_srvs/SetBool.request`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from difflib import get_close_matches
from functools import cache
from typing import TypeVar

from jausml.language.metamodel import ClassTable, FeatureKind, Metamodels
from jausml.language.metamodel.classes import jaus, ros
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.diagnostics import Location, ReadFault
from jausml.language.model.documents import Document
from jausml.language.model.library import (
    LIBRARY_URI,
    XMI,
    library_paths,
    module_of,
    place_in_library,
)
from jausml.language.model.model import Model

ElementT = TypeVar("ElementT", bound="EObject")

_CODE = re.compile(r'\bcode="0x([0-9A-Fa-f]{4})"')
_VERSION = re.compile(r"([0-9]{1,9})\.([0-9]{1,9})")
_NAMED = re.compile(r'<(services|inputs|outputs|types|messages|actions)\s[^<]*?\bname="([^"<]*)"')
"""An element of the library that is referred to by name: its containment feature and its name."""
_PARTS = {
    "request": ros.ServiceType,
    "response": ros.ServiceType,
    "goal": ros.ActionType,
    "result": ros.ActionType,
    "feedback": ros.ActionType,
}
"""The features whose names stand for the message types that a service or an action consists of."""
_WHOLES = frozenset({"services", "actions"})


class NameFinder:
    """Finds elements by name."""

    def __init__(self, model: Model, open_library: Callable[[str], Document | ReadFault]) -> None:
        self._model = model
        self._open = open_library
        self._indices: dict[Document, dict[str, list[EObject]]] = {}

    def forget(self, document: Document) -> None:
        """Forgets the names of a document, which got further elements."""
        self._indices.pop(document, None)

    def find(
        self, name: str, wanted: ClassTable, document: Document, owner: EObject | None
    ) -> list[EObject]:
        """Returns the elements that a name may mean: those of the nearest scope that has any.

        Of one service in several versions the newest is meant.
        """
        referred = self._in_what_owners_refer_to(name, wanted, owner)
        if referred:
            return referred
        own = self._innermost(self._in_document(document, name, wanted), owner)
        if own:
            return own
        imported = self._within(document.imports, name, wanted)
        return newest(imported or self._within(self._library(name, wanted), name, wanted))

    def alike(self, name: str, wanted: ClassTable, document: Document) -> list[str]:
        """Returns known names of a class that are much like a name, the nearest first."""
        known: dict[str, None] = {}
        for visible_document in (document, *document.imports):
            for elements in self._index(visible_document).values():
                known.update(
                    (name_of(element), None) for element in elements if self._is_a(element, wanted)
                )
        known.update(dict.fromkeys(_library_names(_tags(self._model.metamodels, wanted))))
        last = _last_step(_normal(name))
        folded = [candidate for candidate in known if candidate.lower() == last.lower()]
        return folded or get_close_matches(last, known, n=3, cutoff=0.6)

    def others(self, name: str, document: Document) -> list[EObject]:
        """Returns the elements of any class that a name means in a document and its imports."""
        text = _normal(name)
        groups = (
            self._index(visible_document).get(_last_step(text), ())
            for visible_document in (document, *document.imports)
        )
        return [element for elements in groups for element in elements if _matches(element, text)]

    def label(self, element: EObject) -> str:
        """Returns the words for an element that is one of several: its names and its file."""
        document = self._model.document_of(element)
        file_name = document.path.name if document is not None else ""
        return f"{qualified_name(element)} ({file_name})"

    def how_to_choose(self, elements: list[EObject], document: Document) -> str:
        """Returns the advice by which a document means a certain one of several elements."""
        documents = [self._model.document_of(element) for element in elements]
        if len({qualified_name(element) for element in elements}) < len(elements) and len(
            set(documents)
        ) < len(elements):
            return "rename one of them"
        shipped = [origin.path for origin in documents if origin is not None and origin.is_library]
        if len(set(shipped)) < len(elements):
            return "write enough of the name, or import the document that is meant"
        module = f"import `{module_of(shipped[-1])}`"
        if all(origin in document.imports for origin in documents):
            href = f"{LIBRARY_URI}{place_in_library(shipped[0])}"
            fragment = self._model.fragment(elements[0])
            other = f'or say where the other one stands: @"{href}#{fragment}"'
            return f"drop one of the imports, such as {module}, {other}"
        return f"import the document that is meant, for example: {module}"

    def kind(self, element: EObject) -> str:
        """Returns the class of an element with its package."""
        return self._model.metamodels.class_of(element).qualified_name

    def location(self, element: EObject) -> Location:
        """Returns where an element is written."""
        return self._model.location(element)

    def _library(self, name: str, wanted: ClassTable) -> list[Document]:
        """Returns the documents of the library that may know a name, read at the first call."""
        text = _normal(name)
        tags = _tags(self._model.metamodels, wanted)
        files: Iterable[tuple[str, str]] = library_index().get(_last_step(text), ())
        whole = _whole_of(text)
        if whole:
            tags |= _WHOLES
            files = (*files, *library_index().get(_last_step(whole), ()))
        documents = (self._open(f"{LIBRARY_URI}{path}") for path, tag in files if tag in tags)
        return list(
            dict.fromkeys(document for document in documents if isinstance(document, Document))
        )

    def _within(
        self, documents: Iterable[Document], name: str, wanted: ClassTable
    ) -> list[EObject]:
        return [
            element
            for document in documents
            for element in self._in_document(document, name, wanted)
        ]

    def _in_document(self, document: Document, name: str, wanted: ClassTable) -> list[EObject]:
        text = _normal(name)
        index = self._index(document)
        candidates = index.get(_last_step(text), [])
        if "." in text:  # the index knows the last step alone
            candidates = [candidate for candidate in candidates if _matches(candidate, text)]
        whole = _whole_of(text)
        if whole:
            owners = [
                element for element in index.get(_last_step(whole), ()) if _matches(element, whole)
            ]
            candidates = [*candidates, *_parts(owners, _last_step(text))]
        return [candidate for candidate in candidates if self._is_a(candidate, wanted)]

    def _in_what_owners_refer_to(
        self, name: str, wanted: ClassTable, owner: EObject | None
    ) -> list[EObject]:
        """Returns the elements that stand in what the owners of an element refer to.

        A topic names a join of the map that its connection refers to, wherever that map stands.
        """
        text = _normal(name)
        for scope in list(with_owners(owner))[1:]:
            elements = [
                element
                for target in self._referred(scope)
                # Few targets can own such an element, and walking all that they own is costly.
                if wanted in held_by(self._model.metamodels, self._class_of(target))
                for element in target.eAllContents()
                if self._is_a(element, wanted) and _matches(element, text)
            ]
            if elements:
                return elements
        return []

    def _referred(self, element: EObject) -> list[EObject]:
        """Returns the targets of the references of an element that take one value."""
        names = _single_references(self._model.metamodels.class_of(element))
        values = (getattr(element, name) for name in names)
        return [value for value in values if value is not None]

    @staticmethod
    def _innermost(candidates: list[EObject], owner: EObject | None) -> list[EObject]:
        others = [candidate for candidate in candidates if candidate is not owner]
        if len(others) <= 1:
            return others
        around = {id(other): set(map(id, with_owners(other))) for other in others}
        for scope in with_owners(owner):
            inside = [other for other in others if id(scope) in around[id(other)]]
            if inside:
                return inside
        return others

    def _is_a(self, element: EObject, wanted: ClassTable) -> bool:
        return self._class_of(element) in wanted.subtypes

    def _class_of(self, element: EObject) -> ClassTable:
        return self._model.metamodels.class_of(element)

    def _index(self, document: Document) -> dict[str, list[EObject]]:
        index = self._indices.get(document)
        if index is None:
            index = document.by_name or self._indexed(document)
            self._indices[document] = index
            # A shared document keeps its index for the readings to come.
            if document.is_shared:
                document.by_name = index
        return index

    def _indexed(self, document: Document) -> dict[str, list[EObject]]:
        index: dict[str, list[EObject]] = {}
        for element in self._model.elements_of(document):
            name = name_of(element)
            if name:
                index.setdefault(_last_step(_normal(name)), []).append(element)
        return index


def newest(elements: list[EObject]) -> list[EObject]:
    """Returns the newest of elements that are one in several versions of a JAUS service.

    Versions of one service with the same major number understand each other; others are as far
    apart as different services. What is not that comes back as it is.
    """
    versions = [_version_of(element) for element in elements]
    whose = {None if version is None else version[0] for version in versions}
    if len(whose) != 1 or None in whose:
        return elements
    best = max(version[1] for version in versions if version is not None)
    return [
        element
        for element, version in zip(elements, versions, strict=True)
        if version is not None and version[1] == best
    ]


def _version_of(element: EObject) -> tuple[tuple[str, int], int] | None:
    """Returns URN and major version of the service that an element is or stands in, and the minor.

    None when it stands in no service with such a version.
    """
    service = around(element, jaus.Service)
    match = _VERSION.fullmatch(service.version or "") if service is not None else None
    return ((service.urn or "", int(match[1])), int(match[2])) if service and match else None


def qualified_name(element: EObject) -> str:
    """Returns the names of an element and of its owners, joined by dots."""
    names = map(name_of, with_owners(element))
    return ".".join(reversed([name for name in names if name]))


def depth(element: EObject) -> int:
    """Returns how many owners an element has, and itself."""
    return len(list(with_owners(element)))


@cache
def library_index() -> Mapping[str, list[tuple[str, str]]]:
    """Returns where the library has elements that are referred to by name.

    Returns:
        Files (relative, with forward slashes) and containment features, by simple name.
    """
    index: dict[str, set[tuple[str, str]]] = {}
    for path, text in _library_texts():
        for tag, name in _NAMED.findall(text):
            index.setdefault(_last_step(name), set()).add((path, tag))
    return {name: sorted(places) for name, places in index.items()}


@cache
def library_codes() -> frozenset[int]:
    """Returns the codes of all messages of the library."""
    return frozenset(int(code, 16) for _, text in _library_texts() for code in _CODE.findall(text))


def _library_texts() -> Iterator[tuple[str, str]]:
    for path in library_paths(suffixes=(XMI,)):
        yield place_in_library(path), path.read_text(encoding="utf-8")


def _library_names(tags: frozenset[str]) -> list[str]:
    return sorted(
        name for name, places in library_index().items() if any(tag in tags for _, tag in places)
    )


@cache
def _tags(metamodels: Metamodels, wanted: ClassTable) -> frozenset[str]:
    """Returns the containment features that may hold an element of a class."""
    return frozenset(
        feature.name
        for table in metamodels.classes.values()
        for feature in table.features.values()
        if feature.kind is FeatureKind.CONTAINMENT
        and feature.target is not None
        and (feature.target in wanted.supertypes or wanted in feature.target.supertypes)
    )


@cache
def held_by(metamodels: Metamodels, table: ClassTable) -> frozenset[ClassTable]:
    """Returns the classes of what an element of a class may own, at any depth, and their bases."""
    classes: set[ClassTable] = set()
    pending = [table]
    while pending:
        for feature in pending.pop().contained:
            target = feature.target
            # A feature of any class may hold all of them.
            new = set(metamodels.classes.values() if target is None else target.subtypes) - classes
            classes |= new
            pending += new
    return frozenset(
        base for class_table in classes for base in (class_table, *class_table.supertypes)
    )


@cache
def _single_references(table: ClassTable) -> tuple[str, ...]:
    features = table.features.values()
    single = (feature for feature in features if feature.kind is FeatureKind.CROSS_REFERENCE)
    return tuple(feature.name for feature in single if not feature.many)


def _normal(name: str) -> str:
    """Returns a name with one kind of separator: ROS writes `geometry_msgs/msg/Twist`."""
    for folder in ("/msg/", "/srv/", "/action/"):
        name = name.replace(folder, "/")
    return name.replace("/", ".")


def _last_step(name: str) -> str:
    return name.rpartition(".")[2]


def _whole_of(text: str) -> str:
    """Returns the name of the service or action whose part a name may mean, else an empty text."""
    whole, _, part = text.rpartition(".")
    return whole if part in _PARTS else ""


def _parts(owners: Iterable[EObject], part: str) -> list[EObject]:
    """Returns the parts of services and actions that go by what they are."""
    parts = [getattr(owner, part) for owner in owners if isinstance(owner, _PARTS[part])]
    return [member for member in parts if member is not None]


def _matches(element: EObject, text: str) -> bool:
    path = _normal(qualified_name(element))
    return path == text or path.endswith(f".{text}")


def name_of(element: EObject) -> str:
    """Returns the name of an element, empty when it has none."""
    return getattr(element, "name", None) or ""


def with_owners(element: EObject | None) -> Iterator[EObject]:
    """Yields an element and its owners, from the inside out."""
    while element is not None:
        yield element
        element = element.eContainer()


def around(element: EObject | None, *kinds: type[ElementT]) -> ElementT | None:
    """Returns the element itself or its nearest owner of some classes, None without one."""
    return next((owner for owner in with_owners(element) if isinstance(owner, kinds)), None)
