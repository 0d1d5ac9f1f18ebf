"""Each finding at its place: ⟦JMLnnn⟧ stands where it must be, and nothing else is found."""

import re
from pathlib import Path

import pytest
from for_each import for_each
from reader_support import XMLNS, zoo

from jausml.language.model import READER_RULES, Severity, conflicts

LION = '<animals xsi:type="zoo:Lion" name="L" legs="4"/>'
CAGE = f'<cages id="c1">{LION}</cages>'

XML = {
    "not_closed": zoo("  <cages>").replace("</zoo:Zoo", "</⟦JML004⟧zoo:Zoo"),
    "not_xml": "⟦JML004⟧hello\n",
    "conflict": zoo('⟦JML009⟧<<<<<<< HEAD\n<cages id="a"/>\n=======\n<cages/>\n>>>>>>> x'),
    "doctype": zoo().replace("<zoo:Zoo", '⟦JML007⟧<!DOCTYPE z [<!ENTITY e "x">]>\n<zoo:Zoo'),
    "empty": "⟦JML003⟧",
    "blank": "⟦JML003⟧ \n ",
    "lfs": "⟦JML005⟧version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 1\n",
    "encoding": '⟦JML006⟧<?xml version="1.0" encoding="x-none"?>\n<a/>',
    "schema_location": zoo(
        attributes='⟦JML010⟧xsi:schemaLocation="http://www.example.org/zoo/1.0 x.ecore" name="Z"'
    ),
    "empty_xmi": f"⟦JML011⟧<xmi:XMI {XMLNS}/>",
    "stray_text": zoo("  hello").replace("<zoo:Zoo", "⟦JML012⟧<zoo:Zoo"),
    "stray_text_below": zoo("  ⟦JML012⟧<cages>hello</cages>"),
    "prefix": zoo("", 'name="Z"').replace("<zoo:Zoo", "⟦JML013⟧<zoo:Zoo").replace("xsi", "q"),
}
CONFORMANCE = {
    "namespace": '⟦JML101⟧<zoo:Zoo xmlns:zoo="http://www.example.org/zoo/2.0" name="Z"/>',
    "no_namespace": '⟦JML101⟧<Zoo name="Z"/>',
    "type_prefix": zoo('<cages><animals ⟦JML101⟧xsi:type="zo:Lion" name="x"/></cages>'),
    "type_without_prefix": zoo('<cages><animals ⟦JML101⟧xsi:type="Lion" name="x"/></cages>'),
    "type_unknown": zoo('<cages>\n<animals name="x"\n ⟦JML102⟧xsi:type="zoo:Loin"/></cages>'),
    "root_class": f'⟦JML102⟧<zoo:Zooo {XMLNS} name="Z"/>',
    "unknown_attribute": zoo("", '⟦JML103⟧colour="red" name="Z"'),
    "unknown_attribute_below": zoo('<cages ⟦JML103⟧colour="red"/>'),
    "unknown_child": zoo("<cages/>\n  ⟦JML103⟧<wheels><more/></wheels>"),
    "misspelt_required": zoo("", '⟦JML103⟧nam="Z"'),
    "misspelt_required_child": zoo("⟦JML103⟧<Name>Z</Name>", ""),
    "foreign_attribute": zoo("", 'xmlns:o="urn:o" ⟦JML103⟧o:colour="red" name="Z"'),
    "foreign_child": zoo('⟦JML103⟧<o:cages xmlns:o="urn:o"/>'),
    "elements_in_attribute": zoo("<name>⟦JML103⟧<b/></name>", ""),
    "abstract": zoo('<cages>⟦JML104⟧<animals name="x"/></cages>'),
    "abstract_type": zoo('<cages><animals ⟦JML104⟧xsi:type="zoo:Animal" name="x"/></cages>'),
    "abstract_root": f'⟦JML104⟧<zoo:Animal {XMLNS} name="x"/>',
    "abstract_href": zoo(CAGE + '⟦JML104⟧<star href="#//@cages.0/@animals.0"/>'),
    "literal": zoo(f"<cages>{LION}</cages>".replace("legs", '⟦JML105⟧kind="plant" legs')),
    "integer": zoo(f"<cages>{LION}</cages>".replace('legs="4"', '⟦JML106⟧legs="four"')),
    "boolean": zoo(f"<cages>{LION}</cages>".replace("legs", '⟦JML106⟧tame="1" legs')),
    "real": zoo("<cages>⟦JML106⟧<corners>INF</corners></cages>"),
    "list": zoo("", '⟦JML106⟧codes="1 x 3" name="Z"'),
    "pattern": zoo(f"<cages>{LION}</cages>".replace("legs", '⟦JML107⟧code="0x405" legs')),
    "required": zoo("", "").replace("<zoo:Zoo", "⟦JML108⟧<zoo:Zoo"),
    "required_nil": zoo('<name xsi:nil="true"/>', "").replace("<zoo:Zoo", "⟦JML108⟧<zoo:Zoo"),
    "required_unsettable": zoo('⟦JML108⟧<keepers name="k" shift="1 2"/>'),
    "too_many": zoo("", '⟦JML109⟧codes="1 2 3 4" name="Z"'),
    "too_many_elements": zoo("<codes>1</codes>" * 4).replace("<zoo:Zoo", "⟦JML109⟧<zoo:Zoo"),
    "too_few": zoo('<keepers name="k" badge="0" ⟦JML110⟧shift="1"/>'),
    "two_elements": zoo("<name>A</name>⟦JML111⟧<name>B</name>", ""),
    "attribute_and_element": zoo("⟦JML111⟧<name>A</name>"),
    "two_targets": zoo(CAGE + '<cages id="c2"/>', '⟦JML111⟧main="c1 c2" name="Z"'),
    "derived": zoo(f"<cages>{LION}</cages>".replace("legs", '⟦JML112⟧label="x" legs')),
    "wrong_class": zoo('<cages><animals ⟦JML113⟧xsi:type="zoo:Keeper" name="x"/></cages>'),
    "contained_as_attribute": zoo("", '⟦JML114⟧branches="//@cages.0" name="Z"'),
    "reference_as_child": zoo('⟦JML115⟧<main id="m"/>'),
    "reference_as_text": zoo(CAGE + "⟦JML115⟧<main>c1</main>"),
}
REFERENCES = {
    "duplicate_id": zoo('<cages id="x"/>\n⟦JML201⟧<cages id="x"/>'),
    "duplicate_xmi_id": zoo('<cages xmi:id="x"/>\n<cages ⟦JML201⟧xmi:id="x"/>'),
    "id": zoo(CAGE, '⟦JML202⟧main="c9" name="Z"'),
    "path": zoo(CAGE, 'name="Z" ⟦JML202⟧main="//@cages.1"'),
    "path_feature": zoo(CAGE, 'name="Z" ⟦JML202⟧main="//@cage.0"'),
    "path_without_index": zoo(CAGE, 'name="Z" ⟦JML202⟧main="//@cages"'),
    "path_through_value": zoo("<tags>a</tags>", 'name="Z" ⟦JML202⟧main="//@tags.0"'),
    "root_index": zoo(CAGE, 'name="Z" ⟦JML202⟧main="/1"'),
    "root_name": zoo(CAGE, 'name="Z" ⟦JML202⟧main="/x"'),
    "predicate": zoo(CAGE, "name='Z' ⟦JML202⟧main=\"//@cages[id='c9']\""),
    "predicate_unfinished": zoo(CAGE, "name='Z' ⟦JML202⟧main=\"//@cages[id='c1]\""),
    "one_of_many": zoo('<cages id="c1" ⟦JML202⟧neighbours="c1 c8"/>'),
    "missing_file": zoo('<main ⟦JML203⟧href="no.xmi#/"/>\n<branches href="no.xmi#x"/>'),
    "missing_fragment": zoo('<main ⟦JML204⟧href="lib.xmi#nowhere"/>'),
    "no_fragment": zoo('<main ⟦JML204⟧href="lib.xmi"/>'),
    "class": zoo(CAGE, '⟦JML205⟧main="//@cages.0/@animals.0" name="Z"'),
    "class_href": zoo('<main ⟦JML205⟧href="lib.xmi#/"/>'),
    "class_contained": zoo('<cages ⟦JML205⟧href="lib.xmi#/"/>'),
    "cycle_self": zoo('<branches ⟦JML206⟧href="model.xmi#/"/>'),
    "contained_twice": zoo('<cages href="cage.xmi#/"/>\n<cages ⟦JML207⟧href="cage.xmi#/"/>'),
    "contained_elsewhere": zoo('<cages ⟦JML207⟧href="lib.xmi#in-lib"/>'),
    "container": zoo('<branches name="B"/><cages ⟦JML207⟧zoo="//@branches.0"/>'),
    "http": zoo('<main ⟦JML208⟧href="http://www.example.org/x.xmi#/"/>'),
    "outside": zoo('<main ⟦JML209⟧href="../../x.xmi#/"/>'),
    "project": zoo('<main ⟦JML210⟧href="platform:/resource/nowhere/x.xmi#/"/>'),
    "scheme": zoo('<main ⟦JML211⟧href="pathmap://P/x.xmi#/"/>'),
    "windows": zoo('<main ⟦JML211⟧href="C:\\models\\x.xmi#/"/>'),
    "library": zoo('<main ⟦JML212⟧href="http://www.jausml.org/library/jaus/nothing.xmi#/"/>'),
    "repeated": zoo('<cages id="a"/><cages ⟦JML213⟧neighbours="a //@cages.0"/>'),
    "repeated_value": zoo("", '⟦JML213⟧tags="a b a" name="Z"'),
    "repeated_value_element": zoo("<tags>a</tags>⟦JML213⟧<tags>a</tags>"),
    "by_name": zoo('<cages ⟦JML214⟧keepers="//K"/><keepers name="K" badge="0" shift="1 2"/>'),
}  # fmt: skip
TEXTS = {**XML, **CONFORMANCE, **REFERENCES}


@for_each("name", TEXTS)
def test_finding(name, documents):
    documents.write("lib.xmi", zoo('<cages id="in-lib"/>', 'name="Lib"'))
    documents.write("cage.xmi", f'<zoo:Cage {XMLNS} id="part"/>')
    for finding in documents.check(TEXTS[name]).diagnostics:
        assert finding.severity is READER_RULES[finding.rule].severity
        assert finding.message
        assert (
            finding.message[0].islower()
            or not finding.message[0].isalpha()
            or (finding.message.startswith(("Eclipse", "Cage", "Zoo", "Git")))
        ), finding.message
        assert "\n" not in finding.message


def test_every_rule_has_a_failing_text():
    shown = set(re.findall(r"JML\d\d\d", str(TEXTS)))
    elsewhere = {"JML001", "JML002", "JML008"}  # test_files.py
    elsewhere |= {"JML215", "JML216"}  # tests/text/test_names.py
    assert shown | elsewhere == set(READER_RULES)


def test_rules_are_data():
    for rule, info in READER_RULES.items():
        assert re.fullmatch(r"JML[0-2]\d\d", rule)
        assert info.title
        assert info.title[-1] != "."
        assert info.explanation.endswith(".")
        assert isinstance(info.severity, Severity)
    titles = [info.title for info in READER_RULES.values()]
    assert len(titles) == len(set(titles))


def test_ids_in_the_sources_are_known():
    package = Path(__file__).parents[2] / "jausml" / "language" / "model"
    used = {
        rule
        for path in package.glob("*.py")
        for rule in re.findall(r"JML\d\d\d", path.read_text(encoding="utf-8"))
    }
    assert used == set(READER_RULES)


@pytest.mark.slow
def test_conflicts_without_end_are_counted_once_through():
    """A hostile file: each mark is counted from the one before it, and few are named."""
    marks = b"<<<<<<< a\n=======\n>>>>>>> b\n"
    said, first = conflicts.unmerged(b"text\n" + marks * 200_000)
    assert first == 2
    assert said.endswith("stands in lines 2-4, 5-7, 8-10, 11-13, 14-16, and 199995 more")
