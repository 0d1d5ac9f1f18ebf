"""Builder of model elements that know where in the JSIDL files they come from."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from jausml.language.metamodel import FeatureKind, ValueKind
from jausml.language.metamodel.filling import link, new_object, set_value, set_values

if TYPE_CHECKING:
    from jausml.language.importers.jsidl.findings import Place
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.model import Model

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

    def new(self, kind: type[ElementT], place: Place, /, **features: Any) -> ElementT:
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
