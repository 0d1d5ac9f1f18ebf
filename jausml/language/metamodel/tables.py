"""Flat tables of the metamodels: what the reader asks for each element, without reflection."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import re
    from collections.abc import Mapping

    from jausml.language.metamodel.classes.ecore import EObject


class FeatureKind(Enum):
    """What a structural feature holds and how it is written in XMI."""

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
        name: Name in the metamodel (`EInt`, `MessageCode`).
        kind: Lexical family.
        minimum: Smallest legal integer, for the integer family.
        maximum: Largest legal integer, for the integer family.
        pattern: Facet of ExtendedMetaData; a value must match it whole.
        pattern_text: The facet as it stands in the metamodel.
        nullable: False for Java primitives and enumerations, which have a value in EMF even
            when nothing is written.
        literals: Enumeration literals by literal and by name.
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
        name: Name of the feature, which is also its XML name.
        feature: The pyecore EAttribute or EReference.
        kind: What it holds.
        many: True when more than one value is legal.
        lower: Least number of values.
        upper: Greatest number of values; -1 means no limit.
        unique: True when a value may occur once only.
        type_name: Qualified class name (`jaus.Component`) or data type name (`EString`).
        data_type: The data type of an attribute, else None.
        target: The class of a reference, else None.
        opposite: The other end of a bidirectional reference, else None.
        default: The value of an attribute that is not written (a literal object for
            enumerations), None when there is none.
        is_id: True when the attribute identifies its element within the document.
        settable: False for derived and unchangeable features, which no file may set.
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
    """A class of a metamodel with everything it inherits.

    Attributes:
        name: Simple name (`Component`).
        qualified_name: Package and name (`jaus.Component`).
        package: The package that declares it.
        eclass: The pyecore EClass.
        abstract: True for abstract classes and interfaces.
        features: All features by name, own and inherited, in metamodel order.
        supertypes: The class itself and all its super types.
        subtypes: The class itself and all classes that specialise it.
        id_feature: The attribute that identifies an element, if the class has one.
        bounded: The features with bounds that a document can break.
        contained: The features that own elements.
    """

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
        """What pyecore makes the elements from."""
        made: type[EObject] = self.eclass.python_class
        return made

    def __repr__(self) -> str:
        return f"<class {self.qualified_name}>"


@dataclass(slots=True, eq=False)
class PackageTable:
    """A metamodel package.

    Attributes:
        name: Package name (`jaus`).
        ns_uri: The namespace that identifies the package in documents.
        epackage: The pyecore EPackage.
        file_name: Name of the .ecore file that declares it.
        classes: Classes by simple name.
        enumerations: Enumerations by simple name.
    """

    name: str
    ns_uri: str
    epackage: Any
    file_name: str
    classes: dict[str, ClassTable] = field(default_factory=dict)
    enumerations: dict[str, DataTypeTable] = field(default_factory=dict)


class Metamodels:
    """All packages of a set of metamodels, indexed by what documents name.

    Attributes:
        packages: Packages by nsURI, sub-packages included.
        classes: Classes by qualified name (`jaus.Component`).
    """

    def __init__(self, packages: Mapping[str, PackageTable]) -> None:
        self.packages = dict(packages)
        self.classes = {
            table.qualified_name: table
            for package in self.packages.values()
            for table in package.classes.values()
        }
        self._by_eclass = {table.eclass: table for table in self.classes.values()}

    def class_of(self, obj: EObject | type[EObject]) -> ClassTable:
        """Returns the table of a class, such as `jaus.Component`, or of that of an element.

        Raises:
            KeyError: It is no class of these metamodels.
        """
        return self._by_eclass[obj.eClass]

    def package_named(self, name: str) -> PackageTable:
        """Returns the package of a name (`jaus`).

        Raises:
            KeyError: There is no such package.
        """
        for package in self.packages.values():
            if package.name == name:
                return package
        raise KeyError(name)
