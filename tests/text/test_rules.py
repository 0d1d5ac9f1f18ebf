"""The rules of the text language are data, and each of them has a failing text."""

import re
from pathlib import Path

from for_each import for_each

from jausml.language.text.notation import TEXT_RULES
from jausml.language.validation.engine import check

HERE = Path(__file__).parent
SOURCES = HERE.parents[1] / "jausml" / "language" / "text"


@for_each("rule", TEXT_RULES)
def test_a_rule_says_what_is_bad_and_what_is_good(rule):
    info = TEXT_RULES[rule]
    assert re.fullmatch(r"JML7\d\d", rule)
    assert info.title[-1] != "."
    assert re.search(r"Good: ", info.explanation)


def test_each_rule_has_a_failing_text_and_a_place_that_reports_it():
    tests = "".join(
        path.read_text() for path in HERE.glob("test_*.py") if path.name != "test_rules.py"
    )
    sources = "".join(p.read_text() for p in SOURCES.rglob("*.py") if p.name != "rules.py")
    for rule in TEXT_RULES:
        assert rule in tests, rule
        assert rule in sources, rule
    reported = set(re.findall(r"JML7\d\d", sources))
    assert reported == set(TEXT_RULES)


def test_hints_are_spelt_as_the_file_is(texts):
    text = """bridge b { address: 100.1.2 }
m {
    JAUS ReportVelocityState ROS std_msgs/Float64
    JAUS->ROS ( Velocity_X -> data { defaultValue: 0 } )
}
n {
    JAUS ReportCostMap2D ROS std_msgs/UInt8
    JAUS->ROS ( CostMap2DDataVar.CostDataList -> data )
}
"""
    hints = {
        finding.rule: finding.hint for finding in check(texts.one(text)).diagnostics if finding.hint
    }
    assert "set whenAbsent: useDefault" in hints.values()
    assert any(
        hint.endswith("by a ListAssignment: CostMap2DDataVar.CostDataList -> data { ... }")
        for hint in hints.values()
    ), hints
