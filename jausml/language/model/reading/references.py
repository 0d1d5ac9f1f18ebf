"""Resolution of references once all documents are built, by place and by name.

What a document can refer to, so that a notation declares what nobody else knows, is asked here too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches
from itertools import islice

from jausml.language.metamodel import FeatureKind, Metamodels
from jausml.language.metamodel.classes import jaus
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.metamodel.filling import holds, link, point
from jausml.language.model.diagnostics import ReadFault, Related
from jausml.language.model.documents import Document
from jausml.language.model.model import Model
from jausml.language.model.names import (
    NameFinder,
    depth,
    library_codes,
    qualified_name,
    with_owners,
)
from jausml.language.model.notation import Explanation
from jausml.language.model.reading.classes import target_class
from jausml.language.model.reading.elements import Mention, Reference
from jausml.language.model.reading.library_cache import NotShareableError
from jausml.language.model.reading.problems import ReadingProblems
from jausml.language.model.refs import Found, FragmentFinder
from jausml.language.model.values import show
from jausml.language.model.xmi.parsing import Node

Explain = Callable[[Document, str, str], Explanation]
"""Tells why a document may know no element of a class by a name."""

_FEW = 6


class NameResolution:
    """Finds the elements that references by name mean."""

    def __init__(self, names: NameFinder, problems: ReadingProblems, explain: Explain) -> None:
        self._names = names
        self._problems = problems
        self._explain = explain
        self._suggestions = 0

    def target(self, reference: Reference) -> EObject | None:
        """Returns the element, None when a finding explains why there is none."""
        document = reference.place.document
        wanted = target_class(reference.feature)
        elements = self._names.find(reference.name, wanted, document, reference.owner)
        if len(elements) == 1:
            return elements[0]
        if elements:
            self._report_ambiguous(reference, elements)
        # With an import missing, the name may stand there: the import alone is reported.
        elif not document.lacks_imports:
            self._report_unknown(reference)
        return None

    def _report_ambiguous(self, reference: Reference, elements: list[EObject]) -> None:
        names = [self._names.label(element) for element in elements]
        more = f" and {len(names) - _FEW} more" if len(names) > _FEW else ""
        self._problems.report(
            "JML216",
            reference.place,
            f"{show(reference.name)} may be {', '.join(names[:_FEW])}{more}",
            self._names.how_to_choose(elements, reference.place.document),
            tuple(
                Related(self._names.location(element), qualified_name(element))
                for element in elements[:_FEW]
            ),
        )

    def _report_unknown(self, reference: Reference) -> None:
        kind = reference.feature.type_name
        message = f"unknown name {show(reference.name)}: there is no such {kind}"
        self._problems.report("JML215", reference.place, message, self._hint(reference))

    def _hint(self, reference: Reference) -> str:
        """Returns a likely target, for the first few: each costs a walk over all names."""
        document = reference.place.document
        for other in self._names.others(reference.name, document):
            kind = self._names.kind(other)
            return f"{show(reference.name)} is a {kind} ({self._names.location(other)})"
        self._suggestions += 1
        if self._suggestions > _FEW_SUGGESTIONS:
            return ""
        wanted = target_class(reference.feature)
        explanation = self._explain(document, wanted.qualified_name, reference.name)
        # Similar names would lead away from an explanation that is certain.
        if explanation.is_certain:
            return explanation.hint
        near = self._names.alike(reference.name, wanted, document)
        meant = f"did you mean {' or '.join(map(show, near))}?" if near else ""
        return "; ".join(filter(None, (meant, explanation.hint)))


_HEXADECIMAL = 16


class KnownNames:
    """Names that a document can use."""

    def __init__(self, model: Model, names: NameFinder, document: Document) -> None:
        self._model = model
        self._names = names
        self._document = document

    def find(self, qualified_class: str, name: str) -> list[EObject]:
        """Returns the elements of a class that a name means: none, the one, or all it may mean."""
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
    """Returns documents and their imports, each behind the imported ones.

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
            pending += [(dependency, False) for dependency in reversed(document.imports)]
    return list(done)


Open = Callable[[str, Document], "Document | ReadFault"]
"""Opens the document that a URI names, seen from another document."""

_FEW_RELATED = 10
_FEW_SUGGESTIONS = 50
_DEEPEST = 100
_ENDLESS = f"leads back to itself, or through more than {_DEEPEST} elements"


@dataclass(slots=True)
class _Absent:
    """A file that references name in vain, and those references."""

    fault: ReadFault
    references: list[Reference] = field(default_factory=list)


class Resolution:
    """Resolves the references of all documents."""

    def __init__(
        self, model: Model, problems: ReadingProblems, open_document: Open, names: NameResolution
    ) -> None:
        self._model = model
        self._names = names
        self._metamodels: Metamodels = model.metamodels
        self._problems = problems
        self._open = open_document
        self._finder = FragmentFinder(model.metamodels, self._follow)
        self._absent: dict[tuple[str, str], _Absent] = {}
        self._following: set[Node] = set()
        self._circular: set[Node] = set()
        self._suggestions = 0
        self.lost: list[Reference] = []
        """The references that lead to no element, in the order in which they were resolved."""

    def run(self, references: Sequence[Reference | Mention]) -> None:
        """Resolves references, in the order in which they are written.

        Single names wait for those of owners: they are looked for in what these mean.
        """
        waiting: list[Reference] = []
        done = 0
        for done, reference in enumerate(references, 1):  # noqa: B007 - counts for what follows
            if isinstance(reference, Mention):
                self._open(reference.uri, reference.place.document)
            elif reference.name and not reference.feature.many:
                waiting.append(reference)
            else:
                self._resolve(reference)
        # The owners nearer to the root first: what a name means may depend on what owners refer to.
        for reference in sorted(
            waiting, key=lambda deferred_reference: depth(deferred_reference.owner)
        ):
            self._resolve(reference)
        # Resolving may have opened documents, whose references stand behind those that were there.
        for reference in islice(references, done, None):
            if isinstance(reference, Mention):
                self._open(reference.uri, reference.place.document)
            else:
                self._resolve(reference)
        for absent in self._absent.values():
            self._report_absent(absent)

    def _resolve(self, reference: Reference) -> None:
        target = reference.direct or self._target(reference)
        if target is None:
            self._problems.mark_unread(reference.owner, reference.feature.name)
            self.lost.append(reference)
        elif reference.feature.kind is FeatureKind.CONTAINMENT:
            self._contain(reference, target)
        elif reference.feature.kind is FeatureKind.CONTAINER:
            self._check_container(reference, target)
        elif holds(reference.owner, reference.feature, target):
            self._report_repeated(reference)
        elif self._is_of_others(reference, target):
            # A full link would set the opposite, and so change the element for all other models.
            point(reference.owner, reference.feature, target)
        else:
            link(reference.owner, reference.feature, target)

    def _is_of_others(self, reference: Reference, target: EObject) -> bool:
        """Tells whether a target is an element of other models too, which must not change."""
        document = self._model.document_of(target)
        is_shared = document is not None and document.is_shared
        return is_shared and not reference.place.document.is_shared

    def _target(self, reference: Reference) -> EObject | None:
        """Returns the element referred to, None when a finding explains why there is none."""
        document = reference.place.document
        if reference.name:
            return self._names.target(reference)
        if reference.uri:
            opened = self._open(reference.uri, document)
            if isinstance(opened, ReadFault):
                # One finding for each file and cause, however many references name it.
                key = (opened.rule, opened.message)
                self._absent.setdefault(key, _Absent(opened)).references.append(reference)
                return None
            document = opened
        if not document.readable:
            return None
        place = self._finder.find(document, reference.fragment)
        if place is None:
            self._report_unresolved(reference, document)
            return None
        target: EObject | None = place.node.obj
        if place.node in self._circular:
            what = f"{show(reference.fragment)} of {_where(reference)}"
            self._problems.mark_unread(reference.owner, reference.feature.name)
            self._report("JML202", reference, f"reference {what} {_ENDLESS}")
        if target is not None and not self._fits(reference, target):
            return None
        if target is not None and place.by_name:
            message = f"Eclipse cannot resolve {show(reference.fragment)} of {_where(reference)}"
            self._report("JML214", reference, message, f"write {self._model.path_of(target)}")
        return target

    def _follow(self, document: Document, node: Node) -> Found | None:
        """Steps from a child element with an href to the element that it stands for."""
        uri, _, fragment = (node.get("href") or "").strip().partition("#")
        # Reaching a node that is being followed closes a circle; none of these has an element.
        if node in self._following:
            self._circular.add(node)
        if node.obj is not None or node in self._following:
            return None
        if len(self._following) >= _DEEPEST:
            self._circular.add(node)
            return None
        opened = self._open(uri, document) if uri else document
        if isinstance(opened, ReadFault) or not opened.readable:
            return None
        # Marked while it is followed, so that a circle of hrefs ends here and not in the stack.
        self._following.add(node)
        try:
            return self._finder.find(opened, fragment)
        finally:
            self._following.discard(node)

    def _fits(self, reference: Reference, target: EObject) -> bool:
        wanted = reference.feature.target
        actual = self._metamodels.class_of(target)
        if wanted is None or actual in wanted.subtypes:
            return True
        self._report(
            "JML205",
            reference,
            f"{_where(reference)} refers to {_label(target)}, but takes {wanted.qualified_name}",
            f"{show(reference.fragment)} is a {actual.qualified_name}",
        )
        return False

    def _contain(self, reference: Reference, target: EObject) -> None:
        # Containment is stored at the element contained: it would change in the models of others.
        if self._is_of_others(reference, target):
            raise NotShareableError
        container = target.eContainer()
        if container is not None and reference.direct is None:
            self._problems.mark_unread(reference.owner, reference.feature.name)
            self._report(
                "JML207", reference, f"{_label(target)} is already contained in {_label(container)}"
            )
            return
        # An href may lead to an owner, and a tree that contains itself has no end.
        if any(owner is target for owner in with_owners(reference.owner)):
            message = f"{_where(reference)} makes {_label(target)} contain itself"
            self._report("JML206", reference, message)
            self._problems.mark_unread(reference.owner, reference.feature.name)
            return
        link(reference.owner, reference.feature, target)

    def _check_container(self, reference: Reference, target: EObject) -> None:
        """Reports a written owner that is not the actual one: the place of an element decides."""
        if reference.owner.eContainer() is not target:
            self._report(
                "JML207",
                reference,
                f"{_where(reference)} refers to {_label(target)}, which does not contain it",
                "remove the reference: the owner follows from the place in the file",
            )

    def _report_repeated(self, reference: Reference) -> None:
        # With an opposite the other end has already made the reference: both ends may be written.
        opposite = reference.feature.opposite
        if opposite is None:
            what = show(reference.name or reference.fragment)
            message = f"{_where(reference)} lists {what} twice"
            self._report("JML213", reference, message)

    def _report_unresolved(self, reference: Reference, document: Document) -> None:
        what, fragment = show(reference.fragment), reference.fragment
        if fragment in document.ids:  # only `#` before it says that an id with a slash is none
            hint = f"the xmi:id {what} is no path: use another id, without '/' at its beginning"
        else:
            hint = self._similar_id(fragment, document)
        if document is reference.place.document:
            message = f"unresolved reference {what} of {_where(reference)}"
            self._report("JML202", reference, message, hint)
        elif not reference.fragment:
            message = f"{_where(reference)} names the file {document.display}, but no element"
            self._report("JML204", reference, message, "add #/ for its root element")
        else:
            message = f"{document.display} has no element {what} for {_where(reference)}"
            self._report("JML204", reference, message, hint)

    def _similar_id(self, fragment: str, document: Document) -> str:
        """Returns a hint for a misspelt id, for the first few: each costs a walk over all ids."""
        self._suggestions += 1
        if self._suggestions > _FEW_SUGGESTIONS:
            return ""
        known = get_close_matches(fragment, document.ids, n=1, cutoff=0.7)
        return f"did you mean '{known[0]}'?" if known else ""

    def _report_absent(self, absent: _Absent) -> None:
        first, *others = absent.references
        message = absent.fault.message
        if others:
            message += f" ({len(absent.references)} references)"
        related = tuple(
            Related(other.place.location, "referenced here too") for other in others[:_FEW_RELATED]
        )
        fault = absent.fault
        self._problems.report(fault.rule, first.place, message, fault.hint, related)

    def _report(self, rule: str, reference: Reference, message: str, hint: str = "") -> None:
        self._problems.report(rule, reference.place, message, hint)


def _where(reference: Reference) -> str:
    return f"feature '{reference.feature.name}' of {_label(reference.owner)}"


def _label(obj: EObject) -> str:
    name = getattr(obj, "name", None)
    return f"{obj.eClass.name} '{name}'" if name else str(obj.eClass.name)
