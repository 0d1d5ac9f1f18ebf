"""Text of a model is data: it is refused with a place, or it stays data in everything generated."""

import ast
import re
from functools import cache
from pathlib import Path
from xml.etree import ElementTree
from xml.sax.saxutils import escape, quoteattr

import pytest

from jausml.language.metamodel import ValueKind, load_metamodels
from jausml.language.model import read_models
from jausml.language.validation.engine import check_project

MODEL = Path(__file__).parents[1] / "cases" / "hostile_strings" / "model.xmi"
TEXT = MODEL.read_text(encoding="utf-8")

# Ends strings, comments, docstrings, tags and templates of all languages that are generated.
PAYLOAD = (
    "x'\"'''\"\"\"\\\n{{ 7 * 7 }}{% raw %}{# #}${HOME}`id`%s{0}--> ]]> */\r"
    "__import__('os').system('touch INJECTED')\n# \u2028import INJECTED\n\\N{BULLET}\\u0022é€"
)
SAID = re.compile(r"\bx(\d+) x")
"""The beginning of a payload, with its number."""
# The texts that are free: everything else has rules of its own and must be refused.
FREE = {
    *("documentation", "units", "format", "holdReason"),
    *("EnumeratedValue.name", "Format.name", "Alternative.name", "Action.arguments"),
    *("Parameter.value", "ConstantAssignment.value", "FieldAssignment.defaultValue"),
    *("TableEntry.ros", "ListAssignment.names", "MapLibrary.name", "ValueTable.name"),
    *("Quantity.name", "Join.name", "ReportJoin.name", "TestVector.name", "OpenDecision.text"),
    "Marker.stated",
}


@cache
def string_features():
    """Returns class, feature and span of the value of every text in the model."""
    return list(_string_features())


def _string_features():
    model = read_models([MODEL]).model
    lines = TEXT.splitlines(keepends=True)
    starts = [sum(map(len, lines[:number])) for number in range(len(lines))]
    for element in model.elements(library=False):
        for feature in model.metamodels.class_of(element).features.values():
            data_type = feature.data_type
            if data_type is None or data_type.kind is not ValueKind.STRING:
                continue
            place = model.location(element, feature.name)
            start = starts[place.line - 1] + place.column - 1
            written = rf'{feature.name}="[^"]*"|<{feature.name}>[^<]*</{feature.name}>'
            found = re.compile(written).match(TEXT, start)
            if found:
                yield element.eClass.name, feature.name, found.span()


def is_field_name(class_name, feature):
    """Whether it is a name within a message body, which may be any text with a letter."""
    classes = load_metamodels().classes
    table = classes.get(f"jaus.{class_name}")
    is_field = table is not None and classes["jaus.Field"] in table.supertypes
    return feature == "name" and (is_field or class_name == "SubField")


def is_free(class_name, feature):
    return (
        feature in FREE or f"{class_name}.{feature}" in FREE or is_field_name(class_name, feature)
    )


def with_payload(spans):
    """Returns the model with the payload in some features, each made unique."""
    text = TEXT
    for number, (_, feature, (start, end)) in reversed(
        list(enumerate(sorted(spans, key=lambda span: span[2])))
    ):
        payload = f"x{number} {PAYLOAD}"
        if text[start] == "<":
            written = f"<{feature}>{escape(payload)}</{feature}>"
        else:
            value = quoteattr(payload, {"\n": "&#10;", "\r": "&#13;"})
            written = f"{feature}={value}"
        text = f"{text[:start]}{written}{text[end:]}"
    return text


def test_model_has_every_string_feature():
    declared = {
        (table.name, feature.name)
        for table in load_metamodels().classes.values()
        if not table.abstract
        for feature in table.features.values()
        if feature.data_type is not None and feature.data_type.kind is ValueKind.STRING
    }
    present = {(class_name, feature) for class_name, feature, _ in string_features()}
    # A bridge is generated here, and so is at no endpoint that a model could state.
    assert declared - present == {("Bridge", "endpoint")}


PATHS = re.findall(r'(?:target|source|path)="([^"]*)"', TEXT)
IN_PATHS = {step for path in PATHS for step in path.split(".")}


def is_used_in_a_path(class_name, name, start):
    """Whether a path of a map leads through the field, which then has no such attribute."""
    mapped = TEXT.index('xmi:id="Lamp.SetLight"')
    written = TEXT[start:].split('"', 2)[1]
    is_step = is_field_name(class_name, name) or (class_name, name) == ("Join", "name")
    return is_step and start > mapped and written in IN_PATHS


def free_features():
    return [
        (class_name, name, span)
        for class_name, name, span in string_features()
        if is_free(class_name, name) and not is_used_in_a_path(class_name, name, span[0])
    ]


def errors_of(features, folder):
    path = folder / "model.xmi"
    path.write_text(with_payload(features), encoding="utf-8")
    return [error for error in check_project([path]).diagnostics if error.severity.value == "error"]


def test_texts_that_are_free_are_free_together(tmp_path):
    assert len(free_features()) > 150
    assert errors_of(free_features(), tmp_path) == []


def line_of(feature):
    return TEXT[: feature[2][0]].count("\n") + 1


def refused_together(features, folder):
    """Returns those of some features, of which no two are in a line, that an error tells of.

    It stands in the line of its feature and shows its payload, whose number no other one has. Where
    an error keeps others from being looked for, they are not told of.
    """
    errors = errors_of(features, folder)
    told = {(error.location.line, said) for error in errors for said in SAID.findall(str(error))}
    return [
        feature
        for number, feature in enumerate(sorted(features, key=lambda attempt: attempt[2]))
        if (line_of(feature), str(number)) in told
    ]


def refused_with_others(features, folder):
    """Returns those of some features that are refused while others are hostile too."""
    refused = []
    while left := [feature for feature in features if feature not in refused]:
        found = refused_together(
            list({line_of(feature): feature for feature in left}.values()), folder
        )
        if not found:
            break
        refused += found
    return refused


def test_each_other_text_is_refused_where_it_stands(subtests, tmp_path):
    others = [feature for feature in string_features() if feature not in free_features()]
    together = refused_with_others(others, tmp_path)
    for feature in [other for other in others if other not in together]:
        class_name, name, (start, _) = feature
        with subtests.test(f"{class_name}.{name}-{start}"):
            errors = errors_of([feature], tmp_path)
            assert errors, f"{class_name}.{name} was accepted"
            assert all("\n" not in str(error) or error.location.line for error in errors)
            if not is_used_in_a_path(class_name, name, start):
                assert line_of(feature) in {error.location.line for error in errors}


@pytest.mark.slow
def test_generated_files_hold_hostile_text_as_data_only(jausml, here):
    Path("model.xmi").write_text(with_payload(free_features()), encoding="utf-8")
    result = jausml("--debug", "generate", "model.xmi", "-o", "out")
    assert result.exit_code == 0, result.stderr
    sources = list(Path("out").rglob("*.py"))
    assert len(sources) > 10
    for source in sources:
        names = {
            getattr(node, "id", None) or getattr(node, "name", None)
            for node in ast.walk(ast.parse(source.read_bytes()))
            if isinstance(node, (ast.Name, ast.alias))
        }
        assert not {"__import__", "INJECTED"} & names, source
        compile(source.read_bytes(), str(source), "exec")
    for manifest in Path("out").rglob("package.xml"):
        ElementTree.parse(manifest)  # noqa: S314 - we wrote it
    diagrams = list(Path("out").rglob("states.md"))
    assert diagrams
    for diagram in diagrams:
        # Between the marks stand names alone, which rules keep to letters, digits and underscores.
        assert not {"INJECTED", "7 * 7"} & set(re.findall(r"INJECTED|7 \* 7", diagram.read_text()))
    assert not list(here.rglob("INJECTED"))
    assert jausml("generate", "model.xmi", "-o", "out", "--check").exit_code == 0
