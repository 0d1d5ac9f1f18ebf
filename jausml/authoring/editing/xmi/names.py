"""How an XMI file names elements: fragments and hrefs."""

from __future__ import annotations

import posixpath
from urllib.parse import quote

from jausml.authoring.editing.drafts import Context
from jausml.authoring.editing.reading import is_library
from jausml.authoring.editing.working_copy import ElementCopy
from jausml.language.model import refs
from jausml.language.model.diagnostics import ReadFault
from jausml.language.model.documents import Document
from jausml.language.model.library import LIBRARY_URI, copy_in_project, library_root
from jausml.language.model.refs import FragmentFinder, Ref
from jausml.language.model.uris import UriResolver
from jausml.language.model.xmi.parsing import Node


class Names:
    """The names that one file uses."""

    def __init__(self, context: Context, root: Node) -> None:
        self._context = context
        self._root = root
        self._fragments: dict[ElementCopy, str] | None = None
        self._uris: dict[str, str] = {}
        self._resolver = UriResolver(context.root, allow_outside=False, projects={})
        self._finder = FragmentFinder(context.model.metamodels, lambda *_: None)

    def target(self, uri: str, fragment: str) -> ElementCopy | Ref | None:
        """Returns the target of an href or a fragment of the file; None when there is none."""
        document = self._document(uri)
        match = self._finder.find(document, fragment) if document is not None else None
        obj = match.node.obj if match is not None else None
        if obj is None:
            return None
        known = self._context.working_copy.copies.get(obj)
        return known or refs.ref_of(obj, self._context.model, self._context.root)

    def fragment(self, target: ElementCopy | Ref) -> str:
        """Returns the fragment of an element, as it will be."""
        if not isinstance(target, ElementCopy):
            return refs.split(target)[1]
        if self._fragments is None:
            self._fragments = self._context.working_copy.fragments()
        return self._fragments[target]

    def is_local(self, target: ElementCopy | Ref) -> bool:
        """Tells whether an element will stand in the file."""
        return file_of(target) == self._context.file

    def href(self, target: ElementCopy | Ref) -> str:
        """Returns the href of an element, as it will be."""
        uri = "" if self.is_local(target) else self._uri(file_of(target))
        return f"{uri}#{self.fragment(target)}"

    def _document(self, uri: str) -> Document | None:
        context = self._context
        if not uri:
            return context.document
        target = self._resolver.resolve(uri, context.document)
        if isinstance(target, ReadFault):
            return None
        known = (document for document in context.model.documents if document.path == target.path)
        return next(known, None)

    def _uri(self, file: str) -> str:
        """Returns the URI of another file: as this one writes it already, else the writer's."""
        if not self._uris:
            self._uris = {"": "", **self._written_uris()}
        return self._uris.get(file) or self._usual_uri(file)

    def _written_uris(self) -> dict[str, str]:
        uris_by_file: dict[str, str] = {}
        seen: set[str] = set()
        pending = [self._root]
        while pending:
            node = pending.pop()
            pending += node.children
            uri = (node.get("href") or "").strip().partition("#")[0]
            if uri and uri not in seen:
                seen.add(uri)
                document = self._document(uri)
                if document is not None:
                    uris_by_file.setdefault(refs.file_of(document, self._context.root), uri)
        return uris_by_file

    def _usual_uri(self, file: str) -> str:
        context = self._context
        if not is_library(file):
            here = posixpath.dirname(context.file)
            return quote(posixpath.relpath(file, here or "."))
        place = file.removeprefix(refs.LIBRARY)
        library = library_root().resolve()
        folder = (context.root / context.file).parent
        if folder.is_relative_to(library.parent):
            # As the writer does it: the shipped models name each other by paths.
            whole = (library / place).as_posix()
            return quote(posixpath.relpath(whole, folder.as_posix()))
        copy = copy_in_project(place, folder, context.root)
        if copy is not None:
            return quote(posixpath.relpath(copy.as_posix(), folder.as_posix()))
        return f"{LIBRARY_URI}{quote(place)}"


def file_of(target: ElementCopy | Ref) -> str:
    """Returns the file in which an element will stand."""
    return target.root.file if isinstance(target, ElementCopy) else refs.split(target)[0]
