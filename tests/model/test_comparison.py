"""Two models are compared feature by feature."""

import pytest

from jausml.language.model import read_models
from jausml.language.model.comparison import EXACT, ON_THE_WIRE, compare

TEXT = """<?xml version="1.0" encoding="UTF-8"?>
<jaus:ServiceSet xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
 xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
 xmlns:jaus="http://www.jausml.org/jaus/1.0" name="set">
 <services name="Base" urn="urn:a:Base">
  <inputs name="Query" code="0x2001"/>
  <inputs name="Set" code="0x0001" isCommand="true">
   <body xsi:type="jaus:Record" name="Rec">
    <fields xsi:type="jaus:FixedField" name="A"><scale lower="0.0" upper="1.0"/></fields>
    <fields xsi:type="jaus:FixedField" name="B" type="uint16" units="meter"/>
   </body>
  </inputs>
 </services>
 <services name="Heir" urn="urn:a:Heir" inherits="//@services.0"/>
</jaus:ServiceSet>
"""
A = '    <fields xsi:type="jaus:FixedField" name="A"><scale lower="0.0" upper="1.0"/></fields>\n'
B = '    <fields xsi:type="jaus:FixedField" name="B" type="uint16" units="meter"/>\n'
QUERY = '  <inputs name="Query" code="0x2001"/>\n'


@pytest.fixture
def differences(tmp_path):
    def run(second, policy=EXACT):
        roots = []
        for name, text in (("first", TEXT), ("second", second)):
            path = tmp_path / f"{name}.xmi"
            path.write_text(text, encoding="utf-8")
            result = read_models([path], project_root=tmp_path)
            assert not result.has_errors, result.diagnostics
            roots.append(result.model)
        first, other = roots
        found = compare(first.root, other.root, first.metamodels, policy)
        return [str(difference) for difference in found]

    return run


def test_a_model_is_as_itself(differences):
    assert differences(TEXT) == []


@pytest.mark.parametrize(
    ("old", "new", "difference"),
    [
        ('code="0x0001"', 'code="0x0002"', "set/Base/Set: code: 0x0001 / 0x0002"),
        (' isCommand="true"', "", "set/Base/Set: isCommand: True / False"),
        ('type="uint16"', 'type="int16"', "set/Base/Set/Rec/B: type: uint16 / int16"),
        ('units="meter"', 'units="radian"', "set/Base/Set/Rec/B: units: meter / radian"),
        ('upper="1.0"', 'upper="2.0"', "set/Base/Set/Rec/A/scale: upper: 1.0 / 2.0"),
        ('inherits="//@services.0"', "", "set/Heir: inherits: urn:a:Base 1.0 / nothing"),
        (B, "", "set/Base/Set/Rec: fields: B / nothing"),
        (
            'xsi:type="jaus:FixedField" name="B" type="uint16" units="meter"',
            'xsi:type="jaus:FixedLengthString" name="B" length="2"',
            "set/Base/Set/Rec/B: class: FixedField / FixedLengthString",
        ),
        (
            "</jaus:ServiceSet>",
            '<services name="C" urn="u"/></jaus:ServiceSet>',
            "set: services: nothing / C",
        ),
    ],
)
@pytest.mark.parametrize("policy", [EXACT, ON_THE_WIRE], ids=["exact", "wire"])
def test_a_difference_is_named(differences, old, new, difference, policy):
    assert old in TEXT
    assert differences(TEXT.replace(old, new), policy) == [difference]


def test_the_order_of_fields_counts_and_that_of_messages_may_not(differences):
    swapped = TEXT.replace(A + B, B + A)
    assert "set/Base/Set/Rec/A: name: A / B" in differences(swapped, ON_THE_WIRE)
    moved = TEXT.replace(QUERY, "").replace(" </services>\n", QUERY + " </services>\n", 1)
    assert differences(moved, ON_THE_WIRE) == []
    assert differences(moved)


def test_what_nobody_sends_does_not_count_on_the_wire(differences):
    prose = TEXT.replace('name="Base"', 'name="Base" documentation="x"')
    assert differences(prose, ON_THE_WIRE) == []
    assert differences(prose) == ["set/Base: documentation: nothing / x"]
    close = TEXT.replace('upper="1.0"', 'upper="1.00000000000001"')
    assert differences(close, ON_THE_WIRE) == []
    assert len(differences(close)) == 1
    still = TEXT.replace('isCommand="true"', 'isCommand="true" moves="false"')
    assert differences(still, ON_THE_WIRE) == []
    assert len(differences(still)) == 1
    axes = TEXT.replace('name="B"', 'name="B" frame="northEastDown"')
    assert differences(axes, ON_THE_WIRE) == []
    assert len(differences(axes)) == 1


def test_units_count_where_both_sides_state_them(differences):
    silent = TEXT.replace(' units="meter"', "")
    assert differences(silent, ON_THE_WIRE) == []
    assert len(differences(silent)) == 1


def test_a_difference_knows_its_elements(tmp_path):
    path = tmp_path / "a.xmi"
    path.write_text(TEXT, encoding="utf-8")
    first = read_models([path], project_root=tmp_path).model
    other = read_models([path], project_root=tmp_path).model
    other.root.services[0].inputs[0].code = "0x2002"
    (found,) = compare(first.root, other.root, first.metamodels)
    assert found.first_element is first.root.services[0].inputs[0]
    assert found.second_element is other.root.services[0].inputs[0]
    assert first.location(found.first_element).line == 6
