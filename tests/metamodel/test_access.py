"""Quick access to features says what pyecore's own access says."""

from pathlib import Path

import pytest
from for_each import for_each

from jausml.language.metamodel import load_metamodels, read_metamodels
from jausml.language.metamodel.filling import new_object

ZOO = Path(__file__).parents[1] / "model" / "emf" / "zoo.ecore"
TABLES = [*load_metamodels().classes.values(), *read_metamodels([ZOO]).classes.values()]
CONCRETE = [table for table in TABLES if not table.abstract]


@for_each("table", CONCRETE, ids=lambda class_table: class_table.qualified_name)
def test_what_was_never_set_has_the_value_that_pyecore_gives(table):
    ours, theirs = new_object(table), table.eclass()
    for name, feature in table.features.items():
        expected = feature.feature.__get__(theirs, type(theirs))
        found = getattr(ours, name)
        assert (list(found) if feature.many else found) == (
            list(expected) if feature.many else expected
        ), name
        assert not ours.eIsSet(feature.feature)


@for_each("table", CONCRETE, ids=lambda class_table: class_table.qualified_name)
def test_asking_for_one_value_leaves_no_trace(table):
    element = new_object(table)
    plain = [feature for feature in table.features.values() if not feature.feature.derived]
    single = [feature for feature in plain if not feature.many and feature.opposite is None]
    before = dict(element.__dict__)
    for feature in single:
        getattr(element, feature.name)
    assert element.__dict__ == before


def test_a_class_still_gives_the_feature_itself():
    for table in TABLES:
        for name, feature in table.features.items():
            assert getattr(table.python_class, name) is feature.feature


def test_values_are_set_checked_and_taken_back_as_by_pyecore():
    component = new_object(load_metamodels().classes["jaus.Component"])
    component.name = "front"
    assert (component.name, component.eGet("name")) == ("front", "front")
    with pytest.raises(TypeError):
        component.name = 5
    del component.name
    assert component.name is None
    service = new_object(load_metamodels().classes["jaus.Service"])
    component.provides.append(service)
    assert list(component.provides) == [service]
    with pytest.raises(TypeError):
        component.provides.append(component)


def test_an_element_is_as_pyecore_makes_it():
    for table in CONCRETE:
        ours, theirs = new_object(table), table.eclass()
        assert ours.__dict__.keys() == theirs.__dict__.keys()
        for name, value in theirs.__dict__.items():
            expected = ours if value is theirs else value
            assert type(ours.__dict__[name]) is type(value)
            assert ours.__dict__[name] == expected, name
        assert type(ours) is type(theirs)


class _Listener:
    def __init__(self):
        self.told = []

    def notifyChanged(self, notification):  # noqa: N802 -- pyecore's name
        said = (notification.kind.name, notification.old, notification.new)
        self.told.append((*said, notification.feature.name, notification.notifier.name))


@pytest.mark.parametrize("make", [new_object, lambda table: table.eclass()])
def test_values_that_stand_in_the_element_are_set_and_told_as_by_pyecore(make):
    component = make(load_metamodels().classes["jaus.Component"])
    listener = _Listener()
    component.listeners.append(listener)
    component.name = "front"
    with pytest.raises(TypeError):
        component.name = 5
    assert component.name == "front"
    component.eSet("name", "rear")
    del component.name
    assert listener.told == [
        ("SET", None, "front", "name", "front"),
        ("SET", "front", "rear", "name", "rear"),
        ("UNSET", "rear", None, "name", None),
    ]
    component.remark = "no feature"
    del component.remark
    assert not hasattr(component, "remark")


def test_a_value_that_is_refused_leaves_the_element_as_it_was():
    component = new_object(load_metamodels().classes["jaus.Component"])
    with pytest.raises(TypeError):
        component.name = 5
    assert component.name is None
    assert not component.eIsSet("name")
