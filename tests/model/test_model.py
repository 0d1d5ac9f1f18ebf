"""Asking a model: instances, paths, fragments and places."""

import pytest
from reader_support import ZOO_METAMODELS, zoo

from jausml.language.metamodel.classes import jaus
from jausml.language.model import Diagnostic, Location, Model, Severity

BODY = """  <cages id="c1"
      corners="1 2">
    <animals xsi:type="zoo:Lion" name="Leo" legs="4"/>
    <animals xsi:type="birds:Parrot" name="Polly" legs="2">
      <words>hello</words>
    </animals>
  </cages>
  <cages/>
  <branches name="B"><cages id="c3"/></branches>
  <tags>t</tags>"""


@pytest.fixture
def model(documents):
    return documents.good(zoo(BODY))


def place(model, *path):
    location = model.location(*path)
    return location.line, location.column


def test_instances(model):
    def kind(qualified):
        return model.metamodels.classes[qualified].python_class

    def names(qualified):
        return [model.element_path(element) for element in model.instances(kind(qualified))]

    assert names("zoo.Animal") == ["Z/cages[0]/Leo", "Z/cages[0]/Polly"]
    assert names("birds.Parrot") == ["Z/cages[0]/Polly"]
    assert names("zoo.Cage") == ["Z/cages[0]", "Z/cages[1]", "Z/B/cages[0]"]
    assert names("zoo.Zoo") == ["Z", "Z/B"]
    with pytest.raises(KeyError):
        model.instances(jaus.Component)


def test_fragments(model):
    root = model.root
    first, second = root.cages
    assert model.fragment(root) == "/"
    assert model.fragment(first) == "c1"
    assert model.path_of(first) == "//@cages.0"
    assert model.fragment(second) == "//@cages.1"
    assert model.fragment(first.animals[1]) == "//@cages.0/@animals.1"


def test_fragments_lead_back(model, documents):
    for element in model.elements():
        if element.eClass.name == "Cage":
            text = zoo(f'<main href="model.xmi#{model.path_of(element)}"/>')
            documents.write("other.xmi", text)
            other = documents.read("other.xmi").model
            assert other.path_of(other.root.main) == model.path_of(element)


def test_locations(model):
    cage = model.root.cages[0]
    assert place(model, model.root) == (2, 1)
    assert place(model, model.root, "name") == (3, 5)
    assert place(model, cage) == (4, 3)
    assert place(model, cage, "id") == (4, 10)
    assert place(model, cage, "corners") == (5, 7)
    assert place(model, cage, "animals") == (6, 5)
    assert place(model, cage.animals[1], "words") == (8, 7)
    assert place(model, cage, "partner") == (4, 3)


def test_location_of_elements_that_were_not_read(model):
    lion = ZOO_METAMODELS.classes["zoo.Lion"].eclass()
    assert model.location(lion) == Location("<model>", 1, 1)
    assert model.fragment(lion) == ""
    assert model.document_of(lion) is None
    assert not model.is_library(lion)
    assert model.element_path(lion) == "Lion"
    model.root.cages[1].animals.append(lion)
    assert model.location(lion, "legs") == model.location(model.root.cages[1])
    assert model.fragment(lion) == "//@cages.1/@animals.0"


def test_attribute_values_that_look_like_attributes(documents):
    text = zoo(attributes='name=" id=&quot;x&quot; founded=\'1\' > " founded = "7"')
    model = documents.good(text)
    assert place(model, model.root, "founded") == (
        3,
        5 + len("name=\" id=&quot;x&quot; founded='1' > \" "),
    )


def test_long_start_tags(documents):
    model = documents.good(zoo(attributes=f'name="{"x" * 20_000}"\n   founded="1"'))
    assert place(model, model.root, "founded") == (4, 4)


def test_owned_is_in_metamodel_order(documents):
    model = documents.good(
        zoo('<branches name="B"/><keepers name="K" badge="1" shift="1 2"/><cages/>')
    )
    assert [element.eClass.name for element in model.owned(model.root)] == ["Cage", "Keeper", "Zoo"]


def test_elements_in_document_order(model):
    lines = [model.location(element).line for element in model.elements()]
    assert lines == sorted(lines)
    assert len(lines) == 7


def test_empty_model():
    model = Model([], ZOO_METAMODELS)
    assert (model.root, model.roots, list(model.elements())) == (None, [], [])


def test_findings_name_their_element(documents):
    (finding,) = documents.one(
        zoo('<cages>\n<animals xsi:type="zoo:Lion" legs="4"/></cages>')
    ).diagnostics
    assert finding.element == "Z/cages[0]/animals[0]"
    assert finding.fragment == "//@cages.0/@animals.0"
    assert str(finding).endswith(
        "model.xmi:5:1: error: JML108 required feature 'name' of Lion is missing (it takes EString)"
    )


def test_findings_are_sorted():
    def finding(rule, line, column):
        return Diagnostic(rule, Severity.ERROR, Location("a.xmi", line, column), "m")

    first, second, third = finding("JML103", 1, 2), finding("JML101", 2, 1), finding("JML102", 2, 1)
    assert sorted([third, second, first]) == [first, second, third]
    assert sorted([Location("b"), Location("a", 10), Location("a", 9)])[0].line == 9
