"""What documentation allows does not count, until its day."""

import json
import re
from dataclasses import replace
from datetime import date
from pathlib import Path

import build_reference
import pytest

from jausml.language.model import read_models
from jausml.language.text.notation import NOTATIONS
from jausml.language.validation.allowances import settled
from jausml.language.validation.engine import check
from jausml.language.validation.formats import sarif, text
from jausml.language.validation.rule import Ground
from jausml.language.validation.rules import ALLOWANCE_RULES

MINIMAL = Path(__file__).parents[2] / "models" / "minimal" / "minimal.xmi"
DOUBTFUL = (
    MINIMAL.read_text(encoding="utf-8")
    .replace("../library/", "http://www.jausml.org/library/")
    .replace(
        '<topics name="velocity"/>',
        '<topics name="velocity"/><safeValue target="twist.linear.x" value="0"/>',
    )
)
ALLOW = "@allow JML426 until 2999-12-31: the topic is for the log alone"
TEXT = """\
/** One JAUS sensor, one bridge, one ROS topic. */
system minimal {
    /** Reports a velocity. */
    component sensor { address: 10.1.1  type: vehicle  provides: VelocityStateSensor }

    /** Publishes the velocity of the sensor. */
    bridge sensor_bridge {
        address: 10.1.2
        uses: VelocityStateSensor

        /** JAUS axes are x forward, y right, z down; ROS axes are x forward, y left, z up. */
        velocity {
            JAUS ReportVelocityState
            ROS geometry_msgs/TwistStamped
            JAUS->ROS (
                clock -> header.stamp
                "base_link" -> header.frame_id
                Velocity_X -> twist.linear.x { whenAbsent: dropMessage }
                YawRate -> twist.angular.z : negate { whenAbsent: dropMessage }
            )
        }

        /**
         * Ten times a second.
         *
         * TAG
         */
        connection velocity {
            map: velocity
            peers: sensor
            rate: 10
            topic velocity
            safeValue: { target: twist.linear.x  value: 0 }
        }
    }
}
"""


def report_on(tmp_path, model, name="model.xmi"):
    (tmp_path / name).write_text(model, encoding="utf-8")
    return check(read_models([tmp_path / name], notations=NOTATIONS))


def said(where, tag, model=DOUBTFUL):
    """Returns the model with a tag at the end of some documentation."""
    assert where in model
    return model.replace(where, f"{where} {tag}")


def rules(report):
    return [diagnostic.rule for diagnostic in report.diagnostics]


def test_without_an_allowance_it_counts(tmp_path):
    report = report_on(tmp_path, DOUBTFUL)
    assert (rules(report), report.set_aside) == (["JML426"], ())


@pytest.mark.parametrize(
    "where", ["Ten times a second.", "Publishes the velocity of the sensor.", "one ROS topic."]
)
def test_it_holds_for_an_element_and_what_it_owns(tmp_path, where):
    report = report_on(tmp_path, said(where, ALLOW))
    assert report.diagnostics == ()
    (aside,) = report.set_aside
    assert (aside.diagnostic.rule, aside.ground) == ("JML426", Ground.ALLOWED)
    assert aside.reason == "the topic is for the log alone"
    assert aside.location.line == next(
        n for n, line in enumerate(said(where, ALLOW).splitlines(), 1) if "@allow" in line
    )
    assert text.summary(report) == "no problems in 1 file; 1 allowed"


# The map of the connection has its name.
@pytest.mark.parametrize("where", ["Reports a velocity.", "y left, z up."])
def test_it_does_not_hold_beside(tmp_path, where):
    report = report_on(tmp_path, said(where, ALLOW))
    assert sorted(rules(report)) == ["JML426", "JML803"]


def test_what_is_mended_leaves_an_allowance_of_nothing(tmp_path):
    fixed = DOUBTFUL.replace('<safeValue target="twist.linear.x" value="0"/>', "")
    report = report_on(tmp_path, said("Ten times a second.", ALLOW, fixed))
    (found,) = report.diagnostics
    assert (found.rule, found.element) == ("JML803", "minimal/sensor_bridge/velocity")
    assert report.model.documents[0].data.splitlines()[found.location.line - 1].find(b"@allow") > 0


def test_a_day_that_has_passed(tmp_path):
    report = report_on(tmp_path, said("Ten times a second.", ALLOW.replace("2999", "2001")))
    assert sorted(rules(report)) == ["JML426", "JML802"]
    assert report.set_aside == ()
    (expired,) = (diagnostic for diagnostic in report.diagnostics if diagnostic.rule == "JML802")
    assert "ended on 2001-12-31: 'the topic is for the log alone'" in expired.message


@pytest.mark.parametrize(("day", "counts"), [(30, False), (31, True)])
def test_the_last_day_is_among_those_on_which_it_holds(tmp_path, day, counts):
    model = said("Ten times a second.", ALLOW.replace("2999-12-31", "2030-03-30"))
    result = read_models([_written(tmp_path, model)])
    warning = check(read_models([_written(tmp_path, DOUBTFUL, "other.xmi")])).diagnostics[0]
    place = type(warning.location)(result.model.documents[0].display, 1, 1)
    moved = replace(warning, location=place)
    standing, aside = settled(result.model, [moved], [], date(2030, 3, day))
    assert (moved in standing, bool(aside)) == (counts, not counts)


def _written(tmp_path, model, name="model.xmi"):
    (tmp_path / name).write_text(model, encoding="utf-8")
    return tmp_path / name


@pytest.mark.parametrize(
    ("tag", "what"),
    [
        ("@allow JML426 until 2999-12-31:", "lacks a rule, a day or a reason"),
        ("@allow JML426: because", "lacks a rule, a day or a reason"),
        ("@allow until 2999-12-31: because", "lacks a rule, a day or a reason"),
        ("@allow", "lacks a rule, a day or a reason"),
        ("@allow JML426 until 2999-02-31: because", "2999-02-31 is no day"),
        ("@allow JML999 until 2999-12-31: because", "there is no rule JML999"),
        ("@allow JML803 until 2999-12-31: because", "there is no rule JML803"),
    ],
)
def test_what_cannot_be_read_allows_nothing(tmp_path, tag, what):
    report = report_on(tmp_path, said("Ten times a second.", tag))
    assert sorted(rules(report)) == ["JML426", "JML801"]
    assert any(what in diagnostic.message for diagnostic in report.diagnostics)


def test_several_in_one_documentation(tmp_path):
    tags = f"{ALLOW} @allow JML301 until 2999-12-31: why not"
    report = report_on(tmp_path, said("Ten times a second.", tags))
    (found,) = report.diagnostics
    assert (found.rule, len(report.set_aside)) == ("JML803", 1)
    assert "no finding of JML301" in found.message


def test_an_error_cannot_be_allowed(tmp_path):
    wrong = DOUBTFUL.replace('rate="10.0"', 'rate="2000"')
    tag = ALLOW.replace("JML426", "JML425")
    report = report_on(tmp_path, said("Ten times a second.", tag, wrong))
    assert sorted(rules(report)) == ["JML425", "JML426", "JML803"]
    assert report.has_errors
    assert any("is an error here" in diagnostic.message for diagnostic in report.diagnostics)


def test_where_not_all_could_be_read_nothing_is_called_idle(tmp_path):
    broken = said("Reports a velocity.", ALLOW).replace('type="vehicle"', 'typ="vehicle"')
    assert sorted(rules(report_on(tmp_path, broken))) == ["JML103", "JML426"]


def test_text_allows_in_its_documentation_comments(tmp_path):
    plain = report_on(tmp_path, TEXT.replace("TAG", ""), "model.ros2jaus")
    tag = "@allow JML426 until 2999-12-31: the topic is\n         * for the log alone"
    report = report_on(tmp_path, TEXT.replace("TAG", tag), "model.ros2jaus")
    assert [finding.reason for finding in report.set_aside] == ["the topic is for the log alone"]
    assert (rules(plain), rules(report)) == (["JML426"], [])


def test_models_in_utf_16_allow_too(tmp_path):
    model = said("Ten times a second.", ALLOW).replace("UTF-8", "UTF-16")
    (tmp_path / "model.xmi").write_bytes(model.encode("utf-16"))
    assert check(read_models([tmp_path / "model.xmi"])).diagnostics == ()


def test_sarif_tells_what_is_allowed_where_and_why(tmp_path):
    report = report_on(tmp_path, said("Ten times a second.", ALLOW))
    (run,) = json.loads(sarif.render(report, "https://example.org/rules.md"))["runs"]
    (result,) = run["results"]
    (suppression,) = result["suppressions"]
    assert suppression["kind"] == "inSource"
    assert suppression["status"] == "accepted"
    assert suppression["justification"] == "the topic is for the log alone"
    region = suppression["location"]["physicalLocation"]["region"]
    assert region["startLine"] == report.set_aside[0].location.line


def test_sarif_links_each_rule_to_its_heading_in_the_reference(tmp_path):
    (run,) = json.loads(
        sarif.render(report_on(tmp_path, DOUBTFUL), "https://example.org/rules.md")
    )["runs"]
    headings = re.findall(r"^## (.+)$", build_reference.rules_page(), re.MULTILINE)
    anchors = {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}
    for rule in run["tool"]["driver"]["rules"]:
        base, _, anchor = rule["helpUri"].partition("#")
        assert (base, anchor in anchors) == ("https://example.org/rules.md", True), rule["id"]
        assert rule["help"]["markdown"].startswith(f"**{rule['id']}: ")


def test_each_rule_of_allowances_has_a_test_and_an_example():
    tests = Path(__file__).read_text(encoding="utf-8")
    for rule, info in ALLOWANCE_RULES.items():
        assert rule in tests
        assert re.search(r"Good: ", info.explanation)
