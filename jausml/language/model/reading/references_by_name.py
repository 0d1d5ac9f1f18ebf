"""References by name: those that mean nothing or too much are reported, and names are known.

What a document can refer to, so that a notation declares what nobody else knows, is asked here too.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import jaus
from jausml.language.model.diagnostics import Related
from jausml.language.model.documents import Document
from jausml.language.model.names import NameFinder, library_codes, qualified_name
from jausml.language.model.notation import Explanation
from jausml.language.model.reading.classes import target_class
from jausml.language.model.values import show

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.model import Model
    from jausml.language.model.reading.elements import Reference
    from jausml.language.model.reading.problems import Problems


Explain = Callable[[Document, str, str], Explanation]
"""Tells why a document may know no element of a class by a name."""

_FEW = 6
_FEW_SUGGESTIONS = 50


class NameResolution:
    """Finds the elements that references by name mean."""

    def __init__(self, names: NameFinder, problems: Problems, explain: Explain) -> None:
        self._names = names
        self._problems = problems
        self._explain = explain
        self._suggestions = 0

    def target(self, reference: Reference) -> EObject | None:
        """Returns the element, None when a finding explains why there is none."""
        document = reference.place.document
        wanted = target_class(reference.feature)
        found = self._names.find(reference.name, wanted, document, reference.owner)
        if len(found) == 1:
            return found[0]
        if found:
            self._report_ambiguous(reference, found)
        elif not document.lacks_imports:
            self._report_unknown(reference)
        return None

    def _report_ambiguous(self, reference: Reference, found: list[EObject]) -> None:
        names = [self._names.label(each) for each in found]
        more = f" and {len(names) - _FEW} more" if len(names) > _FEW else ""
        self._problems.report(
            "JML216",
            reference.place,
            f"{show(reference.name)} may be {', '.join(names[:_FEW])}{more}",
            self._names.how_to_choose(found, reference.place.document),
            tuple(self._related(each) for each in found[:_FEW]),
        )

    def _related(self, element: EObject) -> Related:
        return Related(self._names.location(element), qualified_name(element))

    def _report_unknown(self, reference: Reference) -> None:
        kind = reference.feature.type_name
        message = f"unknown name {show(reference.name)}: there is no such {kind}"
        self._problems.report("JML215", reference.place, message, self._hint(reference))

    def _hint(self, reference: Reference) -> str:
        """Returns what may be meant, for the first few: each costs a walk over all names."""
        document = reference.place.document
        for other in self._names.others(reference.name, document):
            kind = self._names.kind(other)
            return f"{show(reference.name)} is a {kind} ({self._names.location(other)})"
        self._suggestions += 1
        if self._suggestions > _FEW_SUGGESTIONS:
            return ""
        wanted = target_class(reference.feature)
        explanation = self._explain(document, wanted.qualified_name, reference.name)
        if explanation.is_certain:
            return explanation.hint
        near = self._names.alike(reference.name, wanted, document)
        meant = f"did you mean {' or '.join(map(show, near))}?" if near else ""
        return "; ".join(filter(None, (meant, explanation.hint)))


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
