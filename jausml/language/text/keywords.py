"""Keywords: those of the language, and those that stand for classes (`message_def`)."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from jausml.language.metamodel import FeatureKind

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.language.metamodel import ClassTable, Metamodels

KEYWORDS = ("import", "JAUS", "ROS", "struct", "table", "vector", "ignore", "clock", "new")
"""Words that are names only in back quotes."""

_WORD_STARTS = re.compile(r"(?<=[a-z0-9])(?=[A-Z][a-z])")
_QUALITY_OF_SERVICE = ("QoS", "Qos")


def snake_case(class_name: str) -> str:
    """Returns the name of a class in small letters with underscores, as `message_def`."""
    return _WORD_STARTS.sub("_", class_name.replace(*_QUALITY_OF_SERVICE)).lower()


def classes_by_keyword(metamodels: Metamodels) -> Mapping[str, ClassTable]:
    """Returns the classes that have elements, by the keywords that stand for them.

    A keyword that several classes share stands for none: they are named with their packages
    (`ros.node`), which every class may be.
    """
    concrete = [table for table in metamodels.classes.values() if not table.abstract]
    names = [snake_case(table.name) for table in concrete]
    found = {f"{each.package.name}.{snake_case(each.name)}": each for each in concrete}
    short = zip(names, concrete, strict=True)
    return found | {name: table for name, table in short if names.count(name) == 1}


def owning_features(owner: ClassTable, table: ClassTable) -> list[str]:
    """Returns the features of a class that may own an element of another class.

    The feature of the very class goes before one of a class that it specialises: a bridge of a
    system is one of its bridges, and not just one of its components.
    """
    taking = {
        name: feature.target
        for name, feature in owner.features.items()
        if feature.kind is FeatureKind.CONTAINMENT and feature.target in table.supertypes
    }
    exact = [name for name, target in taking.items() if target is table]
    return exact or list(taking)
