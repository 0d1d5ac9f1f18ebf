"""Values of elements as commands state them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jausml.language.metamodel import FeatureTable
    from jausml.language.metamodel.classes.ecore import EObject


def values_of(element: EObject, feature: FeatureTable) -> list[Any]:
    """Returns the values that an element has in a feature; none while the default holds."""
    value = getattr(element, feature.name)
    if feature.many:
        return list(value)
    is_unset = value is None or (
        not feature.is_reference and value == feature.default and not feature.can_be_missing
    )
    return [] if is_unset else [value]


def literal(value: Any) -> str:
    """Returns a value of a data type as models write it."""
    if isinstance(value, bool):
        return str(value).lower()
    return str(getattr(value, "literal", None) or getattr(value, "name", value))
