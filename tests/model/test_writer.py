"""What is written is what EMF writes, and reads back as the same model."""

import hashlib
import json
import stat
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from model_strategies import models
from reader_support import ZOO_METAMODELS
from sweeps import sweep

from jausml.language.metamodel import load_metamodels
from jausml.language.metamodel.filling import link, new_object, set_value
from jausml.language.model import library_root, read_models
from jausml.language.model.comparison import compare
from jausml.language.model.files import replace_file
from jausml.language.model.model import Model
from jausml.language.model.xmi.writer import UnwritableError, java_double, to_xmi, write_model

ROOT = Path(__file__).resolve().parents[2]
RESAVED = ROOT / "tests" / "emf" / "resaved"
VERDICTS = json.loads((RESAVED.parent / "verdicts.json").read_text(encoding="utf-8"))
LIBRARY = sorted(library_root().rglob("*.xmi"))
SHIPPED = load_metamodels()
QUICK = settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))


@pytest.mark.parametrize("metamodels", [SHIPPED, ZOO_METAMODELS], ids=["shipped", "zoo"])
def test_random_models_read_back_as_they_were(metamodels):
    @QUICK
    @given(drawn=models(metamodels))
    def check(drawn):
        roots, model = drawn
        with TemporaryDirectory() as folder:
            path = Path(folder) / "model.xmi"
            write_model(roots, model, path)
            result = read_models([path], metamodels=metamodels, project_root=folder)
        # Random elements lack what they must have, which is no fault of the writer.
        rules = {diagnostic.rule for diagnostic in result.diagnostics}
        assert rules <= {"JML108", "JML109", "JML110", "JML201"}, result.diagnostics
        read = result.model.roots
        assert len(read) == len(roots)
        for ours, theirs in zip(roots, read, strict=True):
            assert compare(ours, theirs, metamodels) == []
        assert to_xmi(read, result.model, path) == to_xmi(roots, model, path)

    check()


@pytest.mark.parametrize("saved", sorted(RESAVED.rglob("*.xmi")), ids=lambda path: path.stem)
def test_examples_are_written_as_emf_saves_them(saved):
    # Those beside the library, which an installed jausml has elsewhere.
    path = library_root().parent / saved.relative_to(RESAVED)
    verdict = VERDICTS[f"models/{saved.relative_to(RESAVED).as_posix()}"]
    if verdict["sha256"] != hashlib.sha256(path.read_bytes()).hexdigest():
        pytest.skip("changed since EMF saved it: run `make emf`")
    model = read_models([path]).model
    assert to_xmi(model.documents[0].roots, model, path) == saved.read_text(encoding="utf-8")


@pytest.mark.parametrize("path", sweep(LIBRARY, every=5), ids=lambda path: path.stem)
def test_library_reads_back_as_the_same_model(path, tmp_path):
    first = read_models([path]).model
    out = tmp_path / "copy.xmi"
    write_model(first.documents[0].roots, first, out)
    result = read_models([out], project_root=tmp_path)
    assert result.diagnostics == []
    (ours,), (theirs,) = first.documents[0].roots, result.model.documents[0].roots
    assert compare(ours, theirs, SHIPPED) == []


def test_references_to_other_documents_are_relative_to_the_new_place(tmp_path):
    library = tmp_path / "sub dir" / "types.xmi"
    library.parent.mkdir()
    header = (
        '<jaus:ServiceSet xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"'
        ' xmlns:jaus="http://www.jausml.org/jaus/1.0" name="set">'
    )
    base = '<services name="Base" urn="urn:a:Base"/>'
    library.write_text(f"{header}{base}</jaus:ServiceSet>", encoding="utf-8")
    model_file = tmp_path / "model.xmi"
    href = '<inherits href="sub%20dir/types.xmi#//@services.0"/>'
    core = '<inherits href="http://www.jausml.org/library/jaus/core-1.1.xmi#Events"/>'
    services = "".join(
        f'<services name="{name}" urn="urn:a:{name}">{inherits}</services>'
        for name, inherits in (("One", href), ("Two", core))
    )
    model_file.write_text(f"{header}{services}</jaus:ServiceSet>", encoding="utf-8")
    result = read_models([model_file], project_root=tmp_path)
    assert result.diagnostics == []
    place = tmp_path / "deeper" / "out.xmi"
    text = to_xmi(result.model.documents[0].roots, result.model, place)
    assert 'href="../sub%20dir/types.xmi#//@services.0"' in text
    assert 'href="http://www.jausml.org/library/jaus/core-1.1.xmi#Events"' in text


def service_set(**features):
    table = SHIPPED.classes["jaus.ServiceSet"]
    obj = new_object(table)
    for name, value in features.items():
        set_value(obj, table.features[name], value)
    return obj


def test_characters_that_xml_cannot_hold_are_refused(tmp_path):
    path = tmp_path / "model.xmi"
    path.write_text("kept", encoding="utf-8")
    with pytest.raises(UnwritableError, match=r"'\\x07'"):
        write_model([service_set(name="bell \a")], Model([], SHIPPED), path)
    assert path.read_text(encoding="utf-8") == "kept"


def test_a_reference_out_of_all_documents_is_refused(tmp_path):
    service = new_object(SHIPPED.classes["jaus.Service"])
    stranger = new_object(SHIPPED.classes["jaus.Service"])
    link(service, SHIPPED.classes["jaus.Service"].features["inherits"], stranger)
    with pytest.raises(UnwritableError, match="stands in no document"):
        to_xmi([service], Model([], SHIPPED), tmp_path / "model.xmi")


def test_no_root_is_an_empty_document(tmp_path):
    text = to_xmi([], Model([], SHIPPED), tmp_path / "model.xmi")
    assert text.splitlines()[1].startswith("<xmi:XMI ")
    assert text.endswith("/>\n")


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0.0"),
        (-0.0, "-0.0"),
        (1.0, "1.0"),
        (0.1, "0.1"),
        (0.001, "0.001"),
        (0.0001, "1.0E-4"),
        (9999999.0, "9999999.0"),
        (1e7, "1.0E7"),
        (4294967295.0, "4.294967295E9"),
        (-1.25e-7, "-1.25E-7"),
        (1.7976931348623157e308, "1.7976931348623157E308"),
        (5e-324, "5.0E-324"),
        (float("nan"), "NaN"),
        (float("inf"), "Infinity"),
        (float("-inf"), "-Infinity"),
    ],
)
def test_numbers_are_written_as_java_does(value, text):
    assert java_double(value) == text


@given(st.floats(allow_nan=False))
def test_numbers_keep_every_bit(value):
    assert repr(float(java_double(value).replace("Infinity", "inf"))) == repr(value)


@pytest.mark.skipif(sys.platform == "win32", reason="permissions of POSIX")
def test_a_file_that_cannot_be_written_is_left_as_it_was(tmp_path):
    path = tmp_path / "model.xmi"
    path.write_text("old", encoding="utf-8")
    with pytest.raises(OSError, match="directory") as raised:
        replace_file(tmp_path / "nowhere" / "model.xmi", b"new")
    # What is named is the file of the user, not the one beside it.
    assert raised.value.filename == str(tmp_path / "nowhere" / "model.xmi")
    assert "jausml-tmp" not in str(raised.value)
    (tmp_path / ".model.xmi").write_text("other", encoding="utf-8")
    link_to = tmp_path / "link.xmi"
    link_to.symlink_to(path)
    replace_file(link_to, b"new")
    assert link_to.is_symlink()
    assert path.read_bytes() == b"new"
    assert stat.S_IMODE(path.stat().st_mode) & stat.S_IRUSR
    assert [entry.name for entry in tmp_path.iterdir() if "jausml-tmp" in entry.name] == []
