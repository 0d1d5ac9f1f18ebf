"""Files: what cannot be read, encodings, limits, and places in all of them."""

import codecs

import pytest
from reader_support import XMLNS, ZOO_METAMODELS, zoo

from jausml.language.model import Location, read_models
from jausml.language.model.files import LIMIT
from jausml.language.model.xmi import parsing
from jausml.language.text.notation import NOTATIONS


def rules(result):
    return [diagnostic.rule for diagnostic in result.diagnostics]


def test_missing_file(documents):
    result = documents.read("absent.xmi")
    assert rules(result) == ["JML001"]
    assert result.diagnostics[0].location == Location(str(documents.folder / "absent.xmi"), 1, 1)
    assert result.model.root is None


def test_folder(documents):
    documents.write("sub/x.xmi", zoo())
    assert rules(documents.read("sub")) == ["JML001"]


def test_no_files():
    result = read_models([])
    assert (result.diagnostics, result.model.roots, result.model.root) == ([], [], None)


def test_one_bad_file_does_not_hide_another(documents):
    documents.write("a.xmi", "<a")
    documents.write("b.xmi", zoo("<wheels/>"))
    result = documents.read("a.xmi", "absent.xmi", "b.xmi")
    assert rules(result) == ["JML004", "JML001", "JML103"]
    assert result.model.root is None
    assert [root.name for root in result.model.roots] == ["Z"]


def test_same_file_twice(documents):
    documents.write("a.xmi", zoo())
    assert len(documents.read("a.xmi", "./a.xmi").model.documents) == 1


@pytest.mark.parametrize("is_open", [False, True], ids=["stored", "open in an editor"])
@pytest.mark.parametrize("name", ["a.xmi", "a.ros2jaus"])
def test_too_large(tmp_path, monkeypatch, name, is_open):
    monkeypatch.setenv(LIMIT, "1")
    data = bytes((1 << 20) + 1)
    path = tmp_path / name
    path.write_bytes(b"" if is_open else data)
    result = read_models([path], contents={path: data} if is_open else {}, notations=NOTATIONS)
    (found,) = result.diagnostics
    assert found.rule == "JML002"
    assert LIMIT in found.message


def nested(depth):
    return zoo('<branches name="b">' * depth + "</branches>" * depth)


def test_depth_limit(documents):
    assert rules(documents.one(nested(parsing.MAX_DEPTH))) == ["JML008"]
    assert rules(documents.one(nested(parsing.MAX_DEPTH - 1))) == []


def test_extreme_depth_does_not_exhaust_the_stack(documents):
    assert rules(documents.one("<a>" * 100_000)) == ["JML008"]


@pytest.mark.parametrize(
    ("bom", "codec", "declared"),
    [
        (b"", "utf-8", "UTF-8"),
        (codecs.BOM_UTF8, "utf-8", "UTF-8"),
        (codecs.BOM_UTF16_LE, "utf-16-le", "UTF-16"),
        (codecs.BOM_UTF16_BE, "utf-16-be", "UTF-16"),
        (b"", "latin-1", "ISO-8859-1"),
        (b"", "ascii", "US-ASCII"),
        (b"", "cp1252", "windows-1252"),
    ],
)
def test_encodings(documents, bom, codec, declared):
    name = "Zoo" if codec == "ascii" else "Zoé"
    text = zoo(f'  <cages id="{name}"\n   colour="r"/>', f'name="{name}"').replace(
        "UTF-8", declared
    )
    result = documents.one(bom + text.encode(codec))
    assert result.model.root.name == name
    (finding,) = result.diagnostics
    assert (finding.location.line, finding.location.column) == (5, 4)


@pytest.mark.parametrize("newline", ["\r\n", "\r"])
def test_line_ends(documents, newline):
    text = zoo('  <cages\n  id="a"\n    colour="r"/>').replace("\n", newline)
    (finding,) = documents.one(text.encode()).diagnostics
    assert (finding.location.line, finding.location.column) == (6, 5)


def test_bytes_that_do_not_fit_the_encoding(documents):
    result = documents.one(zoo(attributes='name="é"').encode("latin-1"))
    assert rules(result) == ["JML004"]
    assert result.diagnostics[0].location.line == 3


@pytest.mark.parametrize("name", ["utf-7", "shift_jis", "utf-32", "rot13", "hex", "\u00e9"])
def test_refused_encodings(documents, name):
    data = f'<?xml version="1.0" encoding="{name}"?>\n<a/>'.encode()
    assert rules(documents.one(data)) in (["JML006"], ["JML004"])


def test_entities_of_xml_itself(documents):
    model = documents.good(zoo(attributes='name="&lt;&#65;&quot;&#x42;&amp;"'))
    assert model.root.name == '<A"B&'


@pytest.mark.parametrize(
    "subset",
    [
        '<!ENTITY e SYSTEM "file:///etc/hostname">',
        '<!ENTITY a "aaaa"><!ENTITY b "&a;&a;&a;&a;">',
        '<!ENTITY % p SYSTEM "file:///etc/hostname"> %p;',
    ],
)
def test_entities_are_never_declared(documents, subset):
    text = zoo("<name>&e;</name>", "").replace("<zoo:Zoo", f"<!DOCTYPE z [{subset}]>\n<zoo:Zoo")
    result = documents.one(text)
    assert rules(result) == ["JML007"]
    assert result.diagnostics[0].location.line == 2
    assert result.model.root is None


def test_external_dtd_and_doctype_in_utf_16(documents):
    text = zoo().replace("<zoo:Zoo", '<!DOCTYPE z SYSTEM "http://www.example.org/z.dtd"><zoo:Zoo')
    assert rules(documents.one(text)) == ["JML007"]
    text = zoo().replace("<zoo:Zoo", "<!DOCTYPE z><zoo:Zoo").replace("UTF-8", "UTF-16")
    assert rules(documents.one(text.encode("utf-16"))) == ["JML007"]


def test_merge_conflict_hides_nothing_in_a_good_file(documents):
    # Seven equals signs on a line of text are no conflict when the XML is well-formed.
    documents.good(zoo("<tags>=======</tags>"))


def test_metamodel_given_as_model(documents):
    text = '<ecore:EPackage xmlns:ecore="http://www.eclipse.org/emf/2002/Ecore" name="x"/>'
    (finding,) = documents.one(text).diagnostics
    assert finding.hint == "this is a metamodel, not a model"


def test_version_of_the_metamodel(documents):
    text = '<zoo:Zoo xmlns:zoo="http://www.example.org/zoo/2.0" name="Z"/>'
    (finding,) = documents.one(text).diagnostics
    assert "version 2.0" in finding.hint
    assert "version 1.0" in finding.hint


def test_paths_are_shown_as_given(documents, monkeypatch):
    documents.write("sub/a.xmi", zoo('<main href="../lib.xmi#nowhere"/>'))
    documents.write("lib.xmi", zoo("<wheels/>"))
    monkeypatch.chdir(documents.folder)
    result = read_models(["sub/a.xmi"], metamodels=ZOO_METAMODELS)
    paths = [diagnostic.location.path for diagnostic in result.diagnostics]
    assert paths == ["lib.xmi", "sub/a.xmi"]


def test_reading_twice_finds_the_same(documents):
    text = f'<zoo:Zoo {XMLNS} colour="r"><wheels/><cages id="a"/><cages id="a"/></zoo:Zoo>'
    assert documents.one(text).diagnostics == documents.one(text).diagnostics
