"""Elements by the texts that name them: `<file>#<fragment>`, valid while nothing changes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from threading import Lock
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.model import library_root, read_models, refs
from jausml.language.model.names import name_of
from jausml.language.semantics.ros_paths import ros_name
from jausml.language.text.notation import NOTATIONS

if TYPE_CHECKING:
    from pathlib import Path

    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model import Document, Model


class AnswerError(Exception):
    """A question that has no answer, in words for people."""


@dataclass(frozen=True)
class Scope:
    """A model as answers see it."""

    model: Model
    root: Path
    others: tuple[Model, ...] = ()

    def ref(self, element: EObject | None) -> str:
        """Returns the text that names an element, empty for none and for what was not read."""
        for each in (self.model, *self.others):
            if found := refs.ref_of(element, each, self._top):
                return found
        return refs.ref_of(element, library(), self._top)

    def find(self, ref: str) -> EObject:
        """Returns the element of a text, which may be one of the library that nobody uses yet."""
        found = refs.find(ref, self.model, self._top)
        if found is None and ref.startswith(refs.LIBRARY):
            found = refs.find(ref, library(), self._top)
        if found is not None:
            return found
        raise AnswerError(f"there is no element {ref!a} any more")

    def model_of(self, element: EObject) -> Model:
        """Returns the model that has an element: this one, or that of the library."""
        return self.model if self.model.document_of(element) is not None else library()

    def find_in(self, document: Document, fragment: str) -> EObject:
        """Returns the element of a fragment in a document."""
        return self.find(f"{refs.file_of(document, self._top)}#{fragment}")

    @cached_property
    def _top(self) -> Path:
        return self.root.resolve()

    @property
    def file(self) -> str:
        """The file that was asked for."""
        return refs.file_of(self.model.documents[0], self._top)

    @property
    def is_text(self) -> bool:
        """Whether the file that was asked for is text and no XMI."""
        return self.model.documents[0].notation is not None


_READING = Lock()


def library() -> Model:
    """Returns the whole shipped library, read at the first call; all threads get the same."""
    with _READING:
        return _library()


@cache
def _library() -> Model:
    folder = library_root()
    suffixes = (".xmi", *(suffix for each in NOTATIONS for suffix in each.suffixes))
    paths = sorted(each for each in folder.rglob("*") if each.name.endswith(suffixes))
    return read_models(paths, project_root=folder, notations=NOTATIONS).model


def map_around(element: EObject | None) -> bridge.AttributeMap | None:
    """Returns the map that an element is or stands in, None without one."""
    while element is not None and not isinstance(element, bridge.AttributeMap):
        element = element.eContainer()
    return element


def label_of(element: EObject) -> str:
    """Returns how people name an element."""
    if isinstance(element, ros.MessageType | ros.ServiceType | ros.ActionType):
        return ros_name(element)
    owner = element.eContainer()
    if isinstance(element, jaus.MessageDef) and owner is not None:
        return f"{name_of(owner)}.{name_of(element)}"
    return name_of(element) or _by_what_it_says(element)


def _by_what_it_says(element: EObject) -> str:
    if isinstance(element, jaus.Transition):
        message = element.message
        trigger = name_of(message) if message is not None else element.event or "anything else"
        return f"{trigger} to {element.target}" if element.target else trigger
    target, source = getattr(element, "target", None), getattr(element, "source", None)
    if isinstance(target, str):
        return f"{source} -> {target}" if isinstance(source, str) else target
    return element.eClass.name
