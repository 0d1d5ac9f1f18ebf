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
from typing import Any, TypeVar

from jausml.language.metamodel.classes import jaus, ros
from jausml.language.metamodel.classes.ecore import EClass, EObject
from jausml.language.model.diagnostics import Diagnostic, Severity
from jausml.language.model.model import Model
from jausml.language.model.names import with_owners

AskedT = TypeVar("AskedT", bound=Hashable)
AnswerT = TypeVar("AnswerT")
ElementT = TypeVar("ElementT", bound=EObject)
Fact = TypeVar("Fact")

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
        for diagnostic in diagnostics:
            if (
                diagnostic.severity is Severity.ERROR
                and diagnostic.fragment
                and diagnostic.unread != frozenset()
            ):
                of_file = errors[diagnostic.location.path]
                of_file[diagnostic.fragment] = _joined(
                    of_file.get(diagnostic.fragment, frozenset()), diagnostic.unread
                )
        for document in model.documents:
            is_checked = document.is_input or not document.is_library
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
        self._damaged.update(with_owners(element))

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
        pairs = [pair for table in subtypes for pair in self._by_class.get(table.eclass, ())]
        # Collected by class, but rules and reports go by the document.
        pairs.sort(key=itemgetter(0))
        if needs is None or not self._unread:
            return [element for _, element in pairs if element not in self._unread]
        names = frozenset(needs)
        return [element for _, element in pairs if self.is_read(element, names)]

    def once(self, find: Callable[..., Fact], *about: Hashable) -> Fact:
        """Returns a fact that several rules need, remembered while there is `remembering`.

        `find`: takes the subject, and what the fact is about.
        """
        answers = _ANSWERS.get()
        fact: Fact = find(self, *about) if answers is None else answers.ask((find, self, *about))
        return fact

    def is_read(self, element: EObject, needs: Iterable[str] | None = None) -> bool:
        """Tells whether features of an element itself were read, all of them by default."""
        if not self._unread:
            return True
        unread = self._unread.get(element, frozenset())
        if needs is None or unread is None:
            return element not in self._unread
        return unread.isdisjoint(needs)

    def is_intact(self, *elements: EObject | None) -> bool:
        """Tells whether elements are there and were read without an error, contents included."""
        return all(element is not None and element not in self._damaged for element in elements)

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


_Call = tuple[Any, ...]
"""A function and what it is called with, all of it hashable."""

_RUNNING = object()


class SelfAskingError(Exception):
    """An answer depends on itself."""

    def __init__(self, call: _Call) -> None:
        name = getattr(call[0], "__qualname__", call[0])
        super().__init__(f"{name} asks for its own answer")


class _Raised:
    """The answer of a call that failed, for all who ask."""

    __slots__ = ("error",)

    def __init__(self, error: Exception) -> None:
        self.error = error


class _Answers:
    """The answers to calls, which stay valid: the model does not change meanwhile."""

    def __init__(self) -> None:
        self._known: dict[_Call, Any] = {}

    def ask(self, call: _Call) -> Any:
        """Returns the answer of a call, which raises what the call raises.

        `SelfAskingError`: it asks for its own answer.
        """
        value = self._known.get(call)
        # None may be an answer, too.
        if value is None and call not in self._known:
            # Marked, so that a call that leads back to itself ends at once.
            self._known[call] = _RUNNING
            try:
                value = call[0](*call[1:])
            except Exception as error:
                value = _Raised(error)
            # An interrupt is no answer: who asks next is to get one.
            except BaseException:
                del self._known[call]
                raise
            self._known[call] = value
        if value is _RUNNING:
            raise SelfAskingError(call)
        if value.__class__ is _Raised:
            # Else the traceback would grow with each who asks.
            raise value.error.with_traceback(None)
        return value


_ANSWERS: ContextVar[_Answers | None] = ContextVar("answers", default=None)


@contextmanager
def remembering() -> Iterator[None]:
    """Remembers answers until the end of the block, in this thread alone."""
    token = _ANSWERS.set(_Answers())
    try:
        yield
    finally:
        _ANSWERS.reset(token)


def remembered(function: Callable[[AskedT], AnswerT]) -> Callable[[AskedT], AnswerT]:
    """Lets a function remember its answers within `remembering`."""

    @wraps(function)
    def answer(asked: AskedT) -> AnswerT:
        answers = _ANSWERS.get()
        if answers is None:
            return function(asked)
        result: AnswerT = answers.ask((function, asked))
        return result

    return answer
