"""Resolution of references by name; names that mean nothing or too much are reported."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from jausml.language.model.diagnostics import Related
from jausml.language.model.documents import Document
from jausml.language.model.names import NameFinder, qualified_name
from jausml.language.model.notation import Explanation
from jausml.language.model.reading.classes import target_class
from jausml.language.model.values import show

if TYPE_CHECKING:
    from jausml.language.metamodel.classes.ecore import EObject
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
            self._names.how_to_choose(found),
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
