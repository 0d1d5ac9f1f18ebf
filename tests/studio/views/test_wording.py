"""What is told to people: no places in files and no names of the metamodels."""

import pytest

from jausml.authoring.studio.views.wording import for_people

TOLD = {
    "there is no element robot.xmi#//@components.3 any more": (
        "there is no component 4 of robot.xmi any more"
    ),
    "there is no element 'a/b.xmi#//@bridges.0/@connections.2' any more": (
        "there is no connection 3 of bridge 1 of a/b.xmi any more"
    ),
    "there is no element robot.xmi#Winch.State any more": (
        "there is no Winch.State of robot.xmi any more"
    ),
    "map refers to a bridge.AttributeMap, but r.xmi#//@maps.0/@entry is a jaus.Component": (
        "map refers to an attribute map, but entry of map 1 of r.xmi is a component"
    ),
    "library:/jaus/mobility.xmi#PrimitiveDriver is part of the library": (
        "PrimitiveDriver of mobility.xmi of the library is part of the library"
    ),
    "silenceTimeout of ServiceConnection 'silenceTimeout' takes one value": (
        "silence timeout of service connection 'silenceTimeout' takes one value"
    ),
    "Component 'Bridge' is all of x.xmi: delete the file": (
        "component 'Bridge' is all of x.xmi: delete the file"
    ),
}


@pytest.mark.parametrize("text", TOLD)
def test_places_and_names_of_the_metamodels_become_words(text):
    assert for_people(text) == TOLD[text]


@pytest.mark.parametrize(
    "text",
    [
        "x.xmi cannot be parsed as it is: fix it first",
        "the name 'a.xmi' has no #",
        "Bridge is used",
    ],
)
def test_other_sentences_stay(text):
    assert for_people(text) == text
