"""A judge that stays says of each reading what all rules say of it, and runs little for that."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from edits import Edits
from fleets import fleet
from sweeps import sweep

from jausml.language.metamodel import filling, load_metamodels, watching
from jausml.language.metamodel.classes import jaus
from jausml.language.model import Severity
from jausml.language.model.library import LIBRARY_URI
from jausml.language.model.mirror import Mirror
from jausml.language.project import Models
from jausml.language.semantics.subject import Subject
from jausml.language.validation import judge as judging
from jausml.language.validation.engine import RuleError, check
from jausml.language.validation.judge import Judge
from jausml.language.validation.rule import Finding, rule
from jausml.language.validation.rules import all_rules

MODELS = Path(__file__).parents[2] / "models"

TEXT = (MODELS / "examples" / "catvehicle" / "catvehicle.ros2jaus").read_text("utf-8")
OWN = """
    bridge own {
        address: 300.1.1
        idle {
            JAUS SetIdle ( float64 x  uint8 mode ) { code: 0xD200 }
            ROS geometry_msgs/PointStamped
            JAUS->ROS ( clock -> header.stamp  "odom" -> header.frame_id  x -> point.x )
            ROS->JAUS ( point.x -> x  0 -> mode )
        }
        connection idle {
            map: idle
            direction: rosToJaus
            peers: helper
            topic idle
        }
    }
"""
OTHER = """
component helper {
    external: true
    address: 300.2.1
    provides: PrimitiveDriver, VelocityStateSensor
}
"""
SERVICES = """<?xml version="1.0" encoding="UTF-8"?>
<jaus:ServiceSet xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xmlns:jaus="http://www.jausml.org/jaus/1.0" name="set{n}" version="1.0">
  <services xmi:id="S" name="S{n}" urn="urn:example:a:S{n}" version="1.0">
    {inherits}
    <inputs name="QueryA{n}" code="0x2{n}00"/>
    <outputs name="ReportA{n}" code="0x4{n}00">
      <body xsi:type="jaus:Record" name="Body">
        <fields xsi:type="jaus:FixedField" name="One" type="uint8" units="meter"/>
        <fields xsi:type="jaus:FixedField" name="Two" type="uint8" optional="true"/>
      </body>
    </outputs>
  </services>
</jaus:ServiceSet>
"""


def portable(path):
    return path.read_text("utf-8").replace("../library/", f"{LIBRARY_URI}")


STARTS = {
    "one text": {"a.ros2jaus": TEXT},
    "groups": {"a.ros2jaus": fleet(2)},
    "texts": {
        "a.ros2jaus": 'import "b.ros2jaus"\n' + fleet(1).replace("\n}\n", OWN + "}\n"),
        "b.ros2jaus": OTHER,
    },
    "xmi": {"a.xmi": portable(MODELS / "minimal" / "minimal.xmi")},
    "documents": {
        f"{name}.xmi": SERVICES.format(
            n=n, inherits=f'<inherits href="{after}.xmi#S"/>' if after else ""
        )
        for n, (name, after) in enumerate(("ab", "bc", ("c", "")))
    },
}


class Judged:
    """Random edits of a project, each of which is judged in both ways.

    Attributes:
        differing: Those after which the verdicts differ.
        touched: How many features had another value, for each edit.
        runs: How many answers were worked out, for each edit.
        all_runs: How many answers are worked out at first.
    """

    def __init__(self, files, folder, seed):
        self._edits = Edits(files, random.Random(seed))
        self._models = Models(folder)
        self._judge = Judge()
        self.differing, self.touched, self.runs = [], [], []
        self._is_same()
        self.all_runs = self._judge.runs
        assert self._is_good

    def _is_same(self):
        files = {name: text.encode() for name, text in self._edits.files.items()}
        result = self._models.read((min(files),), files)
        whole = check(result)
        standing = self._judge.report(result)
        self._is_good = not any(
            each.rule.startswith(("JML1", "JML7")) for each in result.diagnostics
        )
        return all(
            getattr(standing, each) == getattr(whole, each)
            for each in ("diagnostics", "set_aside", "files", "model")
        )

    def edit(self, times, touches):
        for number in range(times):
            before = self._judge.runs, len(touches)
            self._edits.step(is_good=self._is_good)
            if not self._is_same():
                self.differing.append(number)
            self.runs.append(self._judge.runs - before[0])
            self.touched.append(len(touches) - before[1])
        return self


@pytest.fixture
def touches(monkeypatch):
    """The features that have got another value."""
    found = []
    touch = Mirror._touch
    monkeypatch.setattr(
        Mirror, "_touch", lambda self, *about: (found.append(about), touch(self, *about))
    )
    return found


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("seed", sweep(range(2), every=2))
def test_its_verdict_is_that_of_all_rules(start, seed, tmp_path, touches):
    judged = Judged(STARTS[start], tmp_path, seed).edit(20, touches)
    assert judged.differing == []
    # Edits that change nothing would prove nothing.
    assert sum(map(bool, judged.touched)) > len(judged.touched) / 3
    assert sum(judged.runs) > len(judged.runs)


def _without_values(monkeypatch):
    def read(self, obj, _=None):
        return obj.__dict__.get(self._name, self._default)

    monkeypatch.setattr(watching._WatchedValue, "__get__", read)


def _without_lists(monkeypatch):
    monkeypatch.setattr(
        watching._WatchedValues,
        "__get__",
        lambda self, obj, _=None: obj.__dict__.get(self._name, ()),
    )


def _without_is_read(monkeypatch):
    monkeypatch.setattr(judging._WatchedSubject, "is_read", Subject.is_read)


def _without_instances(monkeypatch):
    monkeypatch.setattr(judging._WatchedSubject, "instances", Subject.instances)


BLIND = (_without_values, _without_lists, _without_is_read, _without_instances)


@pytest.mark.parametrize("blind", sweep(BLIND, every=4), ids=lambda one: one.__name__)
def test_a_judge_that_notes_less_is_found_out(blind, tmp_path, touches, monkeypatch):
    blind(monkeypatch)
    series = ((seed, start) for seed in range(8) for start in ("groups", "texts", "documents"))
    assert any(
        Judged(STARTS[start], tmp_path, seed).edit(10, touches).differing for seed, start in series
    )


def judged_by(function, text, *others, **each):
    """Returns what a rule says of a model, and of it as it is after each edit, in both ways."""
    made = rule("JML999", "a rule of a test", severity=Severity.WARNING, **each)(function)
    judge, models, said = Judge([made]), Models(Path("/nowhere")), []
    for held in (text, *others):
        result = models.read(("a.ros2jaus",), {"a.ros2jaus": held.encode()})
        found = judge.report(result).diagnostics
        assert found == check(result, [made]).diagnostics
        said += [each.message for each in found if each.rule == "JML999"]
    return said


SMALL = "component one { address: 1.1.1 }\n"


def test_all_ways_of_reading_are_noted():
    """Those too that no rule goes by now."""

    def read(_, component):
        features = load_metamodels().class_of(component).features
        set_ = filling.is_set(component, features["controlTimeout"])
        owned = len(filling.contents(component, features["connections"]))
        yield Finding(component, f"{set_} {owned}")

    timed = SMALL.replace("}", "controlTimeout: 2 }")
    asking = SMALL.replace("}", "service_connection a { } }")
    said = judged_by(read, SMALL, timed, asking, each=jaus.Component)
    assert said == ["False 0", "True 0", "False 1"]


def test_a_fact_that_changes_tells_who_has_asked_for_it():
    def read(subject, component):
        yield Finding(component, subject.once(_name, component))

    def _name(_, component):
        return component.name

    said = judged_by(read, SMALL, SMALL.replace(" one ", " three "), each=jaus.Component)
    assert said == ["one", "three"]


def test_an_element_that_is_read_no_longer_is_noted():
    def read(subject, component):
        yield Finding(component, str(subject.is_intact(component)), "name")

    broken = SMALL.replace("}", "service_connection a { rate: often } }")
    said = judged_by(read, SMALL, broken, SMALL, each=jaus.Component, needs=())
    assert said == ["True", "False", "True"]


def test_a_rule_that_fails_says_so_until_what_it_reads_has_changed():
    def failing(_, component):
        yield Finding(component, f"{1 / (len(component.name) - 3):g}")

    made = rule("JML999", "a rule of a test", severity=Severity.WARNING, each=jaus.Component)(
        failing
    )
    judge, models = Judge([made]), Models(Path("/nowhere"))

    def judged(text):
        return judge.report(models.read(("a.ros2jaus",), {"a.ros2jaus": text.encode()}))

    for _ in range(2):
        with pytest.raises(RuleError, match="JML999"):
            judged(SMALL)
    assert [each.message for each in judged(SMALL.replace(" one ", " three ")).diagnostics] == [
        "0.5"
    ]


KINDS = {
    "number": ("rate: 12", "rate: 13"),
    "documentation": ("/** A report. */", "/** Another one. */"),
    "name": ("connection report_0_1 {", "connection other {"),
    "topic": ("topic report_0_1\n", "topic other\n"),
    "address": ("address: 1.1.1", "address: 1.9.1"),
    "peer": ("peers: vehicle_0", "peers: operator_0"),
    "map": ("YawRate -> twist.angular.z : negate", "YawRate -> twist.angular.z"),
    "added": (
        "    bridge bridge_0 {",
        "    component fresh { address: 9.9.9 }\n    bridge bridge_0 {",
    ),
}


@pytest.mark.slow
def test_an_edit_runs_as_much_in_a_large_model_as_in_a_small_one(tmp_path):
    def runs(groups):
        judge, models, found = Judge(), Models(tmp_path), {}

        def judged(text):
            before = judge.runs
            judge.report(models.read(("a.ros2jaus",), {"a.ros2jaus": text.encode()}))
            return judge.runs - before

        start = fleet(groups)
        judged(start)
        for kind, (old, new) in KINDS.items():
            found[kind] = judged(start.replace(old, new, 1))
            judged(start)
        return found

    few = runs(2)
    assert few == runs(8)
    assert max(few.values()) < 60


WHOLE = {
    *("JML302", "JML311", "JML312", "JML357", "JML368", "JML402", "JML403", "JML409"),
    *("JML428", "JML430", "JML446", "JML450", "JML475", "JML497"),
}
"""Rules that compare elements with others, and look at a model as a whole whenever one changes."""


def test_all_other_rules_judge_each_element_by_itself():
    assert {each.id for each in all_rules() if each.is_whole} == WHOLE
