"""What all builders of elements share: where findings go, and how elements are made."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from jausml.language.importers.jsidl.rules import JSIDL_RULES
from jausml.language.metamodel import FeatureKind, ValueKind
from jausml.language.metamodel.filling import link, new_object, set_value, set_values
from jausml.language.model.diagnostics import Diagnostic, Location, Related, Severity
from jausml.language.model.rules import READER_RULES

if TYPE_CHECKING:
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.model import Model
    from jausml.language.model.reading.problems import NodePlace


class Findings:
    """The findings of one import."""

    def __init__(self) -> None:
        self._found: dict[Diagnostic, None] = {}
        self.has_errors = False

    def report(
        self,
        rule: str,
        place: NodePlace | Location,
        message: str,
        hint: str = "",
        related: tuple[Related, ...] = (),
    ) -> None:
        """Reports a finding; its severity is that of the rule.

        A declaration that several messages use is looked at for each of them: what is found there
        again is one finding.
        """
        location = place if isinstance(place, Location) else place.location
        severity = (JSIDL_RULES.get(rule) or READER_RULES[rule]).severity
        self.has_errors = self.has_errors or severity is Severity.ERROR
        self._found[Diagnostic(rule, severity, location, message, hint, related=related)] = None

    def diagnostics(self) -> list[Diagnostic]:
        """Returns the findings, sorted by place."""
        return sorted(self._found)


ElementT = TypeVar("ElementT", bound="EObject")

MOST_ELEMENTS = 50_000
DEEPEST = 50


class TooMuchError(Exception):
    """The declarations unfold into more elements than any message needs."""


class Builder:
    """Makes elements of the jaus metamodel."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self._made = 0

    def new(self, kind: type[ElementT], place: NodePlace, /, **features: Any) -> ElementT:
        """Makes an element.

        Args:
            features: Its features: values, names of literals, elements, or lists of these. None
                leaves a feature alone.
        """
        self._made += 1
        if self._made > MOST_ELEMENTS:
            raise TooMuchError
        obj: ElementT = new_object(self.model.metamodels.class_of(kind))
        for name, value in features.items():
            if value is not None:
                self.set(obj, name, value)
        place.node.obj = obj
        self.model.adopt(place.document, place.node)
        return obj

    def set(self, obj: EObject, name: str, value: Any) -> None:
        """Sets a feature of an element, or adds to one with many values.

        Args:
            obj: The element.
        """
        feature = self.model.metamodels.class_of(obj).features[name]
        if feature.kind is not FeatureKind.ATTRIBUTE:
            for each in value if feature.many else [value]:
                link(obj, feature, each)
        elif feature.many:
            set_values(obj, feature, value)
        else:
            data_type = feature.data_type
            if data_type is not None and data_type.kind is ValueKind.ENUMERATION:
                value = data_type.literals[value]
            set_value(obj, feature, value)
