"""Making of elements that no file has."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jausml.language.metamodel.filling import link, new_object, set_value

if TYPE_CHECKING:
    from jausml.language.metamodel import Metamodels
    from jausml.language.metamodel.classes.ecore import EObject


class Maker:
    """Makes elements of metamodels."""

    def __init__(self, metamodels: Metamodels) -> None:
        self._metamodels = metamodels

    def __call__(self, kind: str, **values: str) -> Any:
        """Returns an element of a class with some attributes."""
        table = self._metamodels.classes[kind]
        made = new_object(table)
        for name, value in values.items():
            feature = table.features[name]
            literals = feature.data_type.literals if feature.data_type is not None else {}
            set_value(made, feature, literals.get(value, value))
        return made

    def own(self, owner: EObject, feature: str, element: EObject) -> None:
        """Lets an element own another."""
        link(owner, self._metamodels.class_of(owner).features[feature], element)

    def refer(self, owner: EObject, feature: str, element: EObject) -> None:
        """Lets an element refer to another."""
        self.own(owner, feature, element)
