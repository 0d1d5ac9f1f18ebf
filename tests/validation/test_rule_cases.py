"""Each rule has a model that breaks it, with the places asserted, and one that keeps it."""

from dataclasses import replace
from pathlib import Path

from for_each import for_each

from jausml.language.model.diagnostics import Severity
from jausml.language.validation.engine import check_project
from jausml.language.validation.formats import text
from jausml.language.validation.rules import all_rules

GUARDS = ("jausml/language/validation/rules", "tests/cases/rules")

INSTALLED = "prefix"
"""A case may have installed ROS packages of its own below this folder."""

CASES = sorted((Path(__file__).parents[1] / "cases" / "rules").iterdir())


def findings_of(case, name):
    """The findings of the rule of a case, and all errors.

    A case is small: what others would only like to see in it is no concern here.
    """
    report = check_project([name])
    kept = [
        diagnostic
        for diagnostic in report.diagnostics
        if diagnostic.rule == case.name[:6] or diagnostic.severity is Severity.ERROR
    ]
    return replace(report, diagnostics=kept)


@for_each("case", CASES, ids=lambda case: case.name, shards=4)
def test_bad_model_is_reported_where_it_is_bad(case, monkeypatch):
    monkeypatch.chdir(case)
    monkeypatch.setenv("AMENT_PREFIX_PATH", INSTALLED)
    report = findings_of(case, "bad.xmi")
    assert text.render(report) == Path("expected").read_text(encoding="utf-8")
    assert {diagnostic.rule for diagnostic in report.diagnostics} == {case.name[:6]}


@for_each("case", CASES, ids=lambda case: case.name, shards=4)
def test_good_model_is_not_reported(case, monkeypatch):
    monkeypatch.chdir(case)
    monkeypatch.setenv("AMENT_PREFIX_PATH", INSTALLED)
    assert text.render(findings_of(case, "good.xmi")) == ""


def test_every_rule_has_a_case():
    assert {case.name[:6] for case in CASES} == {rule.id for rule in all_rules()}


def test_ids_are_unique_and_in_their_groups():
    ids = [rule.id for rule in all_rules()]
    assert len(set(ids)) == len(ids)
    assert all(rule_id[:4] in ("JML3", "JML4", "JML5") and len(rule_id) == 6 for rule_id in ids)


@for_each("rule", all_rules(), ids=lambda rule: rule.id)
def test_documentation_has_a_bad_and_a_good_example(rule):
    assert "\nBad: " in rule.documentation
    assert "\nGood: " in rule.documentation
