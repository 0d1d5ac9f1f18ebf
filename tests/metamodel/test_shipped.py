"""The rules that all shipped metamodels keep; each was learnt from a real failure of a tool."""

import re
from importlib.resources import files

from for_each import for_each
from pyecore.ecore import EClass, EEnum, EObject, EProxy

from jausml.language.metamodel import FeatureKind, documentation, load_metamodels

GUARDS = ("metamodels",)

METAMODELS = load_metamodels()
CLASSES = list(METAMODELS.classes.values())
FEATURES = [(table, feature) for table in CLASSES for feature in table.features.values()]
ENUMERATIONS = [
    classifier
    for package in METAMODELS.packages.values()
    for classifier in package.epackage.eClassifiers
    if isinstance(classifier, EEnum)
]
# Names that break instances or shadow methods of pyecore: `listeners`, `eClass`, `delete`, ...
DENIED = set(dir(EObject)) | set(vars(EObject())) | {"dyn_inst"}


def test_loaded_once():
    assert load_metamodels() is METAMODELS


def test_packages():
    assert sorted(METAMODELS.packages) == [
        "http://www.jausml.org/bridge/1.0",
        "http://www.jausml.org/jaus/1.0",
        "http://www.jausml.org/ros/1.0",
        "http://www.jausml.org/system/1.0",
    ]


@for_each("enumeration", ENUMERATIONS, ids=lambda enum_class: enum_class.name)
def test_literal_equals_name(enumeration):
    # EMF writes the literal, pyecore knows the name.
    assert all(e_literal.literal in (None, e_literal.name) for e_literal in enumeration.eLiterals)


def wrong(holds):
    """Names the features for which a rule does not hold."""
    return [
        f"{table.qualified_name}.{feature.name}"
        for table, feature in FEATURES
        if not holds(feature)
    ]


def test_feature_names():
    assert wrong(lambda feature: feature.name not in DENIED) == []
    assert wrong(lambda feature: re.fullmatch("[a-z][A-Za-z0-9]*", feature.name)) == []


def test_features_are_documented():
    assert wrong(lambda feature: documentation(feature.feature)) == []


def test_no_proxies_are_left():
    # A type of another .ecore would stay an EProxy and slow every type check.
    assert wrong(lambda feature: not isinstance(feature.feature.eType, EProxy)) == []


def test_bounds_are_in_order():
    assert wrong(lambda feature: feature.lower <= feature.upper or feature.upper < 0) == []


def test_no_feature_has_an_opposite():
    # EMF cannot read a many-to-many opposite of which one end is written; no check of one is here.
    assert FEATURES
    assert wrong(lambda feature: feature.opposite is None) == []


def test_values_may_repeat_in_lists():
    # Unique numbers would lose the second 3 of a 3 x 3 array.
    lists = [
        feature for _, feature in FEATURES if feature.many and feature.kind is FeatureKind.ATTRIBUTE
    ]
    assert lists
    assert not any(feature.unique for feature in lists)


def test_absent_required_values_are_visible():
    # EMF leaves out a number that equals the default of its type.
    def visible(each):
        if each.kind is not FeatureKind.ATTRIBUTE or not each.lower or each.many:
            return True
        return each.can_be_missing != (each.feature.defaultValueLiteral is not None)

    assert wrong(visible) == []


def test_no_keys():
    # pyecore cannot load an .ecore with eKeys.
    for package in METAMODELS.packages.values():
        text = (files("jausml.metamodels") / package.file_name).read_text(encoding="utf-8")
        assert "eKeys" not in text


@for_each("table", CLASSES, ids=lambda class_table: class_table.qualified_name)
def test_class(table):
    assert documentation(table.eclass)
    assert all(not isinstance(e_super_type, EProxy) for e_super_type in table.eclass.eSuperTypes)
    assert any(not subtype.abstract for subtype in table.subtypes)


@for_each("name", sorted({table.package.name for table in CLASSES}))
def test_classifier_names_are_unique(name):
    epackage = METAMODELS.package_named(name).epackage
    names = [e_classifier.name for e_classifier in epackage.eClassifiers]
    assert len(names) == len(set(names))
    assert all(
        isinstance(e_classifier, EClass) or documentation(e_classifier)
        for e_classifier in epackage.eClassifiers
    )
