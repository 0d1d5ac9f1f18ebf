"""Names of elements for those outside of a model: refs, which are exact, and keys, which last.

A ref such as `catvehicle.xmi#//@nodes.0` or `library:/jaus/mobility.xmi#PrimitiveDriver` outlives
the elements that were read. It holds as long as its file is as it was, as it names by position what
has no id. A key (`node:logger`) goes by names, and so lasts when elements are added before it.

Fragments are followed over XML elements and not over model elements, so that one that passes a
faulty element still counts positions as its author did.
"""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path
from urllib.parse import quote, unquote

from jausml.language.metamodel import FeatureKind, Metamodels
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.documents import Document
from jausml.language.model.library import library_root
from jausml.language.model.model import Model
from jausml.language.model.xmi.parsing import Node

Follow = Callable[[Document, Node], "Found | None"]
"""Steps from a child element with an href to the element of the document that it names."""

_STEP = re.compile(r"@([^\[\].]+)(?:\.([0-9]{1,9})|\[(.*)\])?", re.DOTALL)
_PREDICATE = re.compile(r"\s*([^=,]+?)\s*=\s*(?:'([^']*)'|\"([^\"]*)\")\s*(?:,|$)")


@dataclass(frozen=True, slots=True)
class Found:
    """The element that a fragment names.

    Attributes:
        by_name: True when the fragment uses names, which EMF does not resolve in models.
    """

    document: Document
    node: Node
    by_name: bool = False


class FragmentFinder:
    """Finds elements by fragment."""

    def __init__(self, metamodels: Metamodels, follow: Follow) -> None:
        self._metamodels = metamodels
        self._follow = follow

    def find(self, document: Document, fragment: str) -> Found | None:
        """Finds an element.

        Returns:
            The element, None when there is none.
        """
        fragment = _without_description(fragment)
        if not fragment.startswith("/"):
            node = document.ids.get(fragment) or document.ids.get(unquote(fragment))
            return Found(document, node) if node is not None else None
        _, root_step, *steps = fragment.split("/")
        if root_step and not re.fullmatch("[0-9]{1,9}", root_step):
            return None
        position = int(root_step) if root_step else 0
        if position >= len(document.root_nodes):
            return None
        place: Found | None = Found(document, document.root_nodes[position])
        for step in steps:
            if place is None or place.node.obj is None:
                return place
            place = self._step(place, step)
            if place is not None and place.node.get("href") is not None:
                place = self._follow(place.document, place.node) or place
        return place

    def _step(self, at: Found, step: str) -> Found | None:
        match = _STEP.fullmatch(step)
        if match is None:
            wanted = unquote(step)
            named = [child for child in at.node.children if _matches(child, "name", wanted)]
            return Found(at.document, named[0], by_name=True) if step and named else None
        tag, index, predicate = match.groups()
        feature = self._metamodels.class_of(at.node.obj).features.get(tag)
        indexed = index is not None or predicate is not None
        if feature is not None and (
            feature.kind is not FeatureKind.CONTAINMENT or feature.many != indexed
        ):
            return None
        children = at.document.children(at.node, tag)
        if predicate is not None:
            children = [child for child in children if _holds(child, predicate)]
        position = int(index) if index is not None else 0
        if position >= len(children):
            return None
        return Found(at.document, children[position], at.by_name)


def _without_description(fragment: str) -> str:
    """Drops the description that EMF may add to a fragment as `...?text?`."""
    if len(fragment) > 1 and fragment.endswith("?"):
        start = fragment.rfind("?", 0, -1)
        return fragment[:start] if start > 0 else fragment
    return fragment


def _holds(node: Node, predicate: str) -> bool:
    at = 0
    while match := _PREDICATE.match(predicate, at):
        key, single, double = match.groups()
        if not _matches(node, key, unquote(single if single is not None else double)):
            return False
        at = match.end()
    return at == len(predicate) and at > 0


def _matches(node: Node, key: str, value: str) -> bool:
    written = node.get(key)
    if written is None:
        element = next((child for child in node.children if child.tag == key), None)
        written = element.text if element is not None else None
    return written == value


Ref = str
"""`<file>#<fragment>`: the file relative to a root with forward slashes, or of the library."""

LIBRARY = "library:/"
"""The prefix of the files of the shipped library."""

_REFERABLE = re.compile(r"[^\s/#:?%][^\s#:?%]*")


def file_of(document: Document, root: Path) -> str:
    """Returns how refs name the file of a document.

    Args:
        root: The folder that files are relative to, symbolic links followed. A file that lies
            elsewhere is named by its whole path.
    """
    return _file_of(document.path, root, is_library=document.is_library)


@lru_cache(1024)
def _file_of(path: Path, root: Path, *, is_library: bool) -> str:
    if is_library:
        return LIBRARY + path.relative_to(_library()).as_posix()
    if path.is_relative_to(root):
        return path.relative_to(root).as_posix()
    return path.as_posix()


def file_mark(document: Document | None, model: Model) -> str:
    """Returns what stands before names of elements of a file, empty for the first of a model.

    It is the same on each machine that has the files side by side.
    """
    first = model.documents[0] if model.documents else None
    if document is None or first is None or document is first:
        return ""
    folder = first.path.parent
    if document.is_library:
        return f"{file_of(document, folder)}#"
    return f"{Path(os.path.relpath(document.path, folder)).as_posix()}#"


def ref_of(obj: EObject | None, model: Model, root: Path) -> Ref:
    """Returns the ref of an element, empty for one that was not read."""
    document = model.document_of(obj)
    if obj is None or document is None:
        return ""
    fragment = fragment_of(obj, document, model)
    return f"{file_of(document, root)}#{fragment}" if fragment else ""


def fragment_of(obj: EObject, document: Document, model: Model) -> str:
    """Returns the fragment that finds an element again: its id if usable, else its path."""
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
            place = finder.find(document, fragment)
            return place.node.obj if place is not None else None
    return None


@cache
def _library() -> str:
    return os.path.realpath(library_root())


_PARTING = "%/#![]:"


class Keys:
    """The keys of the elements of a model; `model.derived(Keys)` gives them.

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
        ancestor = element
        while (owner := ancestor.eContainer()) is not None:
            if ancestor not in self._steps:
                self._name(owner)
            steps.append(self._steps[ancestor][ancestor is not element])
            ancestor = owner
        document = self._model.document_of(element)
        if not steps or (document is not None and len(document.root_nodes) > 1):
            steps.append(_escaped(getattr(ancestor, "name", None) or ""))
        names = "/".join(reversed(steps))
        return f"{file_mark(document, self._model)}{_kind(element)}:{names}"

    def _name(self, owner: EObject) -> None:
        """Finds the keys of the parts of an element, and the texts before the keys of their parts.

        Itself it shares its name with elements of other classes: the class tells them apart.
        """
        counts: Counter[tuple[str, str]] = Counter()
        for element in self._model.owned(owner):
            name = getattr(element, "name", None)
            word = _escaped(name) if name else element.eContainmentFeature().name
            kind = _kind(element)
            numbers = counts[kind, word], counts["", word]
            counts[kind, word] += 1
            counts["", word] += 1
            self._steps[element] = (
                f"{word}[{numbers[0]}]" if numbers[0] or not name else word,
                f"{word}[{numbers[1]}]" if numbers[1] or not name else word,
            )


def _kind(element: EObject) -> str:
    name = element.eClass.name
    return f"{name[:1].lower()}{name[1:]}"


def _escaped(name: str) -> str:
    """Returns a name without the signs that part keys, and without what cannot be shown."""
    return "".join(
        character
        if character.isprintable() and character not in _PARTING
        else quote(character, safe="", errors="replace")
        for character in name
    )
