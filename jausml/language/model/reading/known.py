"""Names known around a document, for notations that declare what nobody knows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import jaus
from jausml.language.model.names import NameFinder, library_codes

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.documents import Document
    from jausml.language.model.model import Model

_HEXADECIMAL = 16


class KnownNames:
    """Names that a document can use, as `jausml.language.model.notation.Known` says."""

    def __init__(self, model: Model, names: NameFinder, document: Document) -> None:
        self._model = model
        self._names = names
        self._document = document

    def find(self, qualified_class: str, name: str) -> list[EObject]:
        """Returns the elements of a class that a name means in the document."""
        wanted = self._model.metamodels.classes[qualified_class]
        return self._names.find(name, wanted, self._document, None)

    def alike(self, qualified_class: str, name: str) -> list[str]:
        """Returns known names of a class that are much like a name, the nearest first."""
        wanted = self._model.metamodels.classes[qualified_class]
        return self._names.alike(name, wanted, self._document)

    def message_codes(self) -> set[int]:
        """Returns the codes of the messages of the document, its imports and the library."""
        codes = set(library_codes())
        for document in in_order_of_import([self._document]):
            for element in self._model.elements_of(document):
                if isinstance(element, jaus.MessageDef) and element.code:
                    codes.add(int(element.code, _HEXADECIMAL))
        return codes


def in_order_of_import(documents: Iterable[Document]) -> list[Document]:
    """Returns documents and all that they import, each behind those that it imports.

    Documents that import each other stand in the order in which they are reached.
    """
    done: dict[Document, None] = {}
    seen: set[Document] = set()
    # Without recursion: a chain of imports may be long.
    pending = [(document, False) for document in reversed(list(documents))]
    while pending:
        document, is_ready = pending.pop()
        if is_ready:
            done[document] = None
        elif document not in seen:
            seen.add(document)
            pending.append((document, True))
            pending += [(each, False) for each in reversed(document.imports)]
    return list(done)
