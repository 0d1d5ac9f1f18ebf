"""Keywords of ros2jaus text, and the classes and features that they stand for."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache

from jausml.language.metamodel import ClassTable, FeatureKind, Metamodels

KEYWORDS = ("import", "JAUS", "ROS", "struct", "table", "vector", "ignore", "clock", "new")
"""Words that are names only in back quotes, except as names of features."""

_WORD_STARTS = re.compile(r"(?<=[a-z0-9])(?=[A-Z][a-z])")
_QUALITY_OF_SERVICE = ("QoS", "Qos")


def keyword_of(class_name: str) -> str:
    """Returns the keyword of a class: its name in small letters, as `message_def`."""
    return _WORD_STARTS.sub("_", class_name.replace(*_QUALITY_OF_SERVICE)).lower()


def classes_by_keyword(metamodels: Metamodels) -> Mapping[str, ClassTable]:
    """Returns the classes that have elements, by the keywords that stand for them.

    A keyword that several classes share stands for none: they are named with their packages
    (`ros.node`), which every class may be.
    """
    concrete = [table for table in metamodels.classes.values() if not table.abstract]
    names = [keyword_of(table.name) for table in concrete]
    classes_by_name = {
        f"{class_table.package.name}.{keyword_of(class_table.name)}": class_table
        for class_table in concrete
    }
    short = zip(names, concrete, strict=True)
    return classes_by_name | {name: table for name, table in short if names.count(name) == 1}


@cache
def owning_features(owner: ClassTable, table: ClassTable) -> tuple[str, ...]:
    """Returns the features of a class that may own an element of another class.

    Where a feature takes the very class, those of classes that it specialises are left out: a
    bridge of a system is one of its bridges, and not just one of its components.
    """
    taking = {
        name: feature.target
        for name, feature in owner.features.items()
        if feature.kind is FeatureKind.CONTAINMENT and feature.target in table.supertypes
    }
    exact = tuple(name for name, target in taking.items() if target is table)
    return exact or tuple(taking)
