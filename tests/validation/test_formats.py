"""Formats of reports, and that what is written is registered."""

import json
import pkgutil
from importlib import import_module

from jausml.language.model import Diagnostic, Location, Related, Severity
from jausml.language.validation import formats, rules
from jausml.language.validation.formats import json as json_format
from jausml.language.validation.formats import text
from jausml.language.validation.rule import Report, Rule
from jausml.language.validation.rules.bridge.deployment import PARAMETERS
from jausml.runtime.bridge.ends import parameters

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


# -- what is written is registered -----------------------------------------------------------------


def modules_in(package):
    """Returns the modules that lie in the folder of a package and below it."""
    names = pkgutil.walk_packages(package.__path__, f"{package.__name__}.")
    return [import_module(name.name) for name in names if not name.ispkg]


def test_each_module_has_rules_and_each_rule_an_id_of_its_own():
    found = rules.all_rules()
    assert len({rule.id for rule in found}) == len(found)
    for module in modules_in(rules):
        own = [member for member in vars(module).values() if isinstance(member, Rule)]
        assert own
        assert set(own) <= set(found)


def test_each_module_that_renders_is_a_format():
    names = [module.__name__ for module in modules_in(formats) if hasattr(module, "render")]
    assert [name.rpartition(".")[2] for name in names] == sorted(formats.RENDERERS)


def test_the_parameters_of_every_bridge_are_known():
    templates = vars(parameters).values()
    known = [value.name for value in templates if isinstance(value, parameters.Template)]
    # Those of a connection begin with its name, and no quantity is called so.
    names = {name for name in known if "{" not in name}
    assert names
    assert names <= PARAMETERS
