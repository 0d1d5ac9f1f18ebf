"""Verdicts after edits are those of a first reading, and end when nobody wants them any more."""

import random
from pathlib import Path

import pytest
from edits import Edits
from fleets import fleet
from sweeps import sweep

from jausml.authoring.editing.commands import Set
from jausml.authoring.editing.project import Project
from jausml.authoring.studio.checking import Verdicts
from jausml.language.metamodel.classes import bridge
from jausml.language.model.library import LIBRARY_URI
from jausml.language.project import Models
from jausml.language.validation.engine import SupersededError, check

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


def found(models, files):
    """Returns what is found in the first of some files, as they are read by models."""
    contents = {name: text.encode() for name, text in files.items()}
    result = models.read((min(contents),), contents)
    report = check(result)
    is_good = not any(finding.rule.startswith(("JML1", "JML7")) for finding in result.diagnostics)
    return (report.diagnostics, report.set_aside, report.files), is_good


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("seed", sweep(range(2), every=2))
def test_a_verdict_after_edits_is_that_of_a_first_reading(start, seed, tmp_path):
    edits = Edits(STARTS[start], random.Random(seed))
    models, verdicts = Models(tmp_path), set()
    _, is_good = found(models, edits.files)
    for number in range(8):
        edits.step(is_good=is_good)
        verdict, is_good = found(models, edits.files)
        assert verdict == found(Models(tmp_path), edits.files)[0], number
        verdicts.add(verdict)
    # Edits that change nothing would prove nothing.
    assert len(verdicts) > 8 / 3


def test_what_nobody_wants_any_more_is_not_judged_to_its_end(tmp_path):
    result = Models(tmp_path).read(("a.ros2jaus",), {"a.ros2jaus": TEXT.encode()})
    asked = iter(range(10))
    with pytest.raises(SupersededError):
        check(result, is_wanted=lambda: next(asked) < 9)
    assert next(asked, None) is None  # it has asked for each element, and no more


class EditedMeanwhile(Project):
    """A project that somebody edits while it is judged: after so many looks at its revision."""

    looks = 0
    edits = 0

    @property
    def revision(self):
        self.looks += 1
        if self.looks in (20, 40) and self.edits < 2:
            self.edits += 1
            self.do([Set(self.connection, "rate", (f"{self.edits}.5",))], "rate")
        return super().revision


def test_an_edit_ends_the_verdict_on_what_was_before(tmp_path):
    (tmp_path / "a.ros2jaus").write_text(TEXT, encoding="utf-8")
    project = EditedMeanwhile(tmp_path / "a.ros2jaus")
    model = project.model("a.ros2jaus").model
    project.connection = project.ref(model.instances(bridge.Connection)[0], model)
    project.looks = 0
    verdict = Verdicts(project).of("a.ros2jaus")
    assert project.edits == 2
    assert verdict.revision == Project.revision.fget(project) == 2
    rate = verdict.result.model.instances(bridge.Connection)[0].rate
    assert rate == pytest.approx(2.5)
