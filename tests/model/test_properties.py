"""Random models: what is written is read; what is damaged is reported and never raises."""

import functools
import math
from pathlib import Path
from tempfile import TemporaryDirectory
from xml.sax.saxutils import escape, quoteattr

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from reader_support import EMF, ZOO_METAMODELS, Files, zoo
from sweeps import sweep

from jausml.language.metamodel import FeatureKind, ValueKind, load_metamodels
from jausml.language.model import READER_RULES
from jausml.language.model.values import convert
from jausml.language.model.xmi import parsing
from jausml.language.model.xmi.parsing import parse

SHIPPED = load_metamodels()
PREFIXES = " ".join(
    f'xmlns:{package.name}="{uri}"' for uri, package in sorted(SHIPPED.packages.items())
)
MATCHING = {
    "MessageCode": "0x[0-9A-Fa-f]{4}",
    "JausAddress": r"[0-9]{1,5}\.[0-9]{1,3}\.[0-9]{1,3}",
    "ServiceVersion": r"[0-9]{1,3}\.[0-9]{1,3}",
    "Endpoint": r"[0-9A-Za-z]([0-9A-Za-z.\-]{0,9}[0-9A-Za-z])?(:[0-9]{1,5})?",
    "PackageName": r"[a-z][a-z0-9_\-]*",
}
# XML normalises line ends and attribute blanks, so those are no part of what must survive.
TEXT = st.text(
    st.characters(
        codec="utf-8", exclude_categories=("Cs", "Cc"), exclude_characters="\ufffe\uffff"
    ),
    max_size=8,
)
QUICK = settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.too_slow])


def values(data_type):
    """Returns texts of a data type together with the values that they stand for."""
    if data_type.name in MATCHING:
        return st.from_regex(MATCHING[data_type.name], fullmatch=True).map(lambda v: (v, v))
    if data_type.kind is ValueKind.STRING:
        return TEXT.map(lambda v: (v, v))
    if data_type.kind is ValueKind.ENUMERATION:
        return st.sampled_from(data_type.legal).map(lambda v: (v, data_type.literals[v]))
    if data_type.kind is ValueKind.BOOLEAN:
        return st.booleans().map(lambda v: (str(v).lower(), v))
    if data_type.kind is ValueKind.INTEGER:
        whole = st.integers(data_type.minimum, data_type.maximum)
        return whole.map(lambda v: (str(v), v))
    return st.floats(allow_nan=False, allow_infinity=False).map(lambda v: (repr(v), v))


@functools.cache
def attribute(feature):
    """Returns a strategy for the values of an attribute."""
    least = feature.lower if feature.can_be_missing else 0
    most = max(3 if feature.many else 1, least)
    return st.lists(values(feature.data_type), min_size=least, max_size=most)


@functools.cache
def classes(table, depth):
    """Returns a strategy for the classes that an element may be of."""
    concrete = sorted((subtype for subtype in table.subtypes if not subtype.abstract), key=repr)
    if depth <= 0:
        # Only classes that need no further elements end the recursion.
        leaves = [metaclass for metaclass in concrete if not needs_children(metaclass)]
        concrete = leaves or concrete
    return st.sampled_from(concrete)


@functools.cache
def elements(table, depth=4):
    """Returns a strategy for elements of a class; each is made once, for that takes long."""
    return element(table, depth)


@st.composite
def element(draw, table, depth):
    """Draws an element: (class, {attribute: [(text, value)]}, {containment: [...]})."""
    table = draw(classes(table, depth))
    attributes, contained = {}, {}
    for feature in table.features.values():
        if feature.kind is FeatureKind.ATTRIBUTE:
            attributes[feature.name] = draw(attribute(feature))
        elif feature.kind is FeatureKind.CONTAINMENT:
            most = 0 if depth <= 0 else 2 if feature.many else 1
            number = draw(st.integers(feature.lower, max(most, feature.lower)))
            contained[feature.name] = [
                draw(elements(feature.target, depth - 1)) for _ in range(number)
            ]
    return table, attributes, contained


def needs_children(table):
    return any(
        feature.lower and feature.kind is not FeatureKind.ATTRIBUTE
        for feature in table.features.values()
    )


def write(element, tag, extra=""):
    """Writes a drawn element as EMF would: lists as elements, the rest as XML attributes."""
    table, attributes, contained = element
    head, body = "", ""
    for name, drawn in attributes.items():
        if table.features[name].many:
            body += "".join(f"<{name}>{escape(text)}</{name}>" for text, _ in drawn)
        elif drawn:
            head += f" {name}={quoteattr(drawn[0][0])}"
    for name, children in contained.items():
        for child in children:
            kind = f' xsi:type="{child[0].qualified_name.replace(".", ":")}"'
            body += write(child, name, kind)
    return f"<{tag}{extra}{head}>{body}</{tag}>"


def compare(obj, element):
    table, attributes, contained = element
    assert obj.eClass is table.eclass
    for name, drawn in attributes.items():
        feature = table.features[name]
        expected = [value for _, value in drawn]
        if feature.many:
            assert list(getattr(obj, name)) == expected
        else:
            assert getattr(obj, name) == (expected[0] if expected else feature.default)
            assert obj.eIsSet(name) == bool(drawn)
    for name, children in contained.items():
        read = getattr(obj, name)
        found = list(read) if table.features[name].many else [] if read is None else [read]
        assert len(found) == len(children)
        for child, drawn in zip(found, children, strict=True):
            assert child.eContainer() is obj
            compare(child, drawn)


def read(text, metamodels):
    with TemporaryDirectory() as folder:
        return Files(Path(folder)).one(text, metamodels=metamodels)


ROOTS = ["jaus.ServiceSet", "ros.InterfacePackage", "ros.Node", "jaus.Component", "system.Host"]


@pytest.mark.parametrize("root", sweep(ROOTS, every=3))
@given(data=st.data())
@QUICK
def test_written_models_are_read(root, data):
    element = data.draw(elements(SHIPPED.classes[root], 3))
    tag = element[0].qualified_name.replace(".", ":")
    extra = f' xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" {PREFIXES}'
    result = read('<?xml version="1.0" encoding="UTF-8"?>\n' + write(element, tag, extra), SHIPPED)
    # References are not drawn: those that are required are all that may be missing.
    missing = {d.message for d in result.diagnostics if "a reference to" not in d.hint}
    assert missing == set()
    compare(result.model.root, element)


GOOD = [path.read_bytes() for path in sorted((EMF / "zoo").glob("good_*.xmi"))]


@given(st.sampled_from(GOOD), st.data())
@settings(QUICK, max_examples=100)
def test_damaged_bytes_never_raise(good, data):
    damaged = bytearray(good)
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(damaged)))
        size = data.draw(st.integers(0, 6))
        damaged[at : at + size] = data.draw(st.binary(max_size=6))
    check(read(bytes(damaged), ZOO_METAMODELS))


PIECES = st.sampled_from(
    ["//@cages.0", "c1", "#", "/", "@", "zoo:", "xsi:type", "xmi:id", "href", '"', "'", "<", ">",
     "</", "/>", "=", " ", "&lt;", "&#0;", "[", "]", ".", "0", "9999999999", "name", "cages",
     "zoo:Lion", "<cages/>", "<!--", "-->", "<![CDATA[", "]]>", "é", "\U0001f600", "\0", "?", "%00",
     "model.xmi#", "platform:/resource/", "file:", "http://www.jausml.org/library/", "xmlns:a=''"]
)  # fmt: skip


@given(st.sampled_from(GOOD), st.data())
@settings(QUICK, max_examples=100)
def test_damaged_text_never_raises(good, data):
    text = good.decode("latin-1")
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(text)))
        text = text[:at] + data.draw(PIECES) + text[at + data.draw(st.integers(0, 8)) :]
    check(read(text.encode("utf-8"), ZOO_METAMODELS))


def check(result):
    """Whatever was read: findings are well placed and the model can be asked."""
    for finding in result.diagnostics:
        assert finding.rule in READER_RULES
        assert finding.location.line >= 1
        assert finding.location.column >= 1
    assert result.diagnostics == sorted(result.diagnostics)
    model = result.model
    for element in model.elements():
        model.element_path(element)
        model.fragment(element)
        model.location(element, "name")
        model.owned(element)


@given(st.text(max_size=20))
@settings(max_examples=300)
def test_fragments_never_raise(fragment):
    model = '<main href="#' + escape(fragment, {'"': "&quot;"}) + '"/>'
    check(read(zoo('<cages id="c1"/>' + model).encode("utf-8", "replace"), ZOO_METAMODELS))


@given(st.text(max_size=12))
@settings(max_examples=300)
def test_values_of_every_type(text):
    for table in (*SHIPPED.classes.values(), *ZOO_METAMODELS.classes.values()):
        for feature in table.features.values():
            if feature.data_type is not None:
                value, fault = convert(text, feature.data_type)
                assert (fault is None) or value is None


@given(st.floats())
def test_reals_survive(number):
    span = ZOO_METAMODELS.classes["birds.Parrot"].features["span"].data_type
    text = repr(number).replace("inf", "Infinity").replace("nan", "NaN")
    value, fault = convert(text, span)
    assert fault is None
    assert value == number or math.isnan(number)


NAMES = st.from_regex("[a-z][a-z0-9]{0,5}", fullmatch=True)
BLANKS = st.text(" \t\n", min_size=1, max_size=4)


@given(
    st.lists(
        st.tuples(BLANKS, NAMES, TEXT),
        unique_by=lambda drawn_attribute: drawn_attribute[1],
        min_size=1,
    )
)
def test_attributes_are_found_where_they_are(attributes):
    text, places = "<a", {}
    for blanks, name, value in attributes:
        text += blanks
        places[name] = (text.count("\n") + 1, len(text) - text.rfind("\n"))
        text += f"{name}={quoteattr(value)}"
    data = (text + "/>").encode()
    node = parse(data).root
    expected = {("", name): place for name, place in places.items()}
    assert parsing.attribute_positions(data, "utf-8", node) == expected
