"""Quick fixes of findings: done through a project, the finding is gone and no other has come."""

import shutil
from collections import Counter
from pathlib import Path

import pytest

from jausml.authoring.editing.project import Project
from jausml.authoring.proposals.elements import Scope
from jausml.authoring.proposals.quick_fixes.fixes import QUICK_FIXES, quick_fixes
from jausml.language.validation.engine import check

RULES = Path(__file__).resolve().parents[1] / "cases" / "rules"
CASES = sorted(path for path in RULES.iterdir() if path.name[:6] in QUICK_FIXES)
UNCOVERED = {
    # What the error of a path or of a conversion hides is found when that is fixed.
    ("JML411", "JML433"),
    ("JML411", "JML459"),
    ("JML433", "JML437"),
    # A sign that is turned is one that nothing else may be able to judge.
    ("JML433", "JML517"),
    ("JML458", "JML517"),
}
OF_THE_READER = {"JML105", "JML106", "JML202", "JML215"}
"""Rules whose bad models are made below."""
UNTRIED = {"JML441", "JML452"}
"""Rules whose bad models are made below too."""
MOST = 9
"""Findings of a model that are fixed."""
HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<system:System xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xmlns:bridge="http://www.jausml.org/bridge/1.0" xmlns:system="http://www.jausml.org/system/1.0"
    name="example">
"""


def judged(project, file):
    report = check(project.model(file))
    return report, Counter((finding.rule, finding.message) for finding in report.diagnostics)


def cure_all(project, file, rule):
    """Tries each fix of the findings of a rule by itself; returns how many there were."""
    report, before = judged(project, file)
    scope, count = Scope(report.model, project.root), 0
    for found in report.diagnostics:
        for fix in quick_fixes(scope, found) if found.rule == rule and count < MOST else ():
            project.do(fix.commands, fix.label)
            _, after = judged(project, file)
            assert after[rule, found.message] < before[rule, found.message], fix
            new = {key for key in after - before if (rule, key[0]) not in UNCOVERED}
            assert not new, (found, fix)
            project.undo()
            assert judged(project, file)[1] == before
            count += 1
    return count


@pytest.mark.parametrize("rule", sorted(set(QUICK_FIXES) - OF_THE_READER - UNTRIED))
def test_a_cure_makes_its_finding_go_and_no_other_come(rule, tmp_path):
    count = 0
    for case in CASES:
        if case.name.startswith(rule):
            folder = tmp_path / case.name
            folder.mkdir()
            shutil.copy(case / "bad.xmi", folder)
            count += cure_all(Project(folder), "bad.xmi", rule)
    assert count, "none of its bad models is fixed"


@pytest.mark.parametrize(
    ("rule", "body"),
    [
        ("JML105", '<hosts name="one" transport="jtpc"/>'),
        ("JML106", '<hosts name="one" port="many"/>'),
    ],
)
def test_values_that_cannot_be_read_are_cured(rule, body, tmp_path):
    (tmp_path / "bad.xmi").write_text(f"{HEAD}  {body}\n</system:System>\n")
    assert cure_all(Project(tmp_path), "bad.xmi", rule)


def test_names_that_nobody_has_are_cured_in_text(tmp_path):
    text = "system example {\n    component car { address: 1.1.1  provides: LocalPoseSensr }\n}\n"
    (tmp_path / "bad.ros2jaus").write_text(text)
    project = Project(tmp_path)
    report, _ = judged(project, "bad.ros2jaus")
    scope = Scope(report.model, project.root)
    [found] = [diagnostic for diagnostic in report.diagnostics if diagnostic.rule == "JML215"]
    best, *_ = quick_fixes(scope, found)
    [value] = best.commands[0].values
    assert scope.find(value).name == "LocalPoseSensor"


def test_the_library_is_not_cured():
    project = Project(RULES / "JML411-paths")
    report, _ = judged(project, "bad.xmi")
    scope = Scope(report.model, project.root)
    for document in scope.model.documents:
        document.is_library = True
    assert not any(quick_fixes(scope, diagnostic) for diagnostic in report.diagnostics)
