"""Property forms and their answers: features of an element by the metamodels, and its values."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from operator import attrgetter

from jausml.authoring.editing.commands import Command
from jausml.authoring.proposals.elements import (
    AnswerError,
    Choice,
    Scope,
    label_of,
    legal_targets,
    literal,
    values_of,
)
from jausml.authoring.proposals.new_elements import usual_values
from jausml.authoring.studio.views.service_lines import usual_texts
from jausml.language.metamodel import (
    ClassTable,
    DataTypeTable,
    FeatureKind,
    FeatureTable,
    ValueKind,
    documentation,
)
from jausml.language.metamodel.classes import bridge
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model import Diagnostic
from jausml.language.model.names import with_owners
from jausml.language.model.refs import LIBRARY
from jausml.language.semantics.names import in_words


@dataclass(frozen=True, slots=True)
class Field:
    """A feature of an element that a form shows.

    Attributes:
        kind: `text`, `multiline`, `number`, `integer`, `boolean`, `choice` or `reference`.
        group: What it is about, above fields that are about the same; empty for what it is.
        values: What is set; empty while the default holds.
        unit: Unit of its number, empty for none or an unknown one.
    """

    feature: str
    label: str
    kind: str
    many: bool
    required: bool
    group: str = ""
    values: tuple[str, ...] = ()
    shown: tuple[str, ...] = ()
    default: str = ""
    documentation: str = ""
    unit: str = ""
    choices: tuple[Choice, ...] = ()
    problems: tuple[str, ...] = ()
    changeable: bool = True


@dataclass(frozen=True, slots=True)
class Choices:
    """The first possible targets of a reference; `more`: how many there are beside."""

    choices: tuple[Choice, ...]
    more: int


@dataclass(frozen=True, slots=True)
class Kind:
    """A class of elements that can be added: `jaus.Component`.

    `values`: what a new element begins with, such as a name that nobody has.
    """

    kind: str
    label: str
    documentation: str
    values: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Child:
    """A part of an element; `cells`: its values that a list shows and changes."""

    element: str
    label: str
    kind: str
    cells: tuple[Field, ...] = ()


@dataclass(frozen=True, slots=True)
class Children:
    """A feature that owns elements."""

    feature: str
    label: str
    many: bool
    documentation: str
    kinds: tuple[Kind, ...]
    elements: tuple[Child, ...]


@dataclass(frozen=True, slots=True)
class Form:
    """The properties of an element.

    `class_`: its class in words: `service connection`. `owner`: the element that owns it, empty for
    a root.
    """

    element: str
    class_: str
    title: str
    documentation: str
    readonly: bool
    owner: str
    fields: tuple[Field, ...]
    children: tuple[Children, ...]


@dataclass(frozen=True, slots=True)
class PaletteItem:
    """An element that can be added.

    Attributes:
        id: Its id, the same while the library is.
        group: `components`, `services`, `ros types`, `ready maps` or `elements`.
        commands: Those that add it, whose owner is filled in.
        onto: What it is added to, as people name it; empty for the system.
    """

    id: str
    group: str
    label: str
    note: str
    documentation: str
    commands: Sequence[Command]
    label_of_edit: str
    onto: str = ""


_KINDS = {
    ValueKind.STRING: "text",
    ValueKind.INTEGER: "integer",
    ValueKind.REAL: "number",
    ValueKind.BOOLEAN: "boolean",
    ValueKind.ENUMERATION: "choice",
}
_MOST_CHOICES = 100
_MOST_ROWS = 30  # elements of a list whose main features are shown there
_IN_ROWS = frozenset({"type", "units", "message", "event", "target"})
"""Features that lists of elements show beside what is required."""
_USUAL = {True: "jaus.FixedField", False: "jaus.Record"}
"""The kind of field that most are, where there are several fields, or one alone."""
_MULTILINE = frozenset({"documentation", "holdReason"})
_UNITS = (
    (re.compile(r"^(?:[A-Z][a-z]* )?(?:messages|reports|calls) each second", re.IGNORECASE), "Hz"),
    (re.compile(r"^Metres per second"), "m/s"),
    (re.compile(r"^Minutes"), "min"),
    (re.compile(r"^Seconds|\bin seconds\b"), "s"),
)
"""How the documentation of a feature says in which unit it is."""
_OWN_UNIT = frozenset({"value", "minimum", "maximum"})
"""Features that are in the unit that their element states."""


def form_of(scope: Scope, element: EObject, diagnostics: Iterable[Diagnostic] = ()) -> Form:
    """Returns the form of an element."""
    ref = scope.ref(element)
    table = scope.model.metamodels.class_of(element)
    is_fixed = ref.startswith(LIBRARY)
    problems = _Problems(scope, element, diagnostics)
    return Form(
        element=ref,
        class_=in_words(table.name),
        title=label_of(element),
        documentation=documentation(table.eclass),
        readonly=is_fixed,
        owner=scope.ref(element.eContainer()),
        fields=tuple(
            _field(scope, element, feature, problems, is_fixed=is_fixed)
            for feature in _shown(table)
            if feature.kind is not FeatureKind.CONTAINMENT
        ),
        children=tuple(
            _children(scope, element, feature, is_fixed=is_fixed)
            for feature in _shown(table)
            if feature.kind is FeatureKind.CONTAINMENT
        ),
    )


def kinds_of(target: ClassTable) -> tuple[Kind, ...]:
    """Returns the classes whose elements can stand where one of a class is owned."""
    concrete = sorted(
        (subtype for subtype in target.subtypes if not subtype.abstract),
        key=attrgetter("qualified_name"),
    )
    first = [class_table for class_table in concrete if class_table is target]
    return tuple(
        Kind(
            class_table.qualified_name,
            in_words(class_table.name),
            documentation(class_table.eclass),
        )
        for class_table in (*first, *(subtype for subtype in concrete if subtype is not target))
    )


def _shown(table: ClassTable) -> list[FeatureTable]:
    """The features of a form: the name, the others by what they are about, the documentation."""
    features = [
        feature
        for feature in table.features.values()
        if feature.kind is not FeatureKind.CONTAINER and feature.settable
    ]
    return sorted(
        features,
        key=lambda feature: (
            feature.name == "documentation",
            list(_GROUPS).index(_GROUP_OF.get(feature.name, "")),
            feature.name != "name",
        ),
    )


_GROUPS = {
    "": (),
    "rates and limits": (
        *("query", "rate", "rateCap", "maxRate", "decimation", "ageLimit", "priority"),
        *("frequency", "maxEvents", "eventRateBudget", "maxPeers", "maxConnections"),
        *("amplificationLimit",),
    ),
    "silence and stops": (
        *("silenceTimeout", "safeValue", "onSilence", "whenSilent", "holdReason", "freshness"),
        *(
            "whenStale",
            "outOfRange",
            "controlTimeout",
            "idleTimeout",
            "eventTimeout",
            "openDecisions",
        ),
    ),
    "trust and control": (
        *("acknowledge", "control", "controls", "authority", "defaultAuthority", "guardian"),
        *("allowedHosts", "fixedSources", "greet"),
    ),
}
_GROUP_OF = {name: group for group, names in _GROUPS.items() for name in names}


class _Problems:
    """The findings about the features of an element, told by their places."""

    def __init__(self, scope: Scope, element: EObject, diagnostics: Iterable[Diagnostic]) -> None:
        self._scope, self._element = scope, element
        own, document = scope.model.location(element), scope.model.document_of(element)
        fragment = scope.model.fragment(element)
        path = document.display if document is not None else ""
        self._diagnostics = [
            diagnostic
            for diagnostic in diagnostics
            if diagnostic.fragment == fragment
            and diagnostic.location.path == path
            and diagnostic.location != own
        ]

    def of(self, feature: str) -> tuple[str, ...]:
        """Returns the messages at a feature."""
        if not self._diagnostics:
            return ()
        place = self._scope.model.location(self._element, feature)
        return tuple(
            diagnostic.message for diagnostic in self._diagnostics if diagnostic.location == place
        )


def _field(
    scope: Scope, element: EObject, feature: FeatureTable, problems: _Problems, *, is_fixed: bool
) -> Field:
    values = values_of(element, feature)
    is_reference = feature.kind is FeatureKind.CROSS_REFERENCE
    if is_reference:
        texts = tuple(scope.ref(value) for value in values)
        shown = tuple(label_of(value) for value in values)
    else:
        texts = shown = tuple(map(literal, values))
    is_required = feature.lower > 0 and feature.can_be_missing
    return Field(
        feature=feature.name,
        label=in_words(feature.name),
        kind="reference" if is_reference else _kind(feature),
        many=feature.many,
        required=is_required,
        group=_GROUP_OF.get(feature.name, ""),
        values=texts,
        shown=shown,
        default="" if is_required else _default(element, feature),
        documentation=documentation(feature.feature),
        unit=_unit(element, feature),
        choices=() if is_reference else (*choices_of(feature), *usual_texts(element, feature)),
        problems=problems.of(feature.name),
        changeable=not is_fixed,
    )


def _default(element: EObject, feature: FeatureTable) -> str:
    """Returns the value that holds while none is set; of a rate that follows, its present one."""
    if feature.name == "rate" and isinstance(element, bridge.Connection):
        owner = element.eContainer()
        return literal(owner.frequency) if isinstance(owner, bridge.Bridge) else ""
    return "" if feature.default is None else literal(feature.default)


def _kind(feature: FeatureTable) -> str:
    if feature.name in _MULTILINE:
        return "multiline"
    return _KINDS[_data_type(feature).kind]


def _data_type(feature: FeatureTable) -> DataTypeTable:
    if feature.data_type is None:
        raise TypeError(f"{feature.name} is no attribute")
    return feature.data_type


@cache
def choices_of(feature: FeatureTable) -> tuple[Choice, ...]:
    """Returns the literals of an enumeration, none of other attributes."""
    literals = _data_type(feature).literals
    return tuple(
        Choice(enum_literal, enum_literal, documentation(literals[enum_literal]))
        for enum_literal in _data_type(feature).legal
    )


def choices(scope: Scope, ref: str, feature: str, query: str = "") -> Choices:
    """Returns the possible targets of a reference that have all words of a query, best fits first.

    `AnswerError`: there is no such element, or it has no such reference.
    """
    element = scope.find(ref)
    table = scope.model.metamodels.class_of(element).features.get(feature)
    if table is None or table.kind is not FeatureKind.CROSS_REFERENCE:
        raise AnswerError(f"{label_of(element)} has no reference {feature!r}")
    words = query.lower().split()
    targets = {
        legal_target.value: legal_target for legal_target in legal_targets(scope, element, table)
    }
    matches = [
        target
        for target in targets.values()
        if all(word in f"{target.label} {target.value}".lower() for word in words)
    ]
    matches.sort(key=lambda choice: _rank(choice.label.lower(), query.strip().lower()))
    return Choices(tuple(matches[:_MOST_CHOICES]), max(0, len(matches) - _MOST_CHOICES))


def _rank(label: str, query: str) -> int:
    """Returns the rank of a label for typed text, 0 best: its last name counts most."""
    name = re.split("[/.]", label.partition(" (")[0])[-1]
    if name == query:
        return 0
    return 1 if name.startswith(query) or label.startswith(query) else 2


def _unit(element: EObject, feature: FeatureTable) -> str:
    data_type = feature.data_type
    if data_type is None or data_type.kind not in (ValueKind.REAL, ValueKind.INTEGER):
        return ""
    if feature.name in _OWN_UNIT:
        return str(getattr(element, "units", None) or "")
    if feature.name in ("lower", "upper"):
        stated = (getattr(owner, "units", None) for owner in with_owners(element))
        return str(next(filter(None, stated), ""))
    text = documentation(feature.feature)
    return next((unit for pattern, unit in _UNITS if pattern.search(text)), "")


def _children(scope: Scope, element: EObject, feature: FeatureTable, *, is_fixed: bool) -> Children:
    value = getattr(element, feature.name)
    owned: Sequence[EObject] = list(value) if feature.many else [value] if value else []
    is_full = not feature.many and bool(owned)
    target = feature.target
    kinds = () if is_full or is_fixed or target is None else kinds_of(target)
    return Children(
        feature=feature.name,
        label=in_words(feature.name),
        many=feature.many,
        documentation=documentation(feature.feature),
        kinds=tuple(
            replace(kind, values=usual_values(scope.model, element, feature, kind.kind))
            for kind in sorted(kinds, key=lambda kind: kind.kind != _USUAL[feature.many])
        ),
        elements=tuple(
            Child(
                scope.ref(child),
                label_of(child),
                in_words(scope.model.metamodels.class_of(child).name),
                () if is_fixed or len(owned) > _MOST_ROWS else tuple(_cells(scope, child)),
            )
            for child in owned
        ),
    )


def _cells(scope: Scope, child: EObject) -> Iterator[Field]:
    none = _Problems(scope, child, ())
    for feature in _shown(scope.model.metamodels.class_of(child)):
        is_main = feature.name in _IN_ROWS or (feature.lower > 0 and feature.can_be_missing)
        is_value = feature.kind is not FeatureKind.CONTAINMENT and not feature.many
        if is_main and is_value and feature.name != "name":
            yield _field(scope, child, feature, none, is_fixed=False)
