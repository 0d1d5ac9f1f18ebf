"""Formats of reports that build servers read."""

import json
import re
import xml.etree.ElementTree as ET
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jausml.language.model import Diagnostic, Location, Related, Severity
from jausml.language.text.notation import TEXT_RULES
from jausml.language.validation.formats import github, junit, sarif
from jausml.language.validation.rule import Report
from jausml.language.validation.rules import catalogue

ERROR = Diagnostic(
    rule="JML302",
    severity=Severity.ERROR,
    location=Location("models/a.xmi", 3, 7),
    message='address "1 < 2" used twice',
    hint="take another",
    element="robot/b0",
    fragment="//@bridges.0",
    related=(Related(Location("b.xmi", 1, 2), "the other"),),
)
WARNING = Diagnostic("JML426", Severity.WARNING, Location("models/a.xmi", 4, 1), "never sent")
HOSTILE = [
    "\x00\x1b[31m\x7f",
    "a\r\n::error::b",
    "##[error]c",
    "100%25, x: y",
    "]]><!--&",
    "\ufffe\ud800",
    "\u202e",
]
texts = st.one_of(st.sampled_from(HOSTILE), st.text(st.characters(), max_size=80))
findings = st.builds(
    Diagnostic,
    rule=st.sampled_from(["JML302", "JML426"]),
    severity=st.sampled_from(Severity),
    location=st.builds(Location, st.text(max_size=20), st.integers(1, 99), st.integers(1, 99)),
    message=texts,
    hint=texts,
    element=texts,
    related=st.lists(st.builds(Related, st.just(Location("b.xmi")), texts), max_size=2).map(tuple),
)


def report(*diagnostics, files=("models/a.xmi", "b.xmi")):
    return Report(None, files, diagnostics)


def parsed(text):
    return ET.fromstring(text.encode("utf-8"))  # noqa: S314 - we wrote it


# -- JUnit ---------------------------------------------------------------------------------------


def test_junit_has_a_suite_for_each_file_and_a_case_for_each_rule():
    root = parsed(junit.render(report(ERROR, ERROR, WARNING)))
    suites = [(s.get("name"), s.get("tests"), s.get("failures")) for s in root]
    assert suites == [("models/a.xmi", "2", "1"), ("b.xmi", "1", "0")]
    assert (root.get("tests"), root.get("failures"), root.get("errors")) == ("3", "1", "0")
    failure, output = root.find(".//failure"), root.find(".//system-out")
    assert failure.get("message") == 'address "1 < 2" used twice'
    assert failure.text.splitlines()[:2] == [
        'models/a.xmi:3:7: error: JML302 address "1 < 2" used twice (take another)',
        "b.xmi:1:2: note: the other",
    ]
    assert output.text == "models/a.xmi:4:1: warning: JML426 never sent"


def test_junit_has_a_test_that_passes_for_a_clean_file():
    root = parsed(junit.render(report(files=("b.xmi",))))
    (case,) = root.findall("testsuite/testcase")
    assert (case.get("classname"), case.get("name"), len(case)) == ("b.xmi", "no findings", 0)


def test_junit_has_a_suite_for_a_file_that_only_a_reference_led_to():
    root = parsed(junit.render(report(ERROR, files=("b.xmi",))))
    assert [suite.get("name") for suite in root] == ["b.xmi", "models/a.xmi"]


@given(st.lists(findings, max_size=4))
def test_junit_is_xml_whatever_the_texts(found):
    assert parsed(junit.render(report(*found))).tag == "testsuites"


# -- GitHub --------------------------------------------------------------------------------------


def test_github_writes_errors_first():
    assert github.render(report(WARNING, ERROR)).splitlines() == [
        "::error file=models/a.xmi,line=3,col=7,title=JML302::"
        'address "1 < 2" used twice (take another)%0Ab.xmi:1:2: the other',
        "::warning file=models/a.xmi,line=4,col=1,title=JML426::never sent",
    ]


def test_github_escapes_properties_and_text():
    place = Location("C:\\a,b%.xmi", 1, 1)
    line = github.render(report(replace(WARNING, location=place, message="50%\r\n::error::x")))
    assert line == (
        "::warning file=C%3A\\a%2Cb%25.xmi,line=1,col=1,title=JML426::50%25\\r\\n::error::x\n"
    )


def test_github_names_what_it_would_not_show():
    lines = github.render(report(*[ERROR] * 13, *[WARNING] * 11)).splitlines()
    assert [line.split(" ")[0] for line in lines[:20]] == ["::error"] * 10 + ["::warning"] * 10
    assert lines[20] == "4 more, which GitHub does not annotate:"
    assert lines[21].startswith("- models/a.xmi:3:7: error: JML302")
    assert len(lines) == 21 + 3 * 2 + 1


@given(st.lists(findings, max_size=30))
def test_github_runs_no_other_command_whatever_the_texts(found):
    commands = re.compile(
        r"::(error|warning|notice) file=[^,:]*,line=\d+,col=\d+,title=JML\d{3}::|- |\d+ more"
    )
    text = github.render(report(*found))
    assert all(commands.match(line) for line in text.splitlines())
    assert "##[" not in text


# -- SARIF ---------------------------------------------------------------------------------------


def run_of(*diagnostics):
    log = json.loads(sarif.render(report(*diagnostics)))
    assert log["version"] == "2.1.0"
    (run,) = log["runs"]
    return run


def test_sarif_lists_every_rule():
    driver = run_of()["tool"]["driver"]
    assert driver["name"] == "jausml"
    assert [rule["id"] for rule in driver["rules"]] == [entry.id for entry in catalogue(TEXT_RULES)]
    assert all(rule["shortDescription"]["text"] for rule in driver["rules"])
    help_texts = {rule["id"]: rule["help"]["markdown"] for rule in driver["rules"]}
    assert 'Good: `<components name="vehicle" address="100.1.1"/>`' in help_texts["JML301"]
    assert run_of()["results"] == []


def test_sarif_has_every_attribute():
    run = run_of(ERROR, WARNING)
    first, second = run["results"]
    rule = run["tool"]["driver"]["rules"][first["ruleIndex"]]
    assert rule["id"] == first["ruleId"] == "JML302"
    assert [first["level"], second["level"]] == ["error", "warning"]
    assert first["message"]["text"] == 'address "1 < 2" used twice (take another)'
    (location,) = first["locations"]
    assert location["physicalLocation"] == {
        "artifactLocation": {"uri": "models/a.xmi"},
        "region": {"startLine": 3, "startColumn": 7},
    }
    assert location["logicalLocations"][0]["fullyQualifiedName"] == "robot/b0"
    (related,) = first["relatedLocations"]
    assert related["message"]["text"] == "the other"
    assert "logicalLocations" not in second["locations"][0]


def test_sarif_knows_a_finding_again_on_another_line():
    moved = replace(ERROR, location=Location("models/a.xmi", 99, 1))
    other = replace(ERROR, element="robot/b1")
    prints = [result["partialFingerprints"] for result in run_of(ERROR, moved, other)["results"]]
    assert prints[0] == prints[1] != prints[2]


@pytest.mark.parametrize(
    ("path", "uri"),
    [
        ("a b/ü#1.xmi", "a%20b/%C3%BC%231.xmi"),
        ("/tmp/a b.xmi", "file:///tmp/a%20b.xmi"),
        ("a:b.xmi", "a%3Ab.xmi"),
        ("../c.xmi", "../c.xmi"),
    ],
)
def test_sarif_writes_paths_as_uris(path, uri):
    (result,) = run_of(replace(WARNING, location=Location(path, 1, 1)))["results"]
    place = result["locations"][0]["physicalLocation"]
    assert place["artifactLocation"]["uri"] == uri


@given(st.lists(findings, max_size=4))
def test_sarif_is_json_whatever_the_texts(found):
    assert len(run_of(*found)["results"]) == len(found)
