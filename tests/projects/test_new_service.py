"""`jausml new service`: services with messages, in both notations."""

import pytest
from sweeps import sweep

from jausml.language.metamodel.classes import jaus
from jausml.language.model import read_models
from jausml.language.model.names import name_of
from jausml.language.semantics.jaus.inheritance import lineage
from jausml.language.semantics.jaus.services import code
from jausml.language.text.notation import NOTATIONS

NOTATION = pytest.mark.parametrize("notation", ["xmi", "text"])


@pytest.fixture
def water(tmp_path, monkeypatch):
    """Makes an empty model in a notation, and works beside it; returns it."""

    def make(notation):
        (tmp_path / ".git").mkdir()
        monkeypatch.chdir(tmp_path)
        model = tmp_path / f"water.{'xmi' if notation == 'xmi' else 'ros2jaus'}"
        if notation == "text":
            model.write_text("system water\n", "utf-8")
        else:
            model.write_text(
                '<?xml version="1.0" encoding="UTF-8"?>\n'
                '<system:System xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"'
                ' xmlns:system="http://www.jausml.org/system/1.0" name="water"/>\n',
                "utf-8",
            )
        return model

    return make


def services(model):
    read = read_models([model], project_root=model.parent, notations=NOTATIONS).model
    return {name_of(service): service for service in read.instances(jaus.Service, library=False)}


def codes(service):
    return {name_of(m): f"{code(m):04X}" for m in (*service.inputs, *service.outputs)}


@NOTATION
def test_named_messages_have_kinds_codes_and_queries(water, jausml, notation):
    model = water(notation)
    done = jausml(
        *("new", "service", "Sonar", "--message", "ReportDepth", "--message", "SetDepth"),
        *("--message", "Stop", "--message", "RejectStop"),
    )
    assert "sends 0xD401 ReportDepth: Value\n" in done.output
    jausml("new", "component", "sonar", "--provides", "Sonar")
    done = jausml("validate", model, "--strict")
    sonar = services(model)["Sonar"]
    assert sonar.urn == "urn:example:water:Sonar"
    assert codes(sonar) == {
        "QueryDepth": "D201",
        "SetDepth": "D101",
        "Stop": "D102",
        "ReportDepth": "D401",
        "RejectStop": "D402",
    }
    assert {"Management", "Events"} <= {name_of(service) for service in lineage(sonar)}
    assert {name_of(message): message.isCommand for message in sonar.inputs} == {
        "QueryDepth": False,
        "SetDepth": True,
        "Stop": True,
    }
    [value] = sonar.outputs[0].body.fields
    assert (value.type.name, value.units, value.scale.upper) == ("uint16", "percent", 100)


def test_without_messages_it_has_an_example_that_generates(water, jausml):
    model = water("text")
    jausml("new", "service", "Depth")
    jausml("new", "component", "sonar", "--provides", "Depth")
    jausml("validate", model, "--strict")
    depth = services(model)["Depth"]
    assert codes(depth) == {"QueryDepth": "D201", "ReportDepth": "D401"}
    assert name_of(depth.inherits) == "Events"
    jausml("generate", model, "-o", "src")


def test_codes_collide_with_nothing_of_the_project(water, jausml):
    model = water("xmi")
    other = model.with_name("other.ros2jaus")
    jausml("new", "service", "Far", "--model", other)
    other.write_text(other.read_text("utf-8").replace("0xD401", "0xD402"), "utf-8")
    for name in ("Near", "Next"):
        jausml("new", "service", name, "--model", model)
    found = services(model)
    assert codes(services(other)["Far"]) == {"QueryFar": "D201", "ReportFar": "D402"}
    assert codes(found["Near"]) == {"QueryNear": "D203", "ReportNear": "D403"}
    assert codes(found["Next"]) == {"QueryNext": "D204", "ReportNext": "D404"}


def test_it_inherits_what_is_said(water, jausml):
    model = water("text")
    jausml("new", "service", "A", "--inherits", "none")
    jausml("new", "service", "B", "--inherits", "VelocityStateSensor")
    found = services(model)
    assert found["A"].inherits is None
    assert name_of(found["B"].inherits) == "VelocityStateSensor"
    jausml("validate", model)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--message", "ReportA: B"), "'ReportA: B' is no name of a message"),
        (("--message", "A", "--message", "A"), "two messages are named A"),
        (("--inherits", "Managment"), "did you mean 'Management'?"),
        (("--urn", "urn:jaus:jss:core:Time"), "already"),
    ],
)
def test_bad_names_change_nothing(water, refused, words, told):
    model = water("xmi")
    refused(told, model, "new", "service", "Sonar", *words)
    refused("is no name", model, "new", "service", "So nar")


@pytest.mark.slow
@pytest.mark.parametrize("suffix", sweep(["xmi", "ros2jaus"], every=2))
def test_a_file_of_services_has_no_system(rover, jausml, suffix):
    """A second system would have each further verb ask which one is meant."""
    rover("xmi")
    for name in ("Sonar", "Lamp"):
        done = jausml("new", "service", name, "--model", f"models/services.{suffix}")
        assert f"Report{name}" in done.output
    jausml("new", "component", "a", "--provides", "PrimitiveDriver")
    done = jausml("validate", "models")
    model = read_models([f"models/services.{suffix}"], notations=NOTATIONS).model
    [services] = model.documents[0].roots
    assert services.name == "services"
    assert [service.name for service in services.services] == ["Sonar", "Lamp"]


@NOTATION
@pytest.mark.parametrize("urn", ['urn:x:y"} component c {', "Sonar", "urn:example:" + "a" * 255])
def test_a_urn_that_is_none_is_refused(water, refused, notation, urn):
    model = water(notation)
    refused("URN", model, "new", "service", "Sonar", "--model", model, "--urn", urn)
