"""The flat tables: what they say of classes, features and data types, and what they refuse."""

from pathlib import Path

import pytest

from jausml.language.metamodel import (
    FeatureKind,
    MetamodelError,
    ValueKind,
    annotation,
    load_metamodels,
    read_metamodels,
)

ZOO = Path(__file__).parents[1] / "model" / "emf" / "zoo.ecore"


@pytest.fixture(scope="module")
def zoo():
    return read_metamodels([ZOO])


def test_inheritance_across_files():
    metamodels = load_metamodels()
    bridge = metamodels.classes["bridge.Bridge"]
    component = metamodels.classes["jaus.Component"]
    assert bridge in component.subtypes
    assert component in bridge.supertypes
    assert bridge.features["address"] is component.features["address"]
    assert list(bridge.features)[:2] == ["name", "documentation"]


def test_features_of_a_reference():
    connection = load_metamodels().classes["bridge.Connection"]
    topics = connection.features["topics"]
    assert (topics.kind, topics.many, topics.lower, topics.upper) == (
        FeatureKind.CONTAINMENT, True, 1, -1,
    )  # fmt: skip
    assert connection.features["map"].kind is FeatureKind.CROSS_REFERENCE
    assert connection.features["map"].type_name == "bridge.AttributeMap"


def test_defaults():
    metamodels = load_metamodels()
    connection = metamodels.classes["bridge.Connection"].features
    assert str(connection["direction"].default) == "jausToRos"
    assert connection["rate"].default == 0.0
    assert connection["control"].default is True
    assert metamodels.classes["jaus.Component"].features["authority"].default == 127
    assert connection["name"].default is None


def test_pattern_facet():
    code = load_metamodels().classes["jaus.MessageDef"].features["code"].data_type
    assert code.kind is ValueKind.STRING
    assert code.pattern.fullmatch("0x44aF")
    assert not code.pattern.fullmatch("0x44aF ")


def test_sub_packages_are_registered(zoo):
    assert "http://www.example.org/zoo/birds/1.0" in zoo.packages
    assert zoo.classes["birds.Parrot"] in zoo.classes["zoo.Animal"].subtypes


def test_enumeration_by_literal_and_name(zoo):
    kind = zoo.classes["zoo.Animal"].features["kind"]
    assert kind.data_type.literals["meat-eater"] is kind.data_type.literals["MEAT_EATER"]
    assert kind.data_type.literals["meat-eater"].value == 7
    assert kind.data_type.legal == ("plant-eater", "meat-eater")


def test_default_by_literal_reaches_the_object(zoo):
    # pyecore looks the default up by name and would yield None.
    lion = zoo.classes["zoo.Lion"].eclass()
    assert lion.kind.literal == "meat-eater"
    assert zoo.classes["zoo.Lion"].features["kind"].default is lion.kind


def test_special_features(zoo):
    animal = zoo.classes["zoo.Animal"].features
    assert not animal["label"].settable
    assert animal["tame"].unsettable
    assert not animal["legs"].can_be_missing, "EMF has a value for every int"
    keeper = zoo.classes["zoo.Keeper"].features
    assert keeper["badge"].can_be_missing
    cage = zoo.classes["zoo.Cage"]
    assert cage.id_feature is cage.features["id"]
    assert cage.features["zoo"].kind is FeatureKind.CONTAINER
    assert cage.features["partner"].opposite is cage.features["partnerOf"]


def test_class_of_and_kind(zoo):
    parrot = zoo.classes["birds.Parrot"].eclass()
    assert zoo.class_of(parrot) is zoo.classes["birds.Parrot"]
    assert isinstance(parrot, zoo.classes["zoo.Named"].python_class)
    assert not isinstance(parrot, zoo.classes["zoo.Cage"].python_class)


def test_annotations_of_literals():
    kinds = load_metamodels().package_named("bridge").enumerations["ConversionKind"]
    details = annotation(kinds.literals["scale"], "http://www.eclipse.org/emf/2002/GenModel")
    assert details == {"documentation": "The value times a factor."}
    assert annotation(kinds.literals["scale"], "urn:none") == {}


HEAD = (
    '<ecore:EPackage xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"'
    ' xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"'
    ' xmlns:ecore="http://www.eclipse.org/emf/2002/Ecore" name="p" nsURI="urn:p" nsPrefix="p">'
)


@pytest.mark.parametrize(
    ("classifier", "reason"),
    [
        (
            '<eClassifiers xsi:type="ecore:EClass" name="C"><eStructuralFeatures'
            ' xsi:type="ecore:EAttribute" name="bytes" eType="ecore:EDataType'
            ' http://www.eclipse.org/emf/2002/Ecore#//EByteArray"/></eClassifiers>',
            "EByteArray",
        ),
        (
            '<eClassifiers xsi:type="ecore:EDataType" name="T"'
            ' instanceClassName="java.lang.String"><eAnnotations'
            ' source="http:///org/eclipse/emf/ecore/util/ExtendedMetaData">'
            '<details key="pattern" value="["/></eAnnotations></eClassifiers>'
            '<eClassifiers xsi:type="ecore:EClass" name="C"><eStructuralFeatures'
            ' xsi:type="ecore:EAttribute" name="t" eType="#//T"/></eClassifiers>',
            "pattern",
        ),
        ('<eSubpackages name="q" nsURI="urn:p" nsPrefix="q"/>', "twice"),
    ],
)
def test_what_the_reader_cannot_honour_is_refused(tmp_path, classifier, reason):
    path = tmp_path / "p.ecore"
    path.write_text(f"{HEAD}{classifier}</ecore:EPackage>", encoding="utf-8")
    with pytest.raises(MetamodelError, match=reason):
        read_metamodels([path])


def test_unknown_names(zoo):
    with pytest.raises(KeyError):
        zoo.package_named("aquarium")
