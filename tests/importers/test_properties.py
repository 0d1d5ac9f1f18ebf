"""Damaged JSIDL is reported and never raises; what is taken for good can be written."""

import contextlib
import os
import re
from pathlib import Path

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from jsidl_support import WINCH
from lxml import etree

from jausml.language.importers.jsidl import JSIDL_RULES, Source, import_sources
from jausml.language.importers.jsidl.scopes import NumberError, evaluate, matches, pick_version
from jausml.language.model import READER_RULES
from jausml.language.model.xmi.writer import to_xmi

EXAMPLES = int(os.environ.get("JAUSML_EXAMPLES", "40"))
QUICK = settings(
    max_examples=EXAMPLES,
    deadline=None,
    derandomize=EXAMPLES < 100,
    suppress_health_check=list(HealthCheck),
)
# Without a service of the library, which would be read for each example.
INHERITS = re.compile(rb"<inherits_from [^>]*>")
FILES = {path.name: INHERITS.sub(b"", path.read_bytes()) for path in WINCH}
TEXTS = st.sampled_from(
    ["", " ", "0", "-1", "1e9", "65536", "x", "a.b", "true", "unsigned byte", "numbers.PI", "(("]
)


def imported(files):
    """Imports files by name; what is found is of a known rule and place."""
    result = import_sources([Source(name, data) for name, data in files.items()])
    for diagnostic in result.diagnostics:
        assert diagnostic.rule in JSIDL_RULES or diagnostic.rule in READER_RULES
        assert diagnostic.location.path in files
        assert 1 <= diagnostic.location.line <= files[diagnostic.location.path].count(b"\n") + 1
    if not result.has_errors:
        assert to_xmi(result.sets, result.model, Path("out.xmi"))
    return result


@st.composite
def damaged(draw):
    """Draws the files of the winch with some elements and attributes changed."""
    files = dict(FILES)
    for _ in range(draw(st.integers(1, 4))):
        name = draw(st.sampled_from(sorted(files)))
        root = etree.fromstring(files[name])
        nodes = [element for element in root.iter() if isinstance(element.tag, str)]
        node = draw(st.sampled_from(nodes))
        other = draw(st.sampled_from(nodes))
        deed = draw(st.sampled_from(["drop", "copy", "move", "value", "rename", "attribute"]))
        keys = sorted(map(str, node.attrib))
        if deed == "drop" and node is not root:
            node.getparent().remove(node)
        elif deed == "copy":
            other.append(etree.fromstring(etree.tostring(node)))
        elif deed == "move" and node is not root and node not in other.iterancestors():
            if node is not other:
                other.append(node)
        elif deed == "value" and keys:
            node.set(draw(st.sampled_from(keys)), draw(TEXTS))
        elif deed == "rename":
            node.tag = other.tag
        elif deed == "attribute" and keys:
            del node.attrib[draw(st.sampled_from(keys))]
        files[name] = etree.tostring(root, xml_declaration=False, encoding="utf-8")
    return files


@QUICK
@given(files=damaged())
def test_damaged_files_are_reported(files):
    imported(files)


@QUICK
@given(name=st.sampled_from(sorted(FILES)), data=st.data())
def test_cut_and_changed_bytes_are_reported(name, data):
    content = FILES[name]
    start = data.draw(st.integers(0, len(content)))
    length = data.draw(st.integers(0, 40))
    middle = data.draw(st.binary(max_size=6))
    imported({**FILES, name: content[:start] + middle + content[start + length :]})


@QUICK
@given(st.text(st.sampled_from("0123456789.,eE+-*/() aPI_"), max_size=20))
def test_any_text_is_a_number_or_is_refused(text):
    def constant(path):
        raise NumberError(f"no constant {path}")

    value = None
    with contextlib.suppress(NumberError):
        value = evaluate(text, constant)
    assert not text.isdigit() or value == int(text)


@given(
    st.text("0123456789.*", max_size=12), st.lists(st.text("0123456789.", max_size=8), min_size=1)
)
def test_a_version_is_one_of_those_that_are_there(wanted, versions):
    found = pick_version(wanted, versions)
    assert found in versions
    if any(matches(wanted, version) for version in versions):
        assert matches(wanted, found)


def test_the_files_are_good_as_they_are():
    assert not imported(FILES).has_errors
