"""Flat tables of the metamodels: what the reader asks for each element, without reflection."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

from jausml.language.metamodel.classes.ecore import EObject


class FeatureKind(Enum):
    """Kinds of structural features, and how each is written in XMI."""

    ATTRIBUTE = "attribute"
    """A value of a data type: an XML attribute or an element with text."""
    CONTAINMENT = "containment"
    """Owned elements: child elements of the XML element."""
    CROSS_REFERENCE = "cross reference"
    """Elements owned elsewhere: fragments in an XML attribute, or child elements with `href`."""
    CONTAINER = "container"
    """The owner of the element, the other end of a containment: implied by nesting."""


class ValueKind(Enum):
    """The lexical families of the data types that the reader knows."""

    STRING = "string"
    INTEGER = "integer"
    REAL = "real"
    BOOLEAN = "boolean"
    ENUMERATION = "enumeration"


@dataclass(frozen=True, slots=True, eq=False)
class DataTypeTable:
    """A data type: its lexical family and its facets.

    Attributes:
        nullable: False for Java primitives and enumerations, which have a value in EMF even
            when nothing is written.
        legal: The literals as they should be written, in metamodel order.
    """

    name: str
    kind: ValueKind
    minimum: int = 0
    maximum: int = 0
    pattern: re.Pattern[str] | None = None
    pattern_text: str = ""
    nullable: bool = True
    literals: Mapping[str, Any] = field(default_factory=dict)
    legal: tuple[str, ...] = ()


@dataclass(slots=True, eq=False)
class FeatureTable:
    """A structural feature of a class.

    Attributes:
        upper: Greatest number of values; -1 means no limit.
        unique: True when a value may occur once only.
        is_id: True when the attribute identifies its element within the document.
        unsettable: True when "not set" differs from "set to the default".
        can_be_missing: True when a required value is absent unless it is written.
    """

    name: str
    feature: Any
    kind: FeatureKind
    many: bool
    lower: int
    upper: int
    unique: bool
    type_name: str
    data_type: DataTypeTable | None
    default: Any
    is_id: bool
    settable: bool
    unsettable: bool
    can_be_missing: bool
    target: ClassTable | None = None
    opposite: FeatureTable | None = None

    @property
    def is_reference(self) -> bool:
        """True for features that hold elements, owned or not."""
        return self.kind is not FeatureKind.ATTRIBUTE

    def __repr__(self) -> str:
        return f"<feature {self.name}: {self.type_name}>"


@dataclass(slots=True, eq=False)
class ClassTable:
    """A class of a metamodel with everything it inherits."""

    name: str
    qualified_name: str
    package: PackageTable
    eclass: Any
    abstract: bool
    features: dict[str, FeatureTable] = field(default_factory=dict)
    supertypes: frozenset[ClassTable] = frozenset()
    subtypes: frozenset[ClassTable] = frozenset()
    id_feature: FeatureTable | None = None
    bounded: tuple[FeatureTable, ...] = ()
    contained: tuple[FeatureTable, ...] = ()

    @property
    def python_class(self) -> type[EObject]:
        """The class by which pyecore makes the elements."""
        element_class: type[EObject] = self.eclass.python_class
        return element_class

    def __repr__(self) -> str:
        return f"<class {self.qualified_name}>"


@dataclass(slots=True, eq=False)
class PackageTable:
    """A metamodel package."""

    name: str
    ns_uri: str
    epackage: Any
    file_name: str
    classes: dict[str, ClassTable] = field(default_factory=dict)
    enumerations: dict[str, DataTypeTable] = field(default_factory=dict)


class Metamodels:
    """All packages of a set of metamodels, indexed by what documents name."""

    def __init__(self, packages: Mapping[str, PackageTable]) -> None:
        self.packages = dict(packages)
        self.classes = {
            table.qualified_name: table
            for package in self.packages.values()
            for table in package.classes.values()
        }
        self._by_eclass = {table.eclass: table for table in self.classes.values()}

    def class_of(self, obj: EObject | type[EObject]) -> ClassTable:
        """Returns the table of a class, such as `jaus.Component`, or of that of an element."""
        return self._by_eclass[obj.eClass]

    def package_named(self, name: str) -> PackageTable:
        """Returns the package of a name (`jaus`)."""
        for package in self.packages.values():
            if package.name == name:
                return package
        raise KeyError(name)
