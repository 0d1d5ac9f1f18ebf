"""Elements as a command leaves them, to be written and named like any element of the model.

They refer to elements of the model and have an owner there, or one that is detached itself; the
model knows nothing of them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

from jausml.authoring.editing.working_copy import ElementCopy
from jausml.language.metamodel import DataTypeTable
from jausml.language.metamodel.classes import bridge
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.metamodel.filling import fill, link, new_object, point, set_value
from jausml.language.model.refs import Ref
from jausml.language.model.values import convert
from jausml.language.semantics.connections.exchanges import FEATURES, infer


def detached(
    copy: ElementCopy, find: Callable[[ElementCopy | Ref], EObject], *, is_whole: bool = True
) -> EObject:
    """Returns an element of a working copy without an owner.

    `find`: returns the element of the model that a reference means. `is_whole`: with all that it
    owns.
    """
    element: Any = new_object(copy.table)
    features = copy.table.features
    for name, texts in copy.values.items():
        feature = features[name]
        data_type = cast("DataTypeTable", feature.data_type)
        values = [None if text is None else convert(text, data_type)[0] for text in texts]
        if feature.settable:
            fill(element, feature, values)
    for name, targets in copy.references.items():
        if features[name].settable:
            for target in targets:
                # Not linked: elements of the model must not refer back to one that is thrown away.
                point(element, features[name], find(target))
    for name, owned in copy.owned.items() if is_whole else ():
        for owned_copy in owned:
            link(element, features[name], detached(owned_copy, find))
    return element  # type: ignore[no-any-return]


def settle_new(new_element: EObject, copy: ElementCopy) -> None:
    """Gives new connections the way that follows from all else, where a command leaves it open.

    So the text leaves it open too.
    """
    if isinstance(new_element, bridge.Connection) and copy.open:
        stated = [
            None if feature_name in copy.open else getattr(new_element, feature_name).name
            for feature_name in FEATURES
        ]
        inferred = infer(new_element, *stated)
        for name in FEATURES:
            feature = copy.table.features[name]
            literals = cast("DataTypeTable", feature.data_type).literals
            set_value(new_element, feature, literals[getattr(inferred, name)])
    for name, owned in copy.owned.items():
        elements = getattr(new_element, name)
        for element, inner in zip(
            elements if copy.table.features[name].many else [elements], owned, strict=True
        ):
            settle_new(element, inner)
