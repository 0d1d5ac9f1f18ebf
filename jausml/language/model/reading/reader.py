"""Reader of models: files become pyecore objects and findings, all in one run."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from jausml.language.metamodel import FeatureTable, Metamodels, load_metamodels
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.diagnostics import Diagnostic, Location, ReadFault, Severity
from jausml.language.model.documents import Document
from jausml.language.model.files import bounded, read_input
from jausml.language.model.model import Model, without_collector
from jausml.language.model.names import NameFinder
from jausml.language.model.notation import Explanation, Fault, Notation, Written
from jausml.language.model.project import find_project_root
from jausml.language.model.reading.classes import check_bounds
from jausml.language.model.reading.elements import ElementBuilder, Mention, Reference
from jausml.language.model.reading.library_cache import LibraryCache, NotShareableError
from jausml.language.model.reading.problems import NodePlace, ReadingProblems
from jausml.language.model.reading.references import (
    KnownNames,
    NameResolution,
    Resolution,
    in_order_of_import,
)
from jausml.language.model.uris import FileTarget, UriResolver
from jausml.language.model.xmi.parsing import Node, parse

_BESIDE = "JML103"
"""The rule of what is written beside the features of an element, which are read all the same."""


@dataclass(frozen=True, slots=True)
class LostReference:
    """A reference that leads to no element.

    Attributes:
        path: The file that is referred to, whether it is there or not; None for no file.
        fragment: The fragment or id in it, or the name of a reference by name.
    """

    owner: EObject
    feature: FeatureTable
    path: Path | None
    fragment: str


@dataclass(frozen=True, slots=True)
class ReadResult:
    """The outcome of reading: a model and the findings.

    Attributes:
        model: The elements that could be built, which is all of them when there are no errors.
    """

    model: Model
    diagnostics: list[Diagnostic] = field(default_factory=list)
    lost: tuple[LostReference, ...] = ()

    @property
    def has_errors(self) -> bool:
        """True when the model cannot be used."""
        return any(diagnostic.severity is Severity.ERROR for diagnostic in self.diagnostics)


def read_models(
    paths: Iterable[str | os.PathLike[str]],
    *,
    project_root: str | os.PathLike[str] | None = None,
    allow_outside: bool = False,
    projects: Mapping[str, str | os.PathLike[str]] | None = None,
    metamodels: Metamodels | None = None,
    notations: Sequence[Notation] = (),
    contents: Mapping[Path, bytes] | None = None,
    cache: LibraryCache | None = None,
) -> ReadResult:
    """Reads model files and all that they refer to.

    Every problem becomes a diagnostic with its place; nothing that a file holds raises.

    Args:
        project_root: The folder that hrefs may not leave; see `find_project_root` for the default.
        projects: Folders of Eclipse projects by name, for `platform:/resource/<name>/` hrefs.
        notations: What reads files that are no XMI, by the endings of their names.
        contents: What an editor holds of files, by real path; it is read instead of what is stored.
        cache: Where documents of the library are kept for the next reading with it. Whoever gives
            one must not change what was read. Without one all elements belong to the model alone.

    Returns:
        The model and the findings.
    """
    names = [os.fspath(path) for path in paths]
    root = find_project_root(Path(name) for name in names)
    if project_root is not None:
        root = Path(project_root)
    folders = {name: Path(folder) for name, folder in (projects or {}).items()}
    uris = UriResolver(root, allow_outside=allow_outside, projects=folders)
    arguments = (metamodels or load_metamodels(), uris, notations, contents or {})
    with without_collector():
        try:
            reading = _Reading(*arguments, cache)
            model, diagnostics = reading.run(names)
        # The library reads the same without a cache, only slower.
        except NotShareableError:
            reading = _Reading(*arguments, None)
            model, diagnostics = reading.run(names)
    return ReadResult(model, diagnostics, reading.lost)


class _Reading:
    """One run of the reader."""

    def __init__(
        self,
        metamodels: Metamodels,
        uris: UriResolver,
        notations: Sequence[Notation],
        contents: Mapping[Path, bytes],
        cache: LibraryCache | None,
    ) -> None:
        self._metamodels = metamodels
        self._notations = notations
        self._contents = contents
        self._cache = cache
        self._taken: set[Document] = set()
        self._opened: dict[Document, dict[str, Document | None]] = {}
        self._uris = uris
        self._documents: dict[Path, Document] = {}
        self._targets: dict[tuple[str, str], FileTarget | ReadFault] = {}
        rules = {id_: rule for notation in notations for id_, rule in notation.rules.items()}
        self._problems = ReadingProblems(rules)
        self._model = Model([], metamodels)
        self._references: list[Reference | Mention] = []
        self._written: dict[Document, Written] = {}
        self._names = NameFinder(self._model, self._open_library)
        self.lost: tuple[LostReference, ...] = ()

    def run(self, names: Sequence[str]) -> tuple[Model, list[Diagnostic]]:
        targets = [self._uris.target_of(name, self._contents) for name in names]
        if any(file_target.is_library for file_target in targets):
            self._cache = None  # what is checked itself is not what others refer to
        if self._cache is not None:
            self._cache.prepare(self._contents.keys())
        for target in targets:
            self._read_target(target)
        self._open_all()
        self._declare()
        by_name = NameResolution(self._names, self._problems, self._explain)
        resolution = Resolution(self._model, self._problems, self._open, by_name)
        resolution.run(self._references)
        self.lost = tuple(map(self._lost, resolution.lost))
        for document, written in self._written.items():
            self._report(document, written.check())
        read = [candidate for candidate in self._model.documents if candidate not in self._taken]
        # Documents of the cache were sound when they were put there, so they are not checked again.
        check_bounds(read, self._model, self._problems)
        self._model.unread = self._problems.unread
        diagnostics = self._problems.diagnostics(self._model)
        if self._cache is not None:
            faulty = {diagnostic.location.path for diagnostic in diagnostics}
            self._cache.put(self._model, self._opened, faulty)
        return self._model, diagnostics

    def _lost(self, reference: Reference) -> LostReference:
        document = reference.place.document
        target = self._uris.resolve(reference.uri, document) if reference.uri else None
        path = target.path if isinstance(target, FileTarget) else None
        if not reference.uri and not reference.name:
            path = document.path
        named = reference.fragment or reference.name
        return LostReference(reference.owner, reference.feature, path, named)

    def _open_all(self) -> None:
        """Opens the documents that others import or refer to."""
        imported = referred = 0
        # Opening a document adds to both.
        while imported < len(self._model.documents) or referred < len(self._references):
            if imported < len(self._model.documents):
                self._import(self._model.documents[imported])
                imported += 1
            else:
                reference = self._references[referred]
                referred += 1
                if reference.uri:
                    self._open(reference.uri, reference.place.document)

    def _read_target(self, target: FileTarget) -> None:
        if target.path in self._documents:
            return
        document = self._add(target, is_input=True)
        fault = self._load(document)
        if fault is not None:
            self._problems.report("JML001", Location(document.display), fault)

    def _open(self, uri: str, base: Document) -> Document | ReadFault:
        """Returns the document that a URI names, read at the first call."""
        opened = self._opened_by(uri, base)
        if base.is_shared:
            # A fault is noted too: a document of the library that lacks another must not be shared.
            document = None if isinstance(opened, ReadFault) else opened
            self._opened.setdefault(base, {}).setdefault(uri, document)
        return opened

    def _opened_by(self, uri: str, base: Document) -> Document | ReadFault:
        # A URI means the same from everywhere in a document, and thousands of references repeat it.
        key = (uri, base.display)
        target = self._targets.get(key)
        if target is None:
            target = self._targets[key] = self._uris.resolve(uri, base)
        if isinstance(target, ReadFault):
            return target
        document = self._documents.get(target.path) or self._take(target)
        if document is None:
            document = self._add(target, is_input=False)
            fault = self._load(document)
            if fault is not None:
                message = f"referenced file {target.display}: {fault}"
                absent = ReadFault("JML203", message)
                # The next reference to it gets the same answer without a second look at the disk.
                self._targets[key] = absent
                del self._documents[target.path]
                self._model.documents.remove(document)
                return absent
        if base.is_shared and document.display != target.display:
            raise NotShareableError  # what is kept refers to a document of the other name
        return document

    def _add(self, target: FileTarget, *, is_input: bool) -> Document:
        document = Document(
            target.path, target.display, is_library=target.is_library, is_input=is_input
        )
        is_xml = self._notation_of(target.path) is None
        document.is_shared = self._cache is not None and target.is_library and is_xml
        self._documents[target.path] = document
        self._model.documents.append(document)
        return document

    def _take(self, target: FileTarget) -> Document | None:
        """Returns a document that was read before, None when it was not."""
        cached = self._cache.find(target) if self._cache is not None else None
        if cached is None:
            return None
        document = cached.document
        self._documents[target.path] = document
        self._model.documents.append(document)
        self._model.share(cached.origins)
        self._taken.add(document)
        place = NodePlace(document, document.root_nodes[0])
        # What it refers to is opened again: the model needs those documents, not just this one.
        self._references += [Mention(place, uri) for uri in cached.uris]
        return document

    def _load(self, document: Document) -> str | None:
        """Reads and builds a document; returns the fault of its file, else None."""
        if self._cache is not None and document.is_shared:
            self._cache.note(document.path)
        try:
            held = self._contents.get(document.path)
            path = document.path
            document.data = read_input(path) if held is None else bounded(held, path)
        except (OSError, ValueError) as error:
            # A file that is too large is there, so references to it are not reported as absent.
            if isinstance(error, OSError) and error.errno == errno.EFBIG:
                self._problems.report("JML002", Location(document.display), str(error.strerror))
                return None
            return getattr(error, "strerror", None) or str(error)
        notation = self._notation_of(document.path)
        if notation is not None:
            self._read_notation(document, notation)
            return None
        result = parse(document.data)
        fault = result.fault
        if result.root is None:
            if fault is not None:
                place = Location(document.display, fault.line, fault.column)
                self._problems.report(fault.rule, place, fault.message, fault.hint)
            return None
        document.encoding = result.encoding
        document.readable = True
        self._builder(document).build(result.root)
        return None

    def _notation_of(self, path: Path) -> Notation | None:
        """Returns the notation of a file that is no XMI."""
        fitting = (
            notation for notation in self._notations if path.name.endswith(notation.suffixes)
        )
        return next(fitting, None)

    def _builder(self, document: Document) -> ElementBuilder:
        return ElementBuilder(
            self._metamodels, self._model, self._problems, self._references, document
        )

    def _read_notation(self, document: Document, notation: Notation) -> None:
        written = notation.read(document.data, document.path, self._metamodels)
        document.notation = notation
        document.written = written
        document.readable = True
        self._written[document] = written
        self._add_roots(document, written.roots, written.faults)

    def _add_roots(
        self, document: Document, nodes: Sequence[Node], faults: Sequence[Fault]
    ) -> None:
        document.root_nodes += nodes
        self._builder(document).build_roots(nodes)
        self._report(document, faults)

    def _report(self, document: Document, faults: Sequence[Fault]) -> None:
        for fault in faults:
            # A node of its own places the finding; its parent tells the element.
            node = Node("", [], {}, fault.owner, (fault.line, fault.column, 0))
            place = NodePlace(document, node)
            hides = not fault.feature and fault.rule != _BESIDE
            self._problems.report(fault.rule, place, fault.message, fault.hint, hides=hides)
            owner = fault.owner.obj if fault.owner is not None else None
            if owner is not None and fault.feature:
                self._problems.mark_unread(owner, fault.feature)
            if owner is not None and fault.hides:
                self._problems.mark_unread(owner)

    def _import(self, document: Document) -> None:
        written = self._written.get(document)
        for import_entry in written.imports if written is not None else ():
            opened = self._open(import_entry.uri, document)
            if isinstance(opened, ReadFault):
                place = Location(document.display, import_entry.line, import_entry.column)
                self._problems.report(opened.rule, place, opened.message, opened.hint)
            elif opened is not document and opened not in document.imports:
                document.imports.append(opened)
            lost = isinstance(opened, ReadFault) or not opened.readable
            document.lacks_imports = document.lacks_imports or lost

    def _explain(self, document: Document, qualified_class: str, name: str) -> Explanation:
        written = self._written.get(document)
        return Explanation() if written is None else written.explain(qualified_class, name)

    def _open_library(self, uri: str) -> Document | ReadFault:
        return self._open(uri, self._model.documents[0])

    def _declare(self) -> None:
        """Lets notations declare unknown elements, imported documents first."""
        # Imported ones first, or two documents would declare the same name as new.
        for document in in_order_of_import(self._written):
            if document not in self._written or document.lacks_imports:
                continue  # what looks new may stand in the document that is missing
            known = KnownNames(self._model, self._names, document)
            nodes, faults = self._written[document].declare(known)
            self._add_roots(document, nodes, faults)
            # What was just declared must be found by the documents that import this one.
            self._names.forget(document)
