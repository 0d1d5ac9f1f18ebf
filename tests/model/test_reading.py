"""What Eclipse writes is read as EMF reads it; each trap of pyecore's own reader has a test."""

import math
from unittest.mock import Mock

import pytest
from reader_support import XMLNS, ZOO_METAMODELS, zoo

from jausml.language.model import Severity
from jausml.language.model.reading import references

LION = '<animals xsi:type="zoo:Lion" name="L" legs="4"/>'
CAGE = f'<cages id="c1">{LION}</cages>'


def test_enumeration_by_literal(documents):
    model = documents.good(zoo(f"<cages>{LION}</cages>".replace("legs", 'kind="plant-eater" legs')))
    assert model.root.cages[0].animals[0].kind.name == "PLANT_EATER"


def test_default_of_enumeration_by_literal(documents):
    lion = documents.good(zoo(CAGE)).root.cages[0].animals[0]
    assert lion.kind.literal == "meat-eater"
    assert lion.age == 6
    assert lion.code is None
    assert lion.legs == 4


def test_same_relative_href_from_two_folders(documents):
    for folder in "ab":
        cage = f'<cages id="x">{LION}</cages>'.replace('"L"', f'"{folder}"')
        documents.write(f"{folder}/lib.xmi", zoo(cage))
        documents.write(f"{folder}/sys.xmi", zoo('<main href="lib.xmi#x"/>', f'name="{folder}"'))
    result = documents.read("a/sys.xmi", "b/sys.xmi")
    assert result.diagnostics == []
    names = [root.main.animals[0].name for root in result.model.roots[:2]]
    assert names == ["a", "b"]


def test_comments_instructions_and_cdata(documents):
    model = documents.good(
        zoo(
            "<!-- a --><?pi x?><cages><!-- b --></cages><tags><!-- c -->v1</tags>"
            "<tags>a<!-- d -->b</tags><tags><![CDATA[<x>&]]></tags>"
        )
    )
    assert list(model.root.tags) == ["v1", "ab", "<x>&"]


def test_schema_location_is_not_followed(documents):
    documents.write("zoo.ecore", "this is no metamodel")
    where = 'xsi:schemaLocation="http://www.example.org/zoo/1.0 zoo.ecore urn:other x.ecore"'
    documents.good(zoo(CAGE, f'{where} name="Z"'))


def test_schema_location_with_another_name_is_information(documents):
    where = 'xsi:schemaLocation="http://www.example.org/zoo/1.0 ../old/zoos.ecore#/" name="Z"'
    result = documents.one(zoo(CAGE, where))
    assert [diagnostic.severity for diagnostic in result.diagnostics] == [Severity.INFO]
    assert not result.has_errors


def test_sub_packages(documents):
    parrot = '<animals xsi:type="birds:Parrot" name="p" legs="2"><words>a b</words></animals>'
    model = documents.good(zoo(f"<cages>{parrot}</cages>"))
    parrot = model.root.cages[0].animals[0]
    assert parrot.eClass.name == "Parrot"
    assert list(parrot.words) == ["a b"]


def test_prefixes_are_free(documents):
    text = zoo('<cages><animals q:type="z:Lion" name="L" legs="4"/></cages>')
    text = text.replace("xmlns:xsi", "xmlns:q").replace(
        "<zoo:Zoo", '<zoo:Zoo xmlns:z="http://www.example.org/zoo/1.0"'
    )
    result = documents.one(text)
    assert [diagnostic.rule for diagnostic in result.diagnostics] == ["JML013"]
    assert result.model.root.cages[0].animals[0].name == "L"


def test_namespaces_declared_on_children(documents):
    body = (
        '<cages><animals xmlns:b="http://www.example.org/zoo/birds/1.0" xsi:type="b:Parrot"'
        ' name="p" legs="2"/></cages>'
    )
    assert documents.good(zoo(body)).root.cages[0].animals[0].eClass.name == "Parrot"


def test_inner_declaration_ends_with_its_element(documents):
    body = (
        '<cages><animals xmlns:b="http://www.example.org/zoo/birds/1.0" xsi:type="b:Parrot"'
        ' name="p" legs="2"/><animals ⟦JML101⟧xsi:type="b:Parrot" name="q" legs="2"/></cages>'
    )
    documents.check(zoo(body))


def test_default_namespace(documents):
    text = '<Zoo xmlns="http://www.example.org/zoo/1.0" name="A"><cages id="q"/></Zoo>'
    assert documents.good(text).root.cages[0].id == "q"


def test_values_as_elements_and_in_attributes(documents):
    model = documents.good(
        zoo("<codes>1</codes><codes>1</codes><tags>a b</tags><founded>-5</founded>", 'name="Z"')
    )
    root = model.root
    assert (list(root.codes), list(root.tags), root.founded) == ([1, 1], ["a b"], -5)
    model = documents.good(zoo('<cages corners="1 -2.5e3 NaN -Infinity"/>', 'name="" codes="1 +2"'))
    corners = list(model.root.cages[0].corners)
    assert corners[:2] == [1.0, -2500.0]
    assert math.isnan(corners[2])
    assert corners[3] == -math.inf
    assert (model.root.name, list(model.root.codes)) == ("", [1, 2])


def test_nil(documents):
    parrot = '<animals xsi:type="birds:Parrot" legs="2" name="p"><code xsi:nil="1"/></animals>'
    body = f'<founded xsi:nil="true"/><star xsi:nil="true"/><cages>{parrot}</cages>'
    root = documents.good(zoo(body)).root
    assert root.founded == 0, "as in EMF, a number cannot be null"
    assert root.star is None
    assert root.cages[0].animals[0].code is None
    assert root.cages[0].animals[0].eIsSet("code")


def test_unsettable_false_is_kept(documents):
    tame = LION.replace("legs", 'tame="false" legs')
    lion, other = documents.good(zoo(f"<cages>{tame}{LION}</cages>")).root.cages[0].animals
    assert lion.eIsSet("tame")
    assert not other.eIsSet("tame")


@pytest.mark.parametrize(
    "reference",
    [
        'main="c2"',
        'main="#c2"',
        'main="//@cages.1"',
        'main="/0/@cages.1"',
        'main="#//@cages.1"',
        "main=\"//@cages[id='c2']\"",
        'main="//@cages.1?Cage?"',
        'main="zoo:Cage model.xmi#c2"',
        'main="model.xmi#//@cages.1"',
    ],
)
def test_local_references(documents, reference):
    root = documents.good(zoo(CAGE + '<cages id="c2"/>', f'name="Z" {reference}')).root
    assert root.main is root.cages[1]


@pytest.mark.parametrize(
    "element",
    [
        '<main href="#c2"/>',
        '<main href="model.xmi#c2"/>',
        '<main xsi:type="zoo:Cage" href="model.xmi#//@cages.1"/>',
        '<main xmi:idref="c2"/>',
        '<main href="./sub/../model.xmi#c2"/>',
    ],
)
def test_reference_elements(documents, element):
    root = documents.good(zoo(CAGE + '<cages id="c2"/>' + element)).root
    assert root.main is root.cages[1]


def test_order_of_mixed_references(documents):
    body = (
        f"<cages>{LION}{LION.replace('L', 'M').replace('Mion', 'Lion')}</cages>"
        '<favourites xsi:type="zoo:Lion" href="lib.xmi#//@cages.0/@animals.0"/>'
        '<favourites xsi:type="zoo:Lion" href="#//@cages.0/@animals.0"/>'
    )
    documents.write("lib.xmi", zoo(CAGE.replace('"L"', '"far"')))
    root = documents.good(zoo(body, 'name="Z" favourites="//@cages.0/@animals.1"')).root
    assert [favourite.name for favourite in root.favourites] == ["M", "far", "L"]


def test_many_roots(documents):
    text = (
        f'<xmi:XMI {XMLNS}>\n<zoo:Zoo name="A" main="/1/@cages.0"/>\n'
        '<zoo:Zoo name="B"><cages/></zoo:Zoo>\n</xmi:XMI>'
    )
    model = documents.good(text)
    first, second = model.roots
    assert first.main is second.cages[0]
    assert model.fragment(second.cages[0]) == "/1/@cages.0"
    assert [model.fragment(root) for root in model.roots] == ["/0", "/1"]


def test_percent_encoded_href(documents):
    documents.write("my lib é.xmi", zoo('<cages id="x"/>'))
    root = documents.good(zoo('<main href="my%20lib%20%C3%A9.xmi#x"/>')).root
    assert root.main.id == "x"


def test_containment_proxies_keep_the_order(documents):
    documents.write("part.xmi", f'<zoo:Cage {XMLNS} id="part">{LION}</zoo:Cage>')
    text = zoo('<cages id="a"/><cages href="part.xmi#/"/><cages id="b"/>',
               'name="Z" main="//@cages.2" star="//@cages.1/@animals.0"')  # fmt: skip
    model = documents.good(text)
    root = model.root
    assert [cage.id for cage in root.cages] == ["a", "part", "b"]
    assert root.main is root.cages[2]
    assert root.star is root.cages[1].animals[0]
    part = root.cages[1]
    assert part.eContainer() is root
    assert part.zoo is root
    assert model.location(part).path.endswith("part.xmi")
    assert model.element_path(part) == "Z/cages[1]"
    assert model.fragment(part) == "part"
    assert model.path_of(part.animals[0]) == "//@animals.0"


def test_containment_cycle_over_files(documents):
    documents.write("model.xmi", zoo('<branches href="other.xmi#/"/>'))
    documents.write("other.xmi", zoo('<branches href="model.xmi#/"/>', 'name="O"'))
    result = documents.read("model.xmi")
    assert [diagnostic.rule for diagnostic in result.diagnostics] == ["JML206"]


def test_href_chains_that_never_end(documents):
    text = zoo('<branches href="#//@branches.0"/>', 'name="Z" main="//@branches.0/@cages.0"')
    rules = [diagnostic.rule for diagnostic in documents.one(text).diagnostics]
    assert set(rules) <= {"JML202", "JML206"}
    assert rules


def test_opposites_follow_from_one_end(documents):
    body = (
        '<cages id="c1" partner="c2" keepers="//@keepers.0"/><cages id="c2"/>'
        '<keepers name="k" badge="0" shift="1 2"/>'
    )
    root = documents.good(zoo(body)).root
    first, second = root.cages
    assert second.partnerOf is first
    assert list(root.keepers[0].cares) == [first]
    assert first.zoo is root


def test_opposites_written_at_both_ends_are_not_doubled(documents):
    body = (
        '<cages id="c1" partner="c2" keepers="//@keepers.0"/><cages id="c2" partnerOf="c1"/>'
        '<keepers name="k" badge="0" shift="1 2" cares="c1"/>'
    )
    root = documents.good(zoo(body)).root
    assert list(root.cages[0].keepers) == [root.keepers[0]]
    assert list(root.keepers[0].cares) == [root.cages[0]]


def test_reflection(documents):
    root = documents.good(zoo(CAGE, 'name="Z" main="c1"')).root
    cage = root.cages[0]
    feature = root.eClass.findEStructuralFeature("cages")
    assert cage.eContainer() is root
    assert cage.eContainmentFeature() is feature
    assert root.eGet("main") is root.eGet(root.eClass.findEStructuralFeature("main")) is cage
    assert root.eContents == [cage]
    assert [element.eClass.name for element in root.eAllContents()] == ["Cage", "Lion"]
    assert root.eIsSet("main")
    assert not root.eIsSet("star")
    assert root.eResource is None
    assert cage.animals[0].eURIFragment() == "//@cages.0/@animals.0"
    root.eSet("name", "Y")
    assert root.name == "Y"
    assert isinstance(cage, ZOO_METAMODELS.classes["zoo.Cage"].eclass)


def test_many_faults_in_one_run(documents):
    documents.check(
        zoo(
            '  <cages id="x" ⟦JML103⟧colour="r"/>\n'
            '  ⟦JML201⟧<cages id="x">\n'
            '    <animals xsi:type="zoo:Lion" name="a" ⟦JML105⟧kind="k" ⟦JML106⟧legs="a"/>\n'
            '    ⟦JML108⟧<animals xsi:type="zoo:Lion" legs="4"/>\n'
            "  </cages>\n"
            '  <main ⟦JML203⟧href="absent.xmi#/"/>\n'
            "  ⟦JML103⟧<wheels/>"
        )
    )


def test_one_cause_is_one_error(documents):
    # The required name is misspelt; the target of `star` is of an unknown class; the document that
    # `main` refers to is broken: none of them is reported a second time.
    documents.write("broken.xmi", "<zoo")
    result = documents.one(
        zoo(
            '<cages><animals xsi:type="zoo:Tiger"/></cages><main href="broken.xmi#x"/>',
            'nam="Z" star="//@cages.0/@animals.0"',
        )
    )
    rules = {diagnostic.rule for diagnostic in result.diagnostics}
    assert (rules, len(result.diagnostics)) == ({"JML004", "JML102", "JML103"}, 3)


def test_missing_file_is_counted(documents):
    body = '<main href="absent.xmi#x"/>' + "".join(
        f'<favourites xsi:type="zoo:Lion" href="absent.xmi#{n}"/>\n' for n in range(20)
    )
    (finding,) = documents.one(zoo(body)).diagnostics
    assert "(21 references)" in finding.message
    assert len(finding.related) == 10


def test_duplicate_id_names_the_first(documents):
    (finding,) = documents.one(zoo('<cages id="x"/>\n<cages id="x"/>')).diagnostics
    (related,) = finding.related
    assert (related.location.line, related.location.column) == (4, 1)


def test_collector_is_left_as_it_was(documents):
    import gc

    gc.disable()
    try:
        documents.good(zoo())
        assert not gc.isenabled()
    finally:
        gc.enable()
    documents.good(zoo())
    assert gc.isenabled()


def test_only_declared_features_and_typed_values(documents):
    # pyecore's setters accept unknown names, strings for enumerations and booleans for integers.
    model = documents.good(zoo(CAGE.replace("legs", 'tame="true" age="3" kind="meat-eater" legs')))
    lion = model.root.cages[0].animals[0]
    declared = set(ZOO_METAMODELS.classes["zoo.Lion"].features)
    private = set(vars(ZOO_METAMODELS.classes["zoo.Lion"].eclass()))
    assert set(vars(lion)) - private <= declared
    assert (lion.tame, type(lion.age), type(lion.kind).__name__) == (True, int, "EEnumLiteral")


def test_big_documents_do_not_take_quadratic_time(documents, monkeypatch):
    # Bounded by the number of steps, not by a clock: comparisons of ids are counted.
    close_matches = Mock(return_value=[])
    monkeypatch.setattr(references, "get_close_matches", close_matches)
    body = "".join(f'<cages id="c{n}" neighbours="d{n}"/>' for n in range(500))
    assert len(documents.one(zoo(body)).diagnostics) == 500
    assert 0 < close_matches.call_count <= 50
