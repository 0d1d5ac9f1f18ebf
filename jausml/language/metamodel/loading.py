"""Loader of .ecore files: through pyecore, flattened into tables.

The only module that uses pyecore's loading machinery. It reads metamodels only: user models are
read by `jausml.language.model`, because pyecore's XMI reader keeps no positions and skips many
faults.
"""

from __future__ import annotations

import re
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache, wraps
from importlib.resources import files
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

from pyecore.ecore import EAttribute, EClass, EDataType, EEnum, EProxy
from pyecore.resources import URI, ResourceSet
from pyecore.resources.xmi import XMIResource

from jausml.language.metamodel.access import hasten
from jausml.language.metamodel.tables import (
    ClassTable,
    DataTypeTable,
    FeatureKind,
    FeatureTable,
    Metamodels,
    PackageTable,
    ValueKind,
)

GEN_MODEL = "http://www.eclipse.org/emf/2002/GenModel"
EXTENDED_META_DATA = "http:///org/eclipse/emf/ecore/util/ExtendedMetaData"
_ANNOTATIONS = "_annotations"

_LANGUAGES = ("jaus", "ros", "bridge", "system")

_INT = (-(2**31), 2**31 - 1)
_LONG = (-(2**63), 2**63 - 1)
_SHORT = (-(2**15), 2**15 - 1)
_RANGES = {
    "int": _INT,
    "java.lang.Integer": _INT,
    "long": _LONG,
    "java.lang.Long": _LONG,
    "short": _SHORT,
    "java.lang.Short": _SHORT,
}
_ECORE_TYPES = {
    "EString": "java.lang.String",
    "EBoolean": "boolean",
    "EBooleanObject": "java.lang.Boolean",
    "EInt": "int",
    "EIntegerObject": "java.lang.Integer",
    "ELong": "long",
    "ELongObject": "java.lang.Long",
    "EShort": "short",
    "EShortObject": "java.lang.Short",
    "EDouble": "double",
    "EDoubleObject": "java.lang.Double",
    "EFloat": "float",
    "EFloatObject": "java.lang.Float",
}
_KINDS = {
    "java.lang.String": ValueKind.STRING,
    "boolean": ValueKind.BOOLEAN,
    "java.lang.Boolean": ValueKind.BOOLEAN,
    "double": ValueKind.REAL,
    "java.lang.Double": ValueKind.REAL,
    "float": ValueKind.REAL,
    "java.lang.Float": ValueKind.REAL,
    **dict.fromkeys(_RANGES, ValueKind.INTEGER),
}
_PRIMITIVES = {"boolean", "int", "long", "short", "double", "float"}

ParametersT = ParamSpec("ParametersT")
MadeT = TypeVar("MadeT")

_LOADING = threading.RLock()


class MetamodelError(ValueError):
    """A metamodel uses something that the reader cannot honour."""


def _once(make: Callable[ParametersT, MadeT]) -> Callable[ParametersT, MadeT]:
    """Has a function make each thing once, also where several threads ask at the same time.

    Classes that were made twice would not know each other's elements.
    """
    cached = cache(make)

    @wraps(make)
    def wrapper(*args: ParametersT.args, **kwargs: ParametersT.kwargs) -> MadeT:
        with _LOADING:
            return cached(*args, **kwargs)  # type: ignore[arg-type]

    return wrapper


@_once
def load_metamodels() -> Metamodels:
    """Returns the jaus, ros, bridge and system metamodels, loaded once for each process."""
    return read_metamodels([_shipped(name) for name in _LANGUAGES], _shipped_resources())


@_once
def load_jaus_metamodel() -> Metamodels:
    """Returns the jaus metamodel alone, in half the time; its classes are those of all four."""
    return read_metamodels([_shipped("jaus")], _shipped_resources())


@_once
def python_class(language: str, name: str) -> type:
    """Returns the Python class that pyecore makes the elements of a class from."""
    (epackage,) = _shipped_resources().get_resource(URI(str(_shipped(language)))).contents
    eclass = epackage.getEClassifier(name)
    if not isinstance(eclass, EClass):
        raise AttributeError(f"the {language} language has no class '{name}'")
    element_class: type = eclass.python_class
    return element_class


@cache
def _shipped_resources() -> ResourceSet:
    # One set, so that each class exists once however many metamodels are loaded.
    return _resources()


def _resources() -> ResourceSet:
    resource_set = ResourceSet()
    resource_set.resource_factory["ecore"] = _EcoreFile
    return resource_set


class _EcoreFile(XMIResource):  # type: ignore[misc]  # pyecore has no types
    """Keeps annotations as text: as elements they take half as long again as all others."""

    def _decode_eobject(self, node: Any, parent: Any) -> None:
        if node.tag == "eAnnotations":
            details = {detail.get("key"): detail.get("value") for detail in node}
            vars(parent).setdefault(_ANNOTATIONS, {})[node.get("source")] = details
        else:
            super()._decode_eobject(node, parent)


def _shipped(language: str) -> Path:
    return Path(str(files("jausml.metamodels"))) / f"{language}.ecore"


def read_metamodels(paths: Sequence[Path], resources: ResourceSet | None = None) -> Metamodels:
    """Loads .ecore files and flattens them.

    Returns:
        The tables of all their packages and sub-packages.

    Raises:
        MetamodelError: A data type is of an unknown Java class, a pattern is not a regular
            expression, or two packages share an nsURI.
    """
    resources = _resources() if resources is None else resources
    packages: dict[str, PackageTable] = {}
    for path in paths:
        for root in resources.get_resource(URI(str(path))).contents:
            for epackage in _with_subpackages(root):
                if epackage.nsURI in packages:
                    raise MetamodelError(f"nsURI {epackage.nsURI} is declared twice")
                packages[epackage.nsURI] = PackageTable(
                    epackage.name, epackage.nsURI, epackage, path.name
                )
    _resolve_proxies(packages.values())
    _Flattening(packages).run()
    return Metamodels(packages)


def annotation(element: Any, source: str) -> dict[str, str]:
    """Returns the details of an EAnnotation of a metamodel element, empty when it has none."""
    return dict(vars(element).get(_ANNOTATIONS, {}).get(source, {}))


def documentation(element: Any) -> str:
    """Returns the GenModel documentation of a package, class, feature, data type or literal."""
    return annotation(element, GEN_MODEL).get("documentation", "")


def _with_subpackages(epackage: Any) -> Iterator[Any]:
    yield epackage
    for child in epackage.eSubpackages:
        yield from _with_subpackages(child)


def _resolve_proxies(packages: Iterable[PackageTable]) -> None:
    """Replaces remaining proxies of pyecore by their targets.

    A type that another .ecore declares stays an EProxy forever, and every later type check
    would pay for it.
    """
    for package in packages:
        for eclass in package.epackage.eClassifiers:
            if not isinstance(eclass, EClass):
                continue
            for feature in eclass.eStructuralFeatures:
                if isinstance(feature.eType, EProxy):
                    feature.eType = feature.eType.force_resolve()
            supers = list(eclass.eSuperTypes)
            if any(isinstance(supertype, EProxy) for supertype in supers):
                resolved = [supertype.force_resolve() for supertype in supers]
                eclass.eSuperTypes.clear()
                eclass.eSuperTypes.extend(resolved)


class _Flattening:
    """Fills the tables of packages whose proxies are resolved."""

    def __init__(self, packages: dict[str, PackageTable]) -> None:
        self._packages = packages
        self._classes: dict[Any, ClassTable] = {}
        self._data_types: dict[Any, DataTypeTable] = {}
        self._features: dict[Any, FeatureTable] = {}

    def run(self) -> None:
        for package in self._packages.values():
            for classifier in package.epackage.eClassifiers:
                if isinstance(classifier, EClass):
                    self._declare(package, classifier)
                elif isinstance(classifier, EEnum):
                    package.enumerations[classifier.name] = self._data_type(classifier)
        for table in self._classes.values():
            self._fill(table)
        for table in self._classes.values():
            for other in self._classes.values():
                if table in other.supertypes:
                    table.subtypes |= {other}
        for feature in self._features.values():
            self._link(feature)
            hasten(feature)

    def _declare(self, package: PackageTable, eclass: Any) -> None:
        abstract = bool(eclass.abstract or eclass.interface)
        qualified = f"{package.name}.{eclass.name}"
        table = ClassTable(eclass.name, qualified, package, eclass, abstract)
        package.classes[eclass.name] = table
        self._classes[eclass] = table

    def _fill(self, table: ClassTable) -> None:
        lineage = [*reversed(table.eclass.eAllSuperTypes()), table.eclass]
        table.supertypes = frozenset(self._classes[ancestor] for ancestor in lineage)
        for eclass in lineage:
            for feature in eclass.eStructuralFeatures:
                table.features[feature.name] = self._feature(feature)
        features = tuple(table.features.values())
        table.id_feature = next((candidate for candidate in features if candidate.is_id), None)
        table.bounded = tuple(
            candidate for candidate in features if candidate.upper > 1 or candidate.can_be_missing
        )
        table.contained = tuple(
            candidate for candidate in features if candidate.kind is FeatureKind.CONTAINMENT
        )

    def _feature(self, feature: Any) -> FeatureTable:
        known = self._features.get(feature)
        if known is not None:
            return known
        is_attribute = isinstance(feature, EAttribute)
        data_type = self._data_type(feature.eType) if is_attribute else None
        if data_type is not None and data_type.kind is ValueKind.ENUMERATION:
            _name_default_literal(feature, data_type)
        # Java primitives and enumerations always have a value, and EMF does not write a value
        # that equals the default: only "unsettable" makes their absence visible.
        implied = data_type is not None and not feature.many and not feature.unsettable
        has_value = implied and (
            not data_type.nullable or feature.defaultValueLiteral is not None  # type: ignore[union-attr]
        )
        table = FeatureTable(
            name=feature.name,
            feature=feature,
            kind=_kind(feature),
            many=bool(feature.many),
            lower=int(feature.lowerBound),
            upper=int(feature.upperBound),
            unique=bool(feature.unique),
            type_name=data_type.name if data_type is not None else "",
            data_type=data_type,
            default=feature.get_default_value() if is_attribute and not feature.many else None,
            is_id=bool(is_attribute and feature.iD),
            settable=not (feature.derived or not feature.changeable),
            unsettable=bool(feature.unsettable),
            can_be_missing=feature.lowerBound > 0 and not has_value,
        )
        self._features[feature] = table
        return table

    def _link(self, table: FeatureTable) -> None:
        """Links a reference to the tables of its target and opposite, once all of them exist."""
        if table.kind is FeatureKind.ATTRIBUTE:
            return
        feature = table.feature
        table.target = self._classes[feature.eType]
        table.type_name = table.target.qualified_name
        if feature.eOpposite is not None:
            table.opposite = self._features[feature.eOpposite]

    def _data_type(self, etype: EDataType) -> DataTypeTable:
        known = self._data_types.get(etype)
        if known is None:
            known = _enumeration(etype) if isinstance(etype, EEnum) else _plain_type(etype)
            self._data_types[etype] = known
        return known


def _kind(feature: Any) -> FeatureKind:
    if isinstance(feature, EAttribute):
        return FeatureKind.ATTRIBUTE
    if feature.containment:
        return FeatureKind.CONTAINMENT
    return FeatureKind.CONTAINER if feature.container else FeatureKind.CROSS_REFERENCE


def _enumeration(etype: EEnum) -> DataTypeTable:
    literals: dict[str, Any] = {}
    legal = []
    for e_literal in etype.eLiterals:
        legal.append(e_literal.literal or e_literal.name)
        literals[legal[-1]] = e_literal
    for e_literal in etype.eLiterals:
        literals.setdefault(e_literal.name, e_literal)
    return DataTypeTable(
        etype.name, ValueKind.ENUMERATION, nullable=False, literals=literals, legal=tuple(legal)
    )


def _plain_type(etype: EDataType) -> DataTypeTable:
    java_class = _ECORE_TYPES.get(etype.name) or etype.instanceClassName
    kind = _KINDS.get(java_class)
    if kind is None:
        raise MetamodelError(f"data type {etype.name} has the unsupported class {java_class}")
    minimum, maximum = _RANGES.get(java_class, (0, 0))
    pattern_text = annotation(etype, EXTENDED_META_DATA).get("pattern", "")
    try:
        pattern = re.compile(pattern_text) if pattern_text else None
    except re.error as error:
        raise MetamodelError(f"pattern of data type {etype.name}: {error}") from error
    nullable = java_class not in _PRIMITIVES
    return DataTypeTable(
        etype.name, kind, minimum, maximum, pattern, pattern_text, nullable=nullable
    )


def _name_default_literal(feature: Any, data_type: DataTypeTable) -> None:
    """Lets pyecore find the default of an enumeration attribute.

    EMF gives the default as a literal; pyecore looks it up by name and would silently yield None.
    """
    text = feature.defaultValueLiteral
    if text is not None and text in data_type.literals:
        feature.defaultValueLiteral = data_type.literals[text].name
