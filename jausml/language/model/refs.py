"""Names of elements for those outside of a model: refs, which are exact, and keys, which last.

A ref such as `catvehicle.xmi#//@nodes.0` or `library:/jaus/mobility.xmi#PrimitiveDriver` outlives
the elements that were read. It holds as long as its file is as it was, as it names by position what
has no id. A key (`node:logger`) goes by names, and so lasts when elements are added before it.
"""

from __future__ import annotations

import os
import re
from collections import Counter
from functools import cache
from typing import TYPE_CHECKING
from urllib.parse import quote

from jausml.language.model.library import library_root
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


_PARTING = "%/#![]:"


class Keys:
    """The keys of the elements of a model; `model.made(Keys)` gives them.

    A key is the class of the element and the names of its owners below the root and of itself, as
    in `connection:bridge/velocity`. What has no name stands there by feature and index. Elements of
    other files than the first have the name of their file before theirs.
    """

    def __init__(self, model: Model) -> None:
        self._model = model
        self._steps: dict[EObject, tuple[str, str]] = {}

    def of(self, element: EObject) -> str:
        """Returns the key of an element, its own among those of the model."""
        steps: list[str] = []
        each = element
        while (owner := each.eContainer()) is not None:
            if each not in self._steps:
                self._name(owner)
            steps.append(self._steps[each][each is not element])
            each = owner
        document = self._model.document_of(element)
        if not steps or (document is not None and len(document.root_nodes) > 1):
            steps.append(_escaped(getattr(each, "name", None) or ""))
        names = "/".join(reversed(steps))
        return f"{self._file(document)}{_kind(element)}:{names}"

    def _file(self, document: Document | None) -> str:
        if document is None or document is self._model.documents[0]:
            return ""
        return f"{file_of(document, self._model.documents[0].path.parent)}#"

    def _name(self, owner: EObject) -> None:
        """Finds how all that an element owns is named, itself and before what it owns.

        Itself it shares its name with elements of other classes: the class tells them apart.
        """
        counts: Counter[tuple[str, str]] = Counter()
        for each in self._model.owned(owner):
            name = getattr(each, "name", None)
            word = _escaped(name) if name else each.eContainmentFeature().name
            kind = _kind(each)
            numbers = counts[kind, word], counts["", word]
            counts[kind, word] += 1
            counts["", word] += 1
            self._steps[each] = (
                f"{word}[{numbers[0]}]" if numbers[0] or not name else word,
                f"{word}[{numbers[1]}]" if numbers[1] or not name else word,
            )


def _kind(element: EObject) -> str:
    name = element.eClass.name
    return f"{name[:1].lower()}{name[1:]}"


def _escaped(name: str) -> str:
    """Returns a name without the signs that part keys, and without what cannot be shown."""
    return "".join(
        each
        if each.isprintable() and each not in _PARTING
        else quote(each, safe="", errors="replace")
        for each in name
    )
