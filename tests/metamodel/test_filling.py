"""Filling without notification leaves the state that pyecore's own setters leave."""

from pathlib import Path

import pytest

from jausml.language.metamodel import read_metamodels
from jausml.language.metamodel.filling import (
    add_values,
    contents,
    count,
    holds,
    link,
    new_object,
    set_value,
)

ZOO = read_metamodels([Path(__file__).parents[1] / "model" / "emf" / "zoo.ecore"])
CLASSES = ZOO.classes


def fill_ours():
    zoo, cage, other, lion, keeper = (
        new_object(CLASSES[name])
        for name in ("zoo.Zoo", "zoo.Cage", "zoo.Cage", "zoo.Lion", "zoo.Keeper")
    )
    of_zoo, of_cage = CLASSES["zoo.Zoo"].features, CLASSES["zoo.Cage"].features
    set_value(zoo, of_zoo["name"], "Z")
    add_values(zoo, of_zoo["codes"], [3, 3])
    add_values(zoo, of_zoo["tags"], ["a", "b"])
    set_value(lion, CLASSES["zoo.Lion"].features["tame"], False)
    link(zoo, of_zoo["cages"], cage)
    link(zoo, of_zoo["cages"], other)
    link(zoo, of_zoo["keepers"], keeper)
    link(cage, of_cage["animals"], lion)
    link(cage, of_cage["partner"], other)
    link(cage, of_cage["keepers"], keeper)
    link(zoo, of_zoo["star"], lion)
    link(zoo, of_zoo["favourites"], lion)
    return [zoo, cage, other, lion, keeper]


def fill_pyecore():
    zoo, cage, other, lion, keeper = (
        CLASSES[name].eclass()
        for name in ("zoo.Zoo", "zoo.Cage", "zoo.Cage", "zoo.Lion", "zoo.Keeper")
    )
    zoo.name = "Z"
    zoo.codes.extend([3, 3])
    zoo.tags.extend(["a", "b"])
    lion.tame = False
    zoo.cages.append(cage)
    zoo.cages.append(other)
    zoo.keepers.append(keeper)
    cage.animals.append(lion)
    cage.partner = other
    cage.keepers.append(keeper)
    zoo.star = lion
    zoo.favourites.append(lion)
    return [zoo, cage, other, lion, keeper]


def state(objects):
    """Everything that reflection can see, with objects replaced by their positions."""

    def name(value):
        return objects.index(value) if value in objects else value

    seen = []
    for obj in objects:
        for table in ZOO.class_of(obj).features.values():
            value = obj.eGet(table.feature)
            shown = [name(target) for target in value] if table.many else name(value)
            seen.append((objects.index(obj), table.name, shown))
            seen.append((table.name, type(value).__name__, obj.eIsSet(table.feature)))
        container = obj.eContainer()
        feature = obj.eContainmentFeature()
        inverse = {(objects.index(owner), reference.name) for owner, reference in obj._inverse_rels}
        seen.append((container and name(container), feature and feature.name, sorted(inverse)))
        seen.append(sorted(objects.index(e_content) for e_content in obj.eContents))
        seen.append(obj.eURIFragment())
    return seen


def test_same_state_as_the_setters():
    assert state(fill_ours()) == state(fill_pyecore())


def test_objects_can_be_changed_afterwards():
    zoo, cage, other, lion, _ = fill_ours()
    zoo.name = "Y"
    zoo.codes.append(4)
    cage.animals.remove(lion)
    other.animals.append(lion)
    cage.partner = None
    assert (zoo.name, list(zoo.codes)) == ("Y", [3, 3, 4])
    assert lion.eContainer() is other
    assert other.partnerOf is None
    lion.delete()
    assert zoo.star is None
    assert list(zoo.favourites) == []
    with pytest.raises(TypeError):
        zoo.name = 5


def test_counting():
    zoo, cage, other, *_ = fill_ours()
    features = CLASSES["zoo.Zoo"].features
    assert [count(zoo, features[name]) for name in ("name", "codes", "cages", "main")] == [
        1, 2, 2, 0,
    ]  # fmt: skip
    assert holds(zoo, features["cages"], cage)
    assert not holds(zoo, features["main"], cage)
    assert not holds(cage, CLASSES["zoo.Cage"].features["partner"], cage)
    assert holds(cage, CLASSES["zoo.Cage"].features["partner"], other)


def test_contents_are_told_without_a_trace():
    zoo, cage, other, *_ = fill_ours()
    of_zoo, of_cage = CLASSES["zoo.Zoo"].features, CLASSES["zoo.Cage"].features
    assert list(contents(zoo, of_zoo["cages"])) == [cage, other] == list(zoo.cages)
    assert list(contents(cage, of_cage["partner"])) == [other]

    empty = new_object(CLASSES["zoo.Zoo"])
    before = dict(empty.__dict__)
    assert not any(contents(empty, feature) for feature in CLASSES["zoo.Zoo"].contained)
    assert empty.__dict__ == before


def test_a_class_knows_the_features_that_own_elements():
    for table in CLASSES.values():
        owning = [
            feature.name for feature in table.features.values() if feature.feature.is_reference
        ]
        expected = [name for name in owning if table.features[name].feature.containment]
        assert [feature.name for feature in table.contained] == expected
