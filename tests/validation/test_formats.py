"""Formats of reports."""

import json

from jausml.language.model import Diagnostic, Location, Related, Severity
from jausml.language.validation.formats import json as json_format
from jausml.language.validation.formats import text
from jausml.language.validation.rule import Report

FINDING = Diagnostic(
    rule="JML302",
    severity=Severity.ERROR,
    location=Location("a.xmi", 3, 7),
    message="address used\ntwice \x1b[31m\u202e",
    hint="take another",
    element="robot/b0",
    fragment="//@bridges.0",
    related=(Related(Location("b.xmi", 1, 2), "the other"),),
)
WARNING = Diagnostic("JML426", Severity.WARNING, Location("a.xmi", 4, 1), "never sent")


def report(*findings):
    return Report(None, ("a.xmi", "b.xmi"), findings)


def test_text_is_one_line_for_each_place_and_moves_no_cursor():
    assert text.render(report(FINDING, WARNING)).splitlines() == [
        "a.xmi:3:7: error: JML302 address used\\ntwice \\x1b[31m\\u202e (take another)",
        "b.xmi:1:2: note: the other",
        "a.xmi:4:1: warning: JML426 never sent",
    ]


def test_summary_counts():
    assert text.summary(report(FINDING, FINDING, WARNING)) == "2 errors, 1 warning in 2 files"
    assert text.summary(report()) == "no problems in 2 files"
    assert text.summary(Report(None, ("a.xmi",), (WARNING,))) == "1 warning in 1 file"


def test_json_has_every_attribute():
    content = json.loads(json_format.render(report(FINDING, WARNING)))
    assert content["schema"] == 1
    assert content["files"] == ["a.xmi", "b.xmi"]
    assert content["diagnostics"][0] == {
        "rule": "JML302",
        "severity": "error",
        "file": "a.xmi",
        "line": 3,
        "column": 7,
        "element": "robot/b0",
        "fragment": "//@bridges.0",
        "message": FINDING.message,
        "hint": "take another",
        "related": [{"file": "b.xmi", "line": 1, "column": 2, "message": "the other"}],
    }
    assert content["diagnostics"][1]["related"] == []
