"""Reading again where values alone have changed: the elements that were read get the new ones.

Most edits change a value, and a file is long. Its new nodes are compared with those of before. When
they say the same but for values that nothing else is read by, the elements stay and take these, so
that nothing needs to be built, resolved and compared again. In all other cases it is read anew.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from jausml.language.metamodel import FeatureKind
from jausml.language.metamodel.filling import set_value, unset
from jausml.language.model.documents import Document
from jausml.language.model.inputs import bounded
from jausml.language.model.model import without_collector
from jausml.language.model.names import NameFinder
from jausml.language.model.reading.reader import ReadResult
from jausml.language.model.reading.references import KnownNames
from jausml.language.model.values import convert
from jausml.language.model.xmi.parsing import parse

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from jausml.language.metamodel import ClassTable, DataTypeTable, FeatureTable
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.model import Model
    from jausml.language.model.uris import UriFault
    from jausml.language.model.xmi.parsing import Node

_FOUND_BY = frozenset(("name", "urn", "version"))
"""The features by which elements are found."""

_DEFINITIONS = ("jaus.ServiceSet", "ros.InterfacePackage")
"""The classes of what has messages and types, by which texts are checked as they are read."""


class _AnotherModelError(Exception):
    """More has changed than values."""


def patched(former: ReadResult, path: Path, data: bytes) -> ReadResult | None:
    """Returns the model of files of which one has other bytes than when it was read.

    It has the elements of the former model, which then have the new values there too.

    Returns:
        None where the files have to be read: elements, references or names may be others, a value
        is none of its feature, or something was found in the file. The former model is as it was.
    """
    document = next((each for each in former.model.documents if each.path == path), None)
    if document is None or not _is_sound(document, former):
        return None
    try:
        bounded(data, path)
        with without_collector():
            return _Patch(former, document, data).result()
    except (OSError, _AnotherModelError):
        return None


def _is_sound(document: Document, former: ReadResult) -> bool:
    """Tells whether a document was read without findings, and no other one by what it says."""
    if document.is_shared or not document.readable or former.lost or not former.model.is_latest:
        return False
    if any(document in each.imports for each in former.model.documents):
        return False
    places = (
        place.path
        for each in former.diagnostics
        for place in (each.location, *(note.location for note in each.related))
    )
    return document.display not in places


class _Patch:
    """One file, and what is another value in it."""

    def __init__(self, former: ReadResult, document: Document, data: bytes) -> None:
        self._former = former
        self._before = document
        self._document = _emptied(document, data)
        self._nodes: dict[EObject, Node] = {}
        self._values: list[tuple[Any, FeatureTable, str | None]] = []
        self._model: Model = former.model

    def result(self) -> ReadResult:
        if self._before.is_xml:
            self._parse()
        else:
            self._read_notation()
        values = [(*each[:2], self._converted(*each)) for each in self._values]
        self._document.ids = {
            name: self._nodes[node.obj] for name, node in self._before.ids.items()
        }
        self._model = self._former.model.patched(self._before, self._document, self._nodes)
        self._model.note_patch(self._given(values))
        return ReadResult(self._model, self._former.diagnostics)

    def _given(self, values: list[tuple[Any, FeatureTable, tuple[Any, ...]]]) -> list[EObject]:
        """Gives elements their values; returns those that have others than before."""
        if self._before.is_xml:
            for obj, feature, held in values:
                _give(obj, feature, held)
            return [obj for obj, _, _ in values]
        # A text leaves values open, which follow from others.
        states = {each: _State(each) for each in self._nodes}
        for obj, feature, held in values:
            _give(obj, feature, held)
        try:
            self._settle()
        except _AnotherModelError:
            for state in states.values():
                state.restore()
            raise
        return [each for each, state in states.items() if state.has_changed]

    def _settle(self) -> None:
        """Has a notation declare and check what it has read, which must find nothing."""
        written = self._document.written
        if written is None:
            return
        names = NameFinder(self._model, _not_to_be_opened)
        nodes, faults = written.declare(KnownNames(self._model, names, self._document))
        if nodes or faults or written.check():
            raise _AnotherModelError

    def _parse(self) -> None:
        found = parse(self._document.data)
        if found.root is None or found.encoding != self._before.encoding:
            raise _AnotherModelError
        self._document.encoding = found.encoding
        old = self._before.root_nodes[0]
        is_wrapped = old.parent is not None
        self._compare([(old.parent or old, found.root)])
        self._document.root_nodes = list(found.root.children) if is_wrapped else [found.root]

    def _read_notation(self) -> None:
        notation = self._before.notation
        if notation is None or self._before.written is None:
            raise _AnotherModelError
        written = notation.read(self._document.data, self._before.path, self._metamodels)
        uris = [[each.uri for each in one.imports] for one in (written, self._before.written)]
        if written.faults or uris[0] != uris[1]:
            raise _AnotherModelError
        self._document.written = written
        self._document.root_nodes = list(written.roots)
        if len(written.roots) != len(self._before.root_nodes):
            raise _AnotherModelError  # some were declared
        self._compare(list(zip(self._before.root_nodes, written.roots, strict=True)))

    @property
    def _metamodels(self) -> Any:
        return self._former.model.metamodels

    def _compare(self, pending: list[tuple[Node, Node]]) -> None:
        """Compares nodes and all that they own, and has the new ones stand for the elements."""
        class_of = self._metamodels.class_of
        while pending:
            old, new = pending.pop()
            if old.tag != new.tag or old.namespace != new.namespace:
                raise _AnotherModelError
            if old.prefixes is not new.prefixes and old.prefixes != new.prefixes:
                raise _AnotherModelError
            obj = new.obj = old.obj
            if obj is not None:
                self._nodes[obj] = new
            if _is_alike(old, new):
                pending += [
                    pair
                    for pair in zip(old.children, new.children, strict=True)
                    if pair[0].obj is not None or pair[0].children
                ]
            elif obj is None:
                raise _AnotherModelError
            else:
                pending += self._differing(old, new, class_of(obj))

    def _differing(self, old: Node, new: Node, table: ClassTable) -> list[tuple[Node, Node]]:
        """Notes the values in which an element differs; returns what it owns, in pairs."""
        (before, rest, owned), (now, other, inner) = (_parts(each, table) for each in (old, new))
        if rest != other or len(owned) != len(inner):
            raise _AnotherModelError
        for name in before.keys() | now.keys():
            if before.get(name) != now.get(name):
                self._values.append((old.obj, self._free(old.obj, name, table), now.get(name)))
        pairs = list(zip(owned, inner, strict=True))
        for one, another in pairs:
            if one.obj is None and not (_is_equal(one, another) and one.children == []):
                raise _AnotherModelError
        return [each for each in pairs if each[0].obj is not None]

    def _free(self, obj: EObject, name: str, table: ClassTable) -> FeatureTable:
        """Returns a feature of which nothing but its own value is read."""
        feature = table.features[name]
        if name in _FOUND_BY or feature is table.id_feature or self._is_read_by_others(obj):
            raise _AnotherModelError
        return feature

    def _is_read_by_others(self, obj: EObject) -> bool:
        """Tells whether other texts are checked by what an element defines."""
        others = (each for each in self._former.model.documents if each is not self._before)
        if not any(each.written is not None for each in others):
            return False
        while (owner := obj.eContainer()) is not None:
            obj = owner
        return self._metamodels.class_of(obj).qualified_name in _DEFINITIONS

    def _converted(self, obj: Any, feature: FeatureTable, text: str | None) -> tuple[Any, ...]:
        """Returns a value, or none where none is written."""
        if text is None:
            if feature in self._metamodels.class_of(obj).bounded:
                raise _AnotherModelError
            return ()
        value, fault = convert(text, cast("DataTypeTable", feature.data_type))
        if fault is not None:
            raise _AnotherModelError
        return (value,)


def _not_to_be_opened(_: str) -> Document | UriFault:
    raise _AnotherModelError


class _State:
    """What an element has of its features at a moment."""

    __slots__ = ("_features", "_obj", "_set")

    def __init__(self, obj: Any) -> None:
        self._obj = obj
        self._features = dict(obj.__dict__)
        self._set = tuple(obj._isset)  # noqa: SLF001 - of pyecore

    @property
    def has_changed(self) -> bool:
        """Whether it has something else now."""
        return bool(self._obj.__dict__ != self._features)

    def restore(self) -> None:
        """Gives the element what it had."""
        if self.has_changed:
            self._obj.__dict__.clear()
            self._obj.__dict__.update(self._features)
        for each in [each for each in self._obj._isset if each not in self._set]:  # noqa: SLF001
            del self._obj._isset[each]  # noqa: SLF001


def _emptied(document: Document, data: bytes) -> Document:
    """Returns a document of the same file, with other bytes and without nodes."""
    made = Document(
        document.path, document.display, is_library=document.is_library, given=document.given
    )
    made.data = data
    made.encoding = document.encoding
    made.readable = True
    made.notation = document.notation
    made.imports = document.imports
    made.lacks_imports = document.lacks_imports
    return made


def _give(obj: Any, feature: FeatureTable, values: tuple[Any, ...]) -> None:
    if values:
        set_value(obj, feature, values[0])
    else:
        unset(obj, feature)


def _is_alike(old: Node, new: Node) -> bool:
    """Tells whether nodes say the same by themselves, and by what they hold that is no element."""
    if old.attributes != new.attributes or len(old.children) != len(new.children):
        return False
    if old.text != new.text and (old.text.strip() or new.text.strip()):
        return False
    return all(
        one.obj is not None or _is_equal(one, other)
        for one, other in zip(old.children, new.children, strict=True)
    )


def _is_equal(one: Node, other: Node) -> bool:
    """Tells whether nodes that are no elements say the same, but for what they hold."""
    return one.tag == other.tag and one.text == other.text and one.attributes == other.attributes


def _parts(node: Node, table: ClassTable) -> tuple[dict[str, str], dict[str, str], list[Node]]:
    """Returns the values of an element by their features, its other attributes, and the rest."""
    values: dict[str, str] = {}
    rest: dict[str, str] = {"": node.text.strip()}
    owned: list[Node] = []
    for name, text in zip(node.attributes[::2], node.attributes[1::2], strict=True):
        (values if _is_value(name, table.features) else rest)[name] = text
    for child in node.children:
        if not _is_value(child.tag, table.features):
            owned.append(child)
        elif child.attributes or child.children or child.tag in values:
            raise _AnotherModelError
        else:
            values[child.tag] = child.text
    return values, rest, owned


def _is_value(name: str, features: Mapping[str, FeatureTable]) -> bool:
    feature = features.get(name)
    return (
        feature is not None
        and feature.kind is FeatureKind.ATTRIBUTE
        and feature.settable
        and not feature.many
    )
