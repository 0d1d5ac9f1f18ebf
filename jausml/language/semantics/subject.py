"""Subject of the rules: a model, and which of its elements were read without an error.

What a component provides or where a number points follows from the model, and rules ask for it
again and again. Whoever knows that nothing changes for a while says so by `remembering`.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from functools import wraps
from operator import itemgetter
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from jausml.language.metamodel.classes import jaus, ros
from jausml.language.metamodel.reactive import Answers, Engine
from jausml.language.model.diagnostics import Diagnostic, Severity

if TYPE_CHECKING:
    from jausml.language.metamodel.classes.ecore import EClass, EObject
    from jausml.language.model.model import Model

    AskedT = TypeVar("AskedT", bound=Hashable)
    AnswerT = TypeVar("AnswerT")

ElementT = TypeVar("ElementT", bound="EObject")
Fact = TypeVar("Fact")
OwnerT = TypeVar("OwnerT")
FoundT = TypeVar("FoundT")

_Unread = frozenset[str] | None
"""The features of an element that were not read; None where it may be any of them."""


class Subject:
    """A model as rules see it.

    Features that could not be read have their defaults, which say nothing about the model: rules
    look at elements of which all was read, or say which features they need. So one cause is one
    error, and does not hide what else is wrong. The shipped library stays out of sight, unless
    the user named one of its files.
    """

    def __init__(self, model: Model, diagnostics: Iterable[Diagnostic] = ()) -> None:
        self.model = model
        self._by_class: dict[EClass, list[tuple[int, Any]]] = defaultdict(list)
        self._count = 0
        self._unread: dict[EObject, _Unread] = {}
        self._damaged: set[EObject] = set()
        errors: dict[str, dict[str, _Unread]] = defaultdict(dict)
        for each in diagnostics:
            if each.severity is Severity.ERROR and each.fragment and each.unread != frozenset():
                of_file = errors[each.location.path]
                of_file[each.fragment] = _joined(
                    of_file.get(each.fragment, frozenset()), each.unread
                )
        for document in model.documents:
            is_checked = document.given or not document.is_library
            files_errors = errors.get(document.display, {})
            if is_checked or files_errors:
                self._index(document.roots, files_errors, is_checked=is_checked)

    def _index(
        self, roots: list[EObject], errors: Mapping[str, _Unread], *, is_checked: bool
    ) -> None:
        pending = list(reversed(roots))
        while pending:
            element = pending.pop()
            if is_checked:
                self._by_class[element.eClass].append((self._count, element))
                self._count += 1
            if errors and (fragment := self.model.fragment(element)) in errors:
                self._mark(element, errors[fragment])
            pending.extend(reversed(self.model.owned(element)))

    def _mark(self, element: EObject, unread: _Unread) -> None:
        self._unread[element] = unread
        around: EObject | None = element
        while around is not None:
            self._damaged.add(around)
            around = around.eContainer()

    def take_faults(self, other: Subject, copies: Mapping[EObject, EObject]) -> None:
        """Takes what was not read from another subject, whose elements have copies here."""
        self._unread = {copies.get(each, each): of for each, of in other._unread.items()}
        self._damaged = {copies.get(each, each) for each in other._damaged}

    def elements(self) -> list[EObject]:
        """Returns all elements that are judged, be they read well or not."""
        return [element for of_class in self._by_class.values() for _, element in of_class]

    def instances(self, kind: type[ElementT], needs: Iterable[str] | None = None) -> list[ElementT]:
        """Returns the sound elements of a class and of the classes that specialise it.

        Args:
            needs: The features that a rule cannot do without, where it looks at each of the others
                by itself: of others that were not read it sees the defaults, and what it finds
                there is dropped. By default all features were read.

        Returns:
            The elements in document order.
        """
        subtypes = self.model.metamodels.class_of(kind).subtypes
        found = [pair for table in subtypes for pair in self._by_class.get(table.eclass, ())]
        found.sort(key=itemgetter(0))
        if needs is None or not self._unread:
            return [element for _, element in found if element not in self._unread]
        names = frozenset(needs)
        return [element for _, element in found if self.is_read(element, names)]

    def once(self, find: Callable[..., Fact], *about: Hashable) -> Fact:
        """Returns a fact that several rules need, remembered while there is `remembering`.

        `find`: takes the subject, and what the fact is about.
        """
        engine = _ENGINE.get()
        found: Fact = find(self, *about) if engine is None else engine.ask((find, self, *about))
        return found

    def is_read(self, element: EObject, needs: Iterable[str] | None = None) -> bool:
        """Tells whether features of an element itself were read, all of them by default."""
        unread = self._unread.get(element, frozenset())
        if needs is None or unread is None:
            return element not in self._unread
        return unread.isdisjoint(needs)

    def is_intact(self, *elements: EObject | None) -> bool:
        """Tells whether elements are there and were read without an error, contents included."""
        return all(each is not None and each not in self._damaged for each in elements)

    def severity(self, element: EObject) -> Severity | None:
        """Returns how grave a fault of an element's definition is: a warning in the library.

        The library has the published services as they are. Whoever uses them cannot fix them,
        and the other messages of the service are as good as any.

        Returns:
            Warning, or None where the rule decides.
        """
        return Severity.WARNING if self.model.is_library(element) else None

    def assigned(self, element: EObject, values: Mapping[str, str]) -> str:
        """Returns how the document of an element gives its features values, for a hint."""
        document = self.model.document_of(element)
        is_text = document is not None and document.notation is not None
        form = "{}: {}" if is_text else '{}="{}"'
        return " ".join(form.format(name, value) for name, value in values.items())

    def path(self, element: EObject) -> str:
        """Returns how messages name an element that stands elsewhere."""
        return self.model.element_path(element)

    def systems(
        self, needs: Collection[str] | None = None
    ) -> list[list[jaus.Component | ros.Node]]:
        """Returns the components (bridges included) and nodes that live together.

        They are those of one system; those without a system live together too.
        """
        groups: dict[EObject | None, list[jaus.Component | ros.Node]] = defaultdict(list)
        for component in self.instances(jaus.Component, needs):
            groups[component.eContainer()].append(component)
        for node in self.instances(ros.Node, needs):
            groups[node.eContainer()].append(node)
        return list(groups.values())


def _joined(first: _Unread, second: _Unread) -> _Unread:
    return None if first is None or second is None else first | second


_ENGINE: ContextVar[Answers | Engine | None] = ContextVar("engine", default=None)


@contextmanager
def remembering(engine: Engine | None = None) -> Iterator[None]:
    """Has what is asked within it remembered until its end, in this thread alone.

    `engine`: remembers it, and may know more from before; by default one that ends with it.
    """
    token = _ENGINE.set(Answers() if engine is None else engine)
    try:
        yield
    finally:
        _ENGINE.reset(token)


def remembered(function: Callable[[AskedT], AnswerT]) -> Callable[[AskedT], AnswerT]:
    """Has a function remember its answers while there is `remembering`."""

    @wraps(function)
    def answer(asked: AskedT) -> AnswerT:
        engine = _ENGINE.get()
        if engine is None:
            return function(asked)
        found: AnswerT = engine.ask((function, asked))
        return found

    return answer


class RememberedProperty(Generic[OwnerT, FoundT]):
    """A property that is worked out once.

    The object itself remembers it, unless it is noted what answers read: then they do.
    """

    def __init__(self, find: Callable[[OwnerT], FoundT]) -> None:
        self._find = find
        self.__doc__ = find.__doc__

    def __get__(self, owner: OwnerT, kind: type[OwnerT]) -> FoundT:
        engine = _ENGINE.get()
        found: FoundT
        if isinstance(engine, Engine):
            found = engine.ask((self._find, owner))
        else:
            found = owner.__dict__[self._find.__name__] = self._find(owner)
        return found
