"""The engine: one cause is one error, the library is trusted, failures name the rule."""

import re
from pathlib import Path

import pytest

from jausml.language.metamodel.classes import jaus
from jausml.language.model import Severity, library_root, read_models
from jausml.language.semantics.jaus.machines import behaviours_of
from jausml.language.semantics.subject import Subject, remembering
from jausml.language.text.notation import NOTATIONS
from jausml.language.validation.engine import RuleError, check, check_project
from jausml.language.validation.rule import Finding, rule

MODELS = Path(__file__).parents[2] / "models"
MINIMAL = (MODELS / "minimal" / "minimal.xmi").read_text(encoding="utf-8")
PORTABLE = MINIMAL.replace("../library/", "http://www.jausml.org/library/")

MUTATIONS = [
    (name, match.start(group), match.end(group), new)
    for name, pattern, group, new in (
        ("href", r'href="[^"#]*#([^"]*)"', 1, "Nowhere"),
        ("class", r'xsi:type="([^"]*)"', 1, "bridge:Nothing"),
        ("map", r' map="([^"]*)"', 1, "nowhere"),
        ("peers", r' peers="([^"]*)"', 1, "nowhere"),
        ("literal", r' exchange="([^"]*)"', 1, "often"),
        ("address", r' address="([^"]*)"', 1, "one"),
        ("rate", r' rate="([^"]*)"', 1, "fast"),
        ("no name", r' name="[^"]*"', 0, ""),
        ("no target", r' target="[^"]*"', 0, ""),
        ("no source", r' source="[^"]*"', 0, ""),
    )
    for match in re.finditer(pattern, PORTABLE)
]


@pytest.mark.parametrize("mutation", MUTATIONS, ids=lambda mutation: f"{mutation[0]}-{mutation[1]}")
def test_what_could_not_be_read_causes_no_findings_of_rules(mutation, tmp_path):
    _, start, end, new = mutation
    path = tmp_path / "model.xmi"
    path.write_text(PORTABLE[:start] + new + PORTABLE[end:], encoding="utf-8")
    rules = {diagnostic.rule for diagnostic in check_project([path]).diagnostics}
    assert rules
    assert all(rule_id < "JML3" for rule_id in rules)


# Reproduced as published: CBRNDetection has 14 optional members under an 8-bit presence vector, and
# CBDetailedMeasurement and RNDetailedMeasurement share the code 0xF932.
FAULTS_OF_PUBLISHED_SETS = {("iop.xmi", "JML312"), ("iop.xmi", "JML323")}


def test_shipped_models_keep_all_rules():
    models = sorted(MODELS.rglob("*.xmi"))
    assert len(models) > 5
    report = check_project(models)
    found = {(Path(finding.location.path).name, finding.rule) for finding in report.diagnostics}
    assert found == FAULTS_OF_PUBLISHED_SETS
    assert not report.count(Severity.ERROR)


def test_a_service_with_published_faults_can_be_provided(tmp_path):
    """Two of its messages share a code; the others are as good as any."""
    path = tmp_path / "model.xmi"
    path.write_text(
        '<system:System xmlns:system="http://www.jausml.org/system/1.0" name="sniffer">'
        '<components name="sniffer" address="1.1.1">'
        '<provides href="http://www.jausml.org/library/jaus/iop.xmi#CBRNSensor"/>'
        "</components></system:System>",
        encoding="utf-8",
    )
    (found,) = check_project([path]).diagnostics
    assert (found.rule, found.severity) == ("JML313", Severity.WARNING)
    assert "0xF932" in found.message


def test_a_ready_map_without_vectors_would_not_be_shipped():
    path = library_root() / "mappings" / "range_sensor.ros2jaus"
    text = re.sub(r"\n    vector .*?\n    \)", "", path.read_text("utf-8"), flags=re.DOTALL)
    edited = {path.resolve(): text.encode()}
    found = check(read_models([path], notations=NOTATIONS, contents=edited)).diagnostics
    assert {(e.rule, e.severity) for e in found} == {("JML517", Severity.ERROR)}


def test_all_shipped_services_fit_into_one_component(tmp_path):
    hrefs = [
        f'<provides href="http://www.jausml.org/library/jaus/{name}.xmi#{service}"/>'
        for name in ("core-1.1", "mobility")
        for service in re.findall(
            r'<services xmi:id="(\w+)"',
            (library_root() / "jaus" / f"{name}.xmi").read_text(encoding="utf-8"),
        )
    ]
    path = tmp_path / "model.xmi"
    path.write_text(
        '<system:System xmlns:system="http://www.jausml.org/system/1.0" name="all">'
        f'<components name="all" address="1.1.1">{"".join(hrefs)}</components></system:System>',
        encoding="utf-8",
    )
    assert len(hrefs) > 10
    assert check_project([path]).diagnostics == ()


def test_systems_of_several_files_do_not_disturb_each_other(tmp_path):
    for name in ("first.xmi", "second.xmi"):
        (tmp_path / name).write_text(PORTABLE, encoding="utf-8")
    report = check_project([tmp_path / "first.xmi", tmp_path / "second.xmi"])
    assert report.diagnostics == ()
    assert len(report.files) == 2


def test_findings_are_in_one_order_whatever_the_order_of_files(tmp_path):
    for name in ("first.xmi", "second.xmi"):
        bad = PORTABLE.replace('rate="10.0"', 'rate="-1"').replace("Velocity_X", "Velocity")
        (tmp_path / name).write_text(bad, encoding="utf-8")
    paths = [tmp_path / "first.xmi", tmp_path / "second.xmi"]
    findings = check_project(paths).diagnostics
    assert check_project(paths[::-1]).diagnostics == findings
    assert [finding.rule for finding in findings] == ["JML411", "JML425"] * 2


def test_library_is_checked_only_when_it_is_named(tmp_path):
    @rule("JML399", "any service", severity=Severity.WARNING)
    def any_service(subject):
        """Reports every service."""
        for service in subject.instances(jaus.Service):
            yield Finding(service, "a service", "name")

    path = tmp_path / "model.xmi"
    path.write_text(PORTABLE, encoding="utf-8")
    assert check(read_models([path]), [any_service]).diagnostics == ()
    library = library_root() / "jaus" / "mobility.xmi"
    report = check(read_models([library]), [any_service])
    assert report.has_warnings
    assert not report.has_errors
    assert report.diagnostics[0].location.line > 1


def test_rule_that_fails_is_named(tmp_path):
    @rule("JML398", "broken rule")
    def broken(subject):
        """Fails."""
        yield from {}[subject]

    path = tmp_path / "model.xmi"
    path.write_text(PORTABLE, encoding="utf-8")
    with pytest.raises(RuleError, match=r"rule JML398 \(broken rule\) failed: KeyError"):
        check(read_models([path]), [broken])


def test_finding_names_element_and_fragment(tmp_path):
    path = tmp_path / "model.xmi"
    path.write_text(PORTABLE.replace('rate="10.0"', 'rate="-1"'), encoding="utf-8")
    (finding,) = check_project([path]).diagnostics
    assert finding.element == "minimal/sensor_bridge/velocity"
    assert finding.fragment == "//@bridges.0/@bridgeConnections.0"
    assert finding.location.path == str(path)
    assert PORTABLE.splitlines()[finding.location.line - 1][
        finding.location.column - 1 :
    ].startswith("rate=")


def test_validation_gives_elements_no_empty_values(tmp_path):
    """An element that is asked for a feature that it has not keeps an empty collection of it."""
    path = tmp_path / "set.xmi"
    path.write_text(
        '<jaus:ServiceSet xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"'
        ' xmlns:jaus="http://www.jausml.org/jaus/1.0" name="Empty"/>',
        encoding="utf-8",
    )
    model = read_models([path]).model
    (whole,) = model.roots
    before = set(whole.__dict__)
    assert Subject(model).instances(jaus.ServiceSet) == [whole]
    assert set(whole.__dict__) == before


def test_machines_are_put_together_once_for_all_rules():
    subject = Subject(read_models([library_root() / "jaus" / "core-1.1.xmi"]).model)
    with remembering():
        for service in subject.instances(jaus.Service):
            assert behaviours_of(subject, service) is behaviours_of(subject, service)
