"""Writer of models as XMI 2.0, byte for byte as EMF saves them.

Text has no ids: `name_identifiers` gives some to what others refer to, so that references last.
What Eclipse saves again is then what stands in the file already, so that edits show as small
differences: attributes in the order of the metamodel, values that equal their default left out,
`xsi:type` only where the class is not that of the feature, numbers as Java prints them.
"""

from __future__ import annotations

import math
import os
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, cast
from urllib.parse import quote

from jausml.language.metamodel import (
    ClassTable,
    DataTypeTable,
    FeatureKind,
    FeatureTable,
    ValueKind,
)
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.metamodel.filling import count, is_set
from jausml.language.model.files import replace_file
from jausml.language.model.library import LIBRARY_URI, library_root
from jausml.language.model.model import Model
from jausml.language.model.names import name_of
from jausml.language.model.xmi.printing import DocumentPrinter, UnwritableError

# Other texts mean something else, or nothing, where references stand side by side.
_REFERABLE = re.compile(r"[^\s/#:?%][^\s#:?%]*")


def to_xmi(roots: Sequence[EObject], model: Model, path: str | os.PathLike[str]) -> str:
    """Returns root elements with all that they own as an XMI document.

    Args:
        roots: The root elements of the document. Several are written inside `xmi:XMI`.
        path: The file that the text is meant for. Hrefs to other documents are relative to it;
            the library is named by its URI, but by a path in the shipped models themselves.

    Raises:
        UnwritableError: A text has a character that XML cannot hold, or a reference leads to an
            element that neither the roots nor a document of the model own.
    """
    return _DocumentWriter(roots, model, Path(path)).text()


def write_model(roots: Sequence[EObject], model: Model, path: str | os.PathLike[str]) -> None:
    """Writes root elements to a file, which is either old or new at any moment."""
    replace_file(Path(path), to_xmi(roots, model, path).encode("utf-8"))


class _DocumentWriter(DocumentPrinter["EObject"]):
    """Writes one document of a model."""

    def __init__(self, roots: Sequence[EObject], model: Model, path: Path) -> None:
        super().__init__(model.metamodels)
        self._roots = list(roots)
        self._model = model
        self._home = model.document_of(self._roots[0]) if self._roots else None
        self._folder = Path(os.path.realpath(path)).parent
        self._fragments: dict[EObject, str] = {}
        self._identifiers: set[str] = set()

    def text(self) -> str:
        several = len(self._roots) != 1
        for position, root in enumerate(self._roots):
            self._name_fragments(root, f"/{position}" if several else "/")
        lines = self.lines_of_document(self._roots, is_wrapped=several)
        return "\n".join(['<?xml version="1.0" encoding="UTF-8"?>', *lines, ""])

    def _name_fragments(self, root: EObject, path: str) -> None:
        """Notes the fragments of an element and its parts: id, else path."""
        pending = [(root, path)]
        while pending:
            obj, at = pending.pop()
            identifier = self._model.identifier(obj) or self._identifying_value(obj)
            # A fragment must mean one element, so of equal ids only the first is one.
            is_free = identifier not in self._identifiers and _REFERABLE.fullmatch(identifier or "")
            self._fragments[obj] = identifier if identifier and is_free else at
            self._identifiers.add(identifier or "")
            for feature in self.table_of(obj).features.values():
                if feature.kind is FeatureKind.CONTAINMENT and count(obj, feature):
                    value = getattr(obj, feature.name)
                    steps = [(value, f"{at}/@{feature.name}")]
                    if feature.many:
                        steps = [
                            (element, f"{at}/@{feature.name}.{index}")
                            for index, element in enumerate(value)
                        ]
                    # Elements of other documents are written there, and referred to by href.
                    pending += [step for step in reversed(steps) if not self.is_apart(step[0])]

    def table_of(self, element: EObject) -> ClassTable:
        return self.metamodels.class_of(element)

    def fragment_of(self, target: EObject) -> str | None:
        return self._fragments.get(target)

    def is_apart(self, element: EObject) -> bool:
        document = self._model.document_of(element)
        if document is None or document is self._home:
            return False
        return document.root_position(element) is not None

    def _identifying_value(self, obj: EObject) -> str | None:
        """Returns the value of the attribute that identifies an element, None without one."""
        feature = self.table_of(obj).id_feature
        value = getattr(obj, feature.name) if feature is not None else None
        return str(value) if value is not None else None

    def identifier_of(self, element: EObject) -> str | None:
        identifier = self._model.identifier(element)
        # An id that an attribute gives already is not written a second time as xmi:id.
        return identifier if identifier != self._identifying_value(element) else None

    def values_of(self, element: EObject, feature: FeatureTable) -> Sequence[str | None]:
        if not is_written(element, feature):
            return ()
        value = getattr(element, feature.name)
        values = value if feature.many else [value]
        return [None if inner is None else lexical(inner, feature) for inner in values]

    def targets_of(self, element: EObject, feature: FeatureTable) -> Sequence[EObject]:
        if feature.kind is FeatureKind.CONTAINER or not is_written(element, feature):
            return ()
        value = getattr(element, feature.name)
        return list(value) if feature.many else [value]

    def href_of(self, target: EObject) -> str:
        if target in self._fragments:
            return f"#{self._fragments[target]}"
        return external_href(target, self._model, self._folder)


def external_href(target: EObject, model: Model, folder: Path) -> str:
    """Returns the URI and fragment by which files name an element of another document.

    Args:
        folder: The folder of the file, symbolic links followed. Within the shipped models, the
            library is named by a path.
    """
    document = model.document_of(target)
    fragment = model.fragment(target)
    if document is None or not fragment:
        name = getattr(target, "name", None) or target.eClass.name
        raise UnwritableError(f"'{name}' is referred to, but stands in no document")
    library = Path(os.path.realpath(library_root()))
    # In the shipped models themselves the library has no URI yet: they are the library.
    if document.is_library and not folder.is_relative_to(library.parent):
        place = document.path.relative_to(library).as_posix()
        return f"{LIBRARY_URI}{quote(place)}#{fragment}"
    place = Path(os.path.relpath(document.path, folder)).as_posix()
    return f"{quote(place)}#{fragment}"


def is_written(obj: EObject, feature: FeatureTable) -> bool:
    """Tells whether a feature must be written: reading without it would not yield its value."""
    if feature.many:
        return count(obj, feature) > 0
    # EMF writes an unsettable feature that was set, even to its default.
    if feature.unsettable:
        return is_set(obj, feature)
    return _differs(getattr(obj, feature.name), feature.default)


def _differs(value: Any, default: Any) -> bool:
    if isinstance(value, float) and isinstance(default, float):
        # As Java compares doubles: NaN is itself, and 0.0 is not -0.0.
        return java_double(value) != java_double(default)
    return bool(value != default)


def lexical(value: Any, feature: FeatureTable) -> str:
    """Returns a value of an attribute as EMF writes it."""
    kind = cast("DataTypeTable", feature.data_type).kind
    if kind is ValueKind.ENUMERATION:
        return str(value.literal or value.name) if hasattr(value, "name") else str(value)
    if kind is ValueKind.BOOLEAN:
        return "true" if value else "false"
    if kind is ValueKind.REAL:
        return java_double(float(value))
    return str(value)


def java_double(value: float) -> str:
    """Returns a number as Java's `Double.toString` and so EMF writes it."""
    if math.isnan(value):
        return "NaN"
    if math.isinf(value):
        return "Infinity" if value > 0 else "-Infinity"
    if value == 0 or 1e-3 <= abs(value) < 1e7:
        text = repr(value)
        if "e" not in text:
            return text
    mantissa, _, exponent = f"{value!r}".partition("e")
    sign = "-" if mantissa.startswith("-") else ""
    whole, _, fraction = mantissa.lstrip("-").partition(".")
    digits = (whole + fraction).lstrip("0")
    point = int(exponent or 0) + len(whole) - (len(whole + fraction) - len(digits))
    digits = digits.rstrip("0")
    return f"{sign}{digits[0]}.{digits[1:] or '0'}E{point - 1}"


_LEGAL = re.compile(r"[A-Za-z_][A-Za-z0-9_.\-]*")


def name_identifiers(roots: Sequence[EObject], model: Model) -> None:
    """Gives ids to the elements that are referred to, or are likely to be from other files.

    An id is the name of the element; for messages with their service (`Winch.LockBrake`), and for
    names that occur twice with all owners but the root. Elements that have an id keep it, and so do
    elements for which there is none: they are referred to by position.
    """
    elements = list(_elements(roots, model))
    referred = {target for obj in elements for target in _targets(obj, model)}
    named = [
        element
        for element in elements
        if name_of(element) and (element in referred or _is_public(element))
    ]
    names = Counter(map(name_of, named))
    taken = {model.identifier(element) for element in elements}
    for element in named:
        is_message = isinstance(element, jaus.MessageDef)
        identifier = (
            _path(element) if is_message or names[name_of(element)] > 1 else name_of(element)
        )
        if _LEGAL.fullmatch(identifier) and identifier not in taken:
            model.name_by_id(element, identifier)
            taken.add(identifier)


def _elements(roots: Sequence[EObject], model: Model) -> Iterator[EObject]:
    pending = list(reversed(roots))
    while pending:
        obj = pending.pop()
        yield obj
        pending += reversed(model.owned(obj))


def _targets(obj: EObject, model: Model) -> Iterator[EObject]:
    for feature in model.metamodels.class_of(obj).features.values():
        if feature.kind is FeatureKind.CROSS_REFERENCE and count(obj, feature):
            value = getattr(obj, feature.name)
            yield from value if feature.many else [value]


def _is_public(obj: EObject) -> bool:
    """Tells whether an element is of a class that other files refer to."""
    kinds = (
        *(jaus.Service, jaus.MessageDef, jaus.Component),
        *(ros.MessageType, ros.ServiceType, bridge.AttributeMap),
    )
    return isinstance(obj, kinds)


def _path(obj: EObject) -> str:
    """Returns the names that lead to an element from its root, which is left out."""
    steps: list[str] = []
    while (owner := obj.eContainer()) is not None:
        steps.append(name_of(obj))
        obj = owner
    return ".".join(reversed([step for step in steps if step]))
