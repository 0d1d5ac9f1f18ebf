"""Names of elements for those outside of a model: a file, and a fragment within it.

A ref such as `catvehicle.xmi#//@nodes.0` or `library:/jaus/mobility.xmi#PrimitiveDriver` outlives
the elements that were read. It holds as long as its file is as it was.
"""

from __future__ import annotations

import os
import re
from functools import cache
from typing import TYPE_CHECKING

from jausml.language.model.uris import library_root
from jausml.language.model.xmi.fragments import FragmentFinder

if TYPE_CHECKING:
    from pathlib import Path

    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.documents import Document
    from jausml.language.model.model import Model

Ref = str
"""`<file>#<fragment>`: the file relative to a root with forward slashes, or of the library."""

LIBRARY = "library:/"
"""What the files of the shipped library begin with."""

_REFERABLE = re.compile(r"[^\s/#:?%][^\s#:?%]*")


def file_of(document: Document, root: Path) -> str:
    """Returns how refs name the file of a document.

    Args:
        root: The folder that files are relative to, symbolic links followed. A file that lies
            elsewhere is named by its whole path.
    """
    if document.is_library:
        return LIBRARY + document.path.relative_to(_library()).as_posix()
    if document.path.is_relative_to(root):
        return document.path.relative_to(root).as_posix()
    return document.path.as_posix()


def ref_of(obj: EObject | None, model: Model, root: Path) -> Ref:
    """Returns the ref of an element, empty for one that was not read."""
    document = model.document_of(obj)
    if obj is None or document is None:
        return ""
    fragment = fragment_of(obj, document, model)
    return f"{file_of(document, root)}#{fragment}" if fragment else ""


def fragment_of(obj: EObject, document: Document, model: Model) -> str:
    """Returns the fragment that finds an element again: its id if that is usable, else its path."""
    identifier = model.identifier(obj)
    if identifier and _REFERABLE.fullmatch(identifier):
        node = document.ids.get(identifier)
        if node is not None and node.obj is obj:
            return identifier
    return model.path_of(obj)


def split(ref: Ref) -> tuple[str, str]:
    """Returns file and fragment of a ref."""
    file, _, fragment = ref.rpartition("#")
    return file, fragment


def find(ref: Ref, model: Model, root: Path) -> EObject | None:
    """Returns the element that a ref names, None when the model has none."""
    file, fragment = split(ref)
    for document in model.documents:
        if fragment and document.readable and file_of(document, root) == file:
            finder = FragmentFinder(model.metamodels, lambda *_: None)
            found = finder.find(document, fragment)
            return found.node.obj if found is not None else None
    return None


@cache
def _library() -> str:
    return os.path.realpath(library_root())
