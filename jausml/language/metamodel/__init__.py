"""Metamodels: loaded once through pyecore and flattened into tables."""

from jausml.language.metamodel.loading import (
    MetamodelError,
    annotation,
    documentation,
    load_jaus_metamodel,
    load_metamodels,
    read_metamodels,
)
from jausml.language.metamodel.tables import (
    ClassTable,
    DataTypeTable,
    FeatureKind,
    FeatureTable,
    Metamodels,
    PackageTable,
    ValueKind,
)

__all__ = [
    "ClassTable",
    "DataTypeTable",
    "FeatureKind",
    "FeatureTable",
    "MetamodelError",
    "Metamodels",
    "PackageTable",
    "ValueKind",
    "annotation",
    "documentation",
    "load_jaus_metamodel",
    "load_metamodels",
    "read_metamodels",
]
