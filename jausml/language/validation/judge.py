"""A judge that stays: of each next reading of a model it runs only what read what has changed.

It has a model of its own, a mirror of what was read, whose elements note who reads them. What it
finds stays as findings at elements, since lines move with each edit; where they stand in what was
read is looked up last. Its verdicts are those of `engine.check`.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from itertools import chain, count
from typing import TYPE_CHECKING

from jausml.language.metamodel.reactive import Engine, Node
from jausml.language.metamodel.watching import note, watch_of
from jausml.language.model.diagnostics import Severity
from jausml.language.model.mirror import Mirror
from jausml.language.model.model import without_collector
from jausml.language.semantics.subject import Subject, remembering
from jausml.language.validation.engine import (
    Judging,
    found_at,
    found_in_whole,
    read_well,
    reported,
)
from jausml.language.validation.rules import all_rules

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from typing import TypeVar

    from jausml.language.metamodel import Metamodels
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model import ReadResult
    from jausml.language.validation.rule import Finding, Report, Rule

    ElementT = TypeVar("ElementT", bound=EObject)

    Found = list[tuple[Rule, Finding]]


class Judge:
    """Verdicts on one model, one after the other; by one thread at a time."""

    def __init__(self, rules: Sequence[Rule] | None = None) -> None:
        self._rules = all_rules() if rules is None else rules
        self._standing: _Standing | None = None

    @property
    def runs(self) -> int:
        """How many answers have been worked out so far."""
        return 0 if self._standing is None else self._standing.engine.runs

    def report(self, result: ReadResult) -> Report:
        """Returns what `check` returns of a model that was read.

        `RuleError`: a rule failed.
        """
        metamodels = result.model.metamodels
        if self._standing is None or self._standing.mirror.metamodels is not metamodels:
            self._standing = _Standing(self._rules, metamodels)
        with without_collector(), remembering(self._standing.engine):
            return self._standing.report(result)


class _Standing:
    """What a judge keeps."""

    def __init__(self, rules: Sequence[Rule], metamodels: Metamodels) -> None:
        self.engine = Engine()
        self.mirror = Mirror(metamodels, self.engine)
        self._rules = rules
        self._judging = Judging(rules, metamodels)
        self._subject = _WatchedSubject(self.mirror)
        self._nodes: dict[EObject, Node] = {}
        self._found: dict[Node, Found] = {}
        wholes = [each for each in rules if each.is_whole]
        nodes = {each: self.engine.keep((found_in_whole, self._subject, each)) for each in wholes}
        self._outward = [node for rule, node in nodes.items() if rule.is_outward]

    def report(self, result: ReadResult) -> Report:
        self.mirror.take(result.model)
        self._subject.take(result)
        if self.mirror.has_moved:
            self._judge_others()
        self.engine.touch(self._outward)
        for node in self.engine.woken():
            found = self.engine.ask(node.call)
            if found:
                self._found[node] = found
            else:
                self._found.pop(node, None)
        self.engine.sweep()
        return self._located(result)

    def _judge_others(self) -> None:
        """Has elements judged that have come, and no longer those that have gone."""
        elements = self._subject.elements()
        gone = self._nodes.keys() - set(elements)
        for element in gone:
            node = self._nodes.pop(element)
            self._found.pop(node, None)
            self.engine.drop(node)
        for element in elements:
            parts = self._judging.of(element)
            if parts and element not in self._nodes:
                self._nodes[element] = self.engine.keep((self._found_at, element))

    def _found_at(self, element: EObject) -> Found:
        return found_at(self._subject, element, self._judging.of(element))

    def _located(self, result: ReadResult) -> Report:
        originals = {ours: theirs for theirs, ours in self.mirror.copies.items()}
        found = [
            (rule, _moved(finding, originals))
            for rule, finding in read_well(self._subject, chain.from_iterable(self._found.values()))
        ]
        return reported(result, self._rules, found)


def _moved(finding: Finding, places: Mapping[EObject, EObject]) -> Finding:
    """Returns a finding at other elements."""
    related = tuple(
        replace(each, element=places.get(each.element, each.element)) for each in finding.related
    )
    return replace(finding, element=places.get(finding.element, finding.element), related=related)


class _WatchedSubject(Subject):
    """A subject that notes who asks for which elements, and whether they were read."""

    def __init__(self, mirror: Mirror) -> None:
        super().__init__(mirror)
        self._mirror = mirror

    def take(self, result: ReadResult) -> None:
        """Takes what the mirror has taken."""
        if self._mirror.has_moved:
            self._list_elements()
        self._take_errors(result)

    def _list_elements(self) -> None:
        former, self._by_class = self._by_class, defaultdict(list)
        numbers = count()
        for document in self._mirror.documents:
            if document.given or not document.is_library:
                for element in self._mirror.elements_of(document):
                    self._by_class[element.eClass].append((next(numbers), element))
        for eclass in former.keys() | self._by_class.keys():
            pairs = former.get(eclass, ()), self._by_class.get(eclass, ())
            before, now = ([element for _, element in each] for each in pairs)
            if before != now:
                self._mirror.cells.touch(eclass)

    def _take_errors(self, result: ReadResult) -> None:
        unread, damaged = self._unread, self._damaged
        self._unread, self._damaged = {}, set()
        if any(each.severity is Severity.ERROR for each in result.diagnostics):
            self.take_faults(Subject(result.model, result.diagnostics), self._mirror.copies)
        for element in unread.keys() | self._unread.keys():
            if unread.get(element, _WHOLE) != self._unread.get(element, _WHOLE):
                self._mirror.cells.touch(element.eClass)
                _touch(element, _READ)
        for element in damaged ^ self._damaged:
            _touch(element, _INTACT)

    def instances(self, kind: type[ElementT], needs: Iterable[str] | None = None) -> list[ElementT]:
        for table in self.model.metamodels.class_of(kind).subtypes:
            self._mirror.cells.note(table.eclass)
        return super().instances(kind, needs)

    def is_read(self, element: EObject, needs: Iterable[str] | None = None) -> bool:
        note(element, _READ)
        return super().is_read(element, needs)

    def is_intact(self, *elements: EObject | None) -> bool:
        for each in elements:
            note(each, _INTACT)
        return super().is_intact(*elements)


_READ, _INTACT = "is read", "is intact"
"""What is noted of elements beside their features, whose names have no spaces."""

_WHOLE = frozenset[str]()


def _touch(element: EObject, name: str) -> None:
    watch = watch_of(element)
    if watch is not None:
        watch.touch(name)
