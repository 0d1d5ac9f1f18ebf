"""Our verdicts and values against those of real EMF, recorded by `make emf`.

Where the two differ on purpose, the reason stands here.
"""

import json
import math
import re
from urllib.parse import unquote

import pytest
from for_each import for_each
from reader_support import EMF, ZOO_METAMODELS

from jausml.language.metamodel import FeatureKind
from jausml.language.model import read_models

VERDICTS = json.loads((EMF / "verdicts.json").read_text(encoding="utf-8"))

STRICTER = {
    "zoo/attribute_and_element.xmi": "EMF keeps the last of two values in silence",
    "zoo/two_for_single.xmi": "EMF keeps the last of two values in silence",
    "zoo/two_tokens_for_single.xmi": "EMF keeps the last of two targets in silence",
    "zoo/containment_proxy_twice.xmi": "EMF leaves the element with two owners",
    "zoo/dangling_container.xmi": "EMF leaves the element outside the owner that it names",
    "zoo/duplicate_xmi_id.xmi": "EMF finds either element by the id",
    "zoo/value_real_hex.xmi": "hexadecimal floating point is Java's alone",
    "zoo/value_real_suffix.xmi": "the suffix f is Java's alone",
}
MORE_LENIENT = {
    "zoo/enum_by_name.xmi": "literal and name are equal in the shipped metamodels",
    "zoo/many_to_many_one_end.xmi": "the shipped metamodels have no many-to-many opposites",
    "zoo/name_fragment.xmi": "warned of: JML214",
    "zoo/ns_on_child.xmi": "warned of: JML013",
    "zoo/other_prefixes.xmi": "warned of: JML013",
}


@for_each("case", sorted(VERDICTS))
def test_verdict(case, monkeypatch):
    monkeypatch.chdir(EMF)
    metamodels = ZOO_METAMODELS if case.startswith("zoo") else None
    result = read_models([case], project_root=EMF, metamodels=metamodels)
    ours = "error" if result.has_errors else "ok"
    expected = VERDICTS[case]["verdict"]
    if case in STRICTER:
        assert (ours, expected) == ("error", "ok"), STRICTER[case]
    elif case in MORE_LENIENT:
        assert (ours, expected) == ("ok", "error"), MORE_LENIENT[case]
    else:
        assert ours == expected, VERDICTS[case]["messages"]
    name = case.partition("/")[2]
    if name.startswith(("good_", "bad_")):
        assert expected == ("ok" if name.startswith("good_") else "error")


@pytest.mark.parametrize("case", [case for case, why in MORE_LENIENT.items() if "JML" in why])
def test_leniency_is_warned_of(case, monkeypatch):
    monkeypatch.chdir(EMF)
    result = read_models([case], metamodels=ZOO_METAMODELS)
    rule = MORE_LENIENT[case][-6:]
    assert {diagnostic.rule for diagnostic in result.diagnostics} == {rule}


def test_every_case_is_recorded():
    cases = {f"{folder}/{path.name}" for folder in ("zoo", "shipped")
             for path in (EMF / folder).glob("*.xmi")}  # fmt: skip
    assert cases == set(VERDICTS)
    assert set(STRICTER) | set(MORE_LENIENT) <= cases


OTHER_VALUES = {
    "zoo/opposite_one_end.xmi": "EMF loses the reference when the other end is not written",
    "zoo/repeated_reference.xmi": "pyecore holds it once; warned of: JML213",
    "zoo/repeated_value.xmi": "pyecore holds it once; warned of: JML213",
}
DUMPED = sorted(
    case for case, said in VERDICTS.items() if "objects" in said and case not in STRICTER
)


@for_each("case", DUMPED)
def test_values(case, monkeypatch):
    monkeypatch.chdir(EMF)
    metamodels = ZOO_METAMODELS if case.startswith("zoo") else None
    model = read_models([case], metamodels=metamodels).model
    ours = {dump(model, element) for element in model.elements()}
    theirs = set(map(unquote, VERDICTS[case]["objects"]))
    if case in OTHER_VALUES:
        assert ours != theirs, OTHER_VALUES[case]
        return
    # EMF lists what a document contains of another one below the containing element as well.
    contents = {content(line) for line in ours}
    extra = {line for line in theirs - ours if content(line) not in contents}
    assert (ours - theirs, extra) == (set(), set())


def content(line):
    """Returns a line of a dump without names of files."""
    return re.sub(r"[^ =\[]+\.xmi#", "#", line.partition(": ")[2])


def dump(model, element):
    """Writes an element as tools/emf_check.py --dump does."""
    table = model.metamodels.class_of(element)
    document = model.document_of(element)
    text = f"{document.display}#{model.fragment(element)}: {table.qualified_name}"
    for feature in table.features.values():
        if feature.kind in (FeatureKind.CONTAINMENT, FeatureKind.CONTAINER) or not feature.settable:
            continue
        value = getattr(element, feature.name)
        shown = [show(model, document, one) for one in (value if feature.many else [value])]
        joined = ", ".join(shown)
        text += f" {feature.name}=" + (f"[{joined}]" if feature.many else joined)
    return text


def show(model, document, value):
    if value is None:
        return "null"
    if hasattr(value, "eContainer") and not hasattr(value, "eEnum"):
        target = model.document_of(value)
        return f"{'' if target is document else target.display}#{model.fragment(value)}"
    if isinstance(value, bool):
        value = str(value).lower()
    elif isinstance(value, float):
        special = {math.inf: "Infinity", -math.inf: "-Infinity"}
        value = "NaN" if math.isnan(value) else special.get(value, value)
    elif hasattr(value, "eEnum"):
        value = value.literal or value.name
    return f'"{value}"'
