"""Keys of elements: names that last.

A ref (`robot.xmi#//@nodes.0`, see `refs`) names an element exactly, but by position where it has no
id. A key (`node:logger`) names it by names, and so lasts when elements are added before it.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING
from urllib.parse import quote

from jausml.language.model.refs import file_of

if TYPE_CHECKING:
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.documents import Document
    from jausml.language.model.model import Model

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
