"""A model that stays: copies of the elements that were read, made equal to each next reading.

What was read is new elements each time, and answers on other threads hold it. Who wants to know
what has changed keeps a mirror: its elements are watched (see `metamodel.watching`), and of each
feature that gets another value those who have read it are told. Elements that all models share,
those of the library, are not copied.

An element stays itself where one of its class stands at its place, or has its name. A poor guess
costs time and no truth: the mirror is what was read.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

from jausml.language.metamodel.filling import hang, new_watched, point, set_value, set_values, unset
from jausml.language.metamodel.reactive import Engine, Watch
from jausml.language.metamodel.watching import WATCH, watch_of
from jausml.language.model.model import Model

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from typing import TypeVar

    from jausml.language.metamodel import ClassTable, FeatureTable, Metamodels
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.documents import Document

    ElementT = TypeVar("ElementT", bound=EObject)

_INNER = frozenset(
    (
        *("_internal_id", "_isset", "_container", "_containment_feature", "_eresource"),
        *("listeners", "_eternal_listener", "_inverse_rels", "_staticEClass", "dyn_inst", WATCH),
    )
)
"""What an element has besides its features."""

_NOTHING = object()

# What pyecore holds is private to it.
# ruff: noqa: SLF001


class Mirror(Model):
    """The copies.

    Attributes:
        cells: Who has read which elements there are, by class, and the documents by None.
        copies: The copy of each element that was read last.
        has_moved: Whether elements have come, gone or moved at the last `take`.
    """

    def __init__(self, metamodels: Metamodels, engine: Engine) -> None:
        super().__init__([], metamodels)
        self.cells = Watch(engine)
        self.copies: dict[EObject, EObject] = {}
        self.has_moved = False
        self._engine = engine
        self._roots: dict[tuple[object, ...], list[EObject]] = {}
        self._taken: Model | None = None

    def take(self, model: Model) -> None:
        """Makes it equal to a model that was read, which stays as it is."""
        patches = None if self._taken is None else model.patches_since(self._taken)
        self._taken = model
        self.has_moved = False
        if patches is None:
            self._take_elements(model)
        else:
            for theirs in dict.fromkeys(patches):
                self._make_equal(self.copies[theirs], theirs)
        self._take_documents(model)

    def _take_elements(self, model: Model) -> None:
        former, self._roots, self.copies = self._roots, {}, {}
        pairs: list[tuple[EObject, EObject]] = []
        for document in model.documents:
            if not document.is_shared:
                roots = former.pop(key := _key(document), [])
                self._roots[key] = self._matched(roots, document.roots, pairs)
                self.has_moved |= self._roots[key] != roots
        self.has_moved |= bool(former)
        for ours, theirs in pairs:  # grows: with the elements that these own
            self._match_owned(ours, theirs, pairs)
        for ours, theirs in pairs:
            self._make_equal(ours, theirs)

    def _take_documents(self, model: Model) -> None:
        self._origin = {
            root: (document, node)
            for document in model.documents
            for root, node in zip(self._roots_of(document), document.root_nodes, strict=False)
        }
        former, now = ([_identity(e) for e in each] for each in (self.documents, model.documents))
        if former != now:
            self.cells.touch(None)
            self.has_moved = True
        self.documents = model.documents
        if self.has_moved:
            self._by_class = None

    def _roots_of(self, document: Document) -> list[EObject]:
        return document.roots if document.is_shared else self._roots[_key(document)]

    def instances(self, kind: type[ElementT], *, library: bool = True) -> list[ElementT]:
        """Returns the elements of a class and of the classes that specialise it, in order."""
        self.cells.note(None)
        for table in self.metamodels.class_of(kind).subtypes:
            self.cells.note(table.eclass)
        return super().instances(kind, library=library)

    def elements_of(self, document: Document) -> Iterator[EObject]:
        """Yields the elements of one document, in order."""
        if document.is_shared:
            yield from super().elements_of(document)
            return
        pending = self._roots_of(document)[::-1]
        while pending:
            element = pending.pop()
            yield element
            state = element.__dict__  # whoever asks reads the list of all, and not each owner
            for table in reversed(self.metamodels.class_of(element).contained):
                pending += reversed(_values(table, state.get(table.name)))

    def _matched(
        self,
        ours: Sequence[EObject],
        theirs: Sequence[EObject],
        pairs: list[tuple[EObject, EObject]],
    ) -> list[EObject]:
        """Returns the copies of elements that stand side by side, among those that stood there."""
        if len(ours) == len(theirs) and all(
            one.eClass is other.eClass for one, other in zip(ours, theirs, strict=True)
        ):
            found = list(ours)
        else:
            named: dict[tuple[object, object], list[EObject]] = {}
            for each in reversed(ours):
                named.setdefault(_names(each), []).append(each)
            found = [
                same.pop() if (same := named.get(_names(each))) else self._new(each)
                for each in theirs
            ]
        self.copies.update(zip(theirs, found, strict=True))
        pairs += zip(found, theirs, strict=True)
        return found

    def _new(self, theirs: EObject) -> EObject:
        made: EObject = new_watched(self.metamodels.class_of(theirs), self._engine)
        return made

    def _match_owned(
        self, ours: EObject, theirs: EObject, pairs: list[tuple[EObject, EObject]]
    ) -> None:
        state, other = ours.__dict__, theirs.__dict__
        for table in self.metamodels.class_of(theirs).contained:
            former, held = state.get(table.name), other.get(table.name)
            if former is None and held is None:
                continue
            before = _values(table, former)
            values = self._matched(before, _values(table, held), pairs)
            if before != values:
                self.has_moved = True
                self._set(ours, table, values)
                for each in values:
                    hang(each, ours, table)

    def _make_equal(self, ours: EObject, theirs: EObject) -> None:
        state, other = ours.__dict__, theirs.__dict__
        table = self.metamodels.class_of(theirs)
        for name in (state.keys() | other.keys()) - _not_compared(table):
            former, held = state.get(name, _NOTHING), other.get(name, _NOTHING)
            if former is held:
                continue
            feature = table.features[name]
            if feature.many or feature.is_reference:
                self._make_values_equal(ours, feature, former, held)
            elif held is _NOTHING:
                unset(ours, feature)
                self._touch(ours, name)
            elif not _is_same(former, held):
                set_value(ours, feature, held)
                self._touch(ours, name)
        if state["_isset"].keys() != other["_isset"].keys():
            differing = state["_isset"].keys() ^ other["_isset"].keys()
            state["_isset"] = type(other["_isset"])(other["_isset"])
            for each in differing:
                self._touch(ours, each.name)

    def _make_values_equal(
        self, ours: EObject, table: FeatureTable, former: Any, held: Any
    ) -> None:
        before = _values(table, None if former is _NOTHING else former)
        values = _values(table, None if held is _NOTHING else held)
        if table.is_reference:
            values = [self.copies.get(each, each) for each in values]
        if len(before) != len(values) or not all(map(_is_same, before, values)):
            self._set(ours, table, values)

    def _set(self, ours: EObject, table: FeatureTable, values: list[Any]) -> None:
        unset(ours, table)
        if table.many:
            set_values(ours, table, values)
        elif values:
            point(ours, table, values[0])
        self._touch(ours, table.name)

    def _touch(self, ours: EObject, name: str) -> None:
        watch = watch_of(ours)
        if watch is not None:
            watch.touch(name)


@cache
def _not_compared(table: ClassTable) -> frozenset[str]:
    """Returns what elements of a class hold besides attributes and references."""
    return _INNER.union(each.name for each in table.contained)


def _key(document: Document) -> tuple[object, ...]:
    return document.path, document.is_library, document.given, document.is_xml


def _identity(document: Document) -> object:
    """Returns what tells documents apart: elements that are shared are not copied."""
    return document if document.is_shared else _key(document)


def _names(element: EObject) -> tuple[object, object]:
    return element.eClass, element.__dict__.get("name")


def _values(table: FeatureTable, held: Any) -> list[Any]:
    """Returns the values that an element holds of a feature."""
    if held is None:
        return []
    if table.many:
        return list(held)
    return [] if held._value is None else [held._value]


def _is_same(one: Any, other: Any) -> bool:
    """Tells whether nobody can tell two values apart: of numbers, 0.0 and -0.0 either."""
    if one is other:
        return True
    if type(one) is float:
        return repr(one) == repr(other)
    return type(one) is type(other) and bool(one == other)
