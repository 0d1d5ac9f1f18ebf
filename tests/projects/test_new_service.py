"""`jausml new service`: services with messages in words, in both notations."""

from __future__ import annotations

import emf_check
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sweeps import sweep

from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.proposals.message_words import KINDS, message_of_words
from jausml.language.metamodel.classes import jaus
from jausml.language.model import read_models
from jausml.language.model.names import name_of
from jausml.language.semantics.jaus.services import code, lineage
from jausml.language.text.notation import NOTATIONS

NOTATION = pytest.mark.parametrize("notation", ["xmi", "text"])
DEPTH = "ReportDepth: Depth m 0..100, State off|on|auto, Count 0..10, Note? text, T TimeStamp"


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
    return {name_of(each): each for each in read.instances(jaus.Service, library=False)}


def codes(service):
    return {name_of(m): f"{code(m):04X}" for m in (*service.inputs, *service.outputs)}


@NOTATION
def test_messages_in_words_are_messages_with_queries_and_events(water, jausml, notation):
    model = water(notation)
    done = jausml(
        *("new", "service", "Sonar", "--message", DEPTH),
        *("--message", "SetDepth: Depth m 0..100 uint32", "--message", "command Stop D1F0"),
    )
    assert done.exit_code == 0, done.output
    assert "sends 0xD401 ReportDepth: Depth, State, Count, Note, T\n" in done.output
    assert jausml("new", "component", "sonar", "--provides", "Sonar").exit_code == 0
    done = jausml("validate", model, "--strict")
    assert done.exit_code == 0, done.output
    sonar = services(model)["Sonar"]
    assert sonar.urn == "urn:example:water:Sonar"
    assert codes(sonar) == {
        "QueryDepth": "D201",
        "SetDepth": "D101",
        "Stop": "D1F0",
        "ReportDepth": "D401",
    }
    assert {"Management", "Events"} <= {name_of(each) for each in lineage(sonar)}
    assert {name_of(each): each.isCommand for each in sonar.inputs} == {
        "QueryDepth": False,
        "SetDepth": True,
        "Stop": True,
    }
    depth, state, count, note, _ = sonar.outputs[0].body.fields
    assert (depth.type.name, depth.units, depth.scale.upper) == ("uint16", "m", 100)
    assert [each.name for each in state.values.values] == ["off", "on", "auto"]
    assert (count.type.name, count.values.values[0].upper) == ("uint8", 10)
    assert note.optional
    assert sonar.outputs[0].body.presenceVector.name == "uint8"


def test_without_messages_it_has_an_example_that_generates(water, jausml):
    model = water("text")
    assert jausml("new", "service", "Depth").exit_code == 0
    assert jausml("new", "component", "sonar", "--provides", "Depth").exit_code == 0
    assert jausml("validate", model, "--strict").exit_code == 0
    depth = services(model)["Depth"]
    assert codes(depth) == {"QueryDepth": "D201", "ReportDepth": "D401"}
    assert name_of(depth.inherits) == "Events"
    done = jausml("generate", model, "-o", "src")
    assert done.exit_code == 0, done.output


def test_codes_collide_with_nothing_of_the_project(water, jausml):
    model = water("xmi")
    other = model.with_name("other.ros2jaus")
    done = jausml("new", "service", "Far", "--model", other, "--message", "ReportFar D402: A")
    assert done.exit_code == 0, done.output
    for name in ("Near", "Next"):
        assert jausml("new", "service", name, "--model", model).exit_code == 0
    found = services(model)
    assert codes(found["Near"]) == {"QueryNear": "D201", "ReportNear": "D401"}
    assert codes(found["Next"]) == {"QueryNext": "D203", "ReportNext": "D403"}
    assert codes(services(other)["Far"]) == {"QueryFar": "D202", "ReportFar": "D402"}
    for taken, owner in (("D402", "Far.ReportFar"), ("4404", "VelocityStateSensor")):
        words = ("--message", f"ReportIt {taken}: A", "--model", model)
        done = jausml("new", "service", "It", *words)
        assert (done.exit_code, f"the code 0x{taken} is that of {owner}" in done.output) == (
            2,
            True,
        )


def test_it_inherits_what_is_said(water, jausml):
    model = water("text")
    assert jausml("new", "service", "A", "--inherits", "none").exit_code == 0
    assert jausml("new", "service", "B", "--inherits", "VelocityStateSensor").exit_code == 0
    found = services(model)
    assert found["A"].inherits is None
    assert name_of(found["B"].inherits) == "VelocityStateSensor"
    assert jausml("validate", model).exit_code == 0


@pytest.mark.needs("emf")
def test_eclipse_opens_it(rover, jausml):
    model = rover("xmi")
    assert jausml("new", "service", "Sonar", "--message", DEPTH).exit_code == 0
    done = emf_check.ask(str(model.relative_to(model.parents[1])), cwd=model.parents[1])
    assert (done.returncode, done.stdout) == (0, "")


@pytest.mark.parametrize(
    ("words", "kind", "type_", "inner"),
    [
        ("ReportA: B", "report", "float32", ()),
        ("QueryA: B uint8", "query", "uint8", ()),
        ("Go: B m/s -2..2", "command", "uint16", ("jaus.ScaleRange",)),
        ("query A: B 0..1 scaled", "query", "uint16", ("jaus.ScaleRange",)),
        ("A: B 0..1.5", "command", "uint16", ("jaus.ScaleRange",)),
        ("A: B -5..300", "command", "int16", ("jaus.ValueSet",)),
        ("A: B 0..100 meter per second uint32", "command", "uint32", ("jaus.ScaleRange",)),
        ("A: B on|off uint16", "command", "uint16", ("jaus.ValueSet",)),
    ],
)
def test_words_of_a_field(words, kind, type_, inner):
    made = message_of_words(words)
    [field] = made.fields
    assert made.kind == kind
    assert field.values["type"] == (type_,)
    assert tuple(each.kind for each in field.children) == inner


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("", "a message has a name"),
        ("Report-A: B", "'Report-A' is no name"),
        ("ReportA X: B", "'X' is no code such as 0xD101"),
        ("ReportA D100 D101", "'D101' is no code"),
        ("ReportA: B, B", "two fields are named B"),
        ("ReportA: B,", "'' is no name of a field"),
        ("ReportA: B mete", "did you mean"),
        ("ReportA: B 0..", "'0..' is no range"),
        ("ReportA: B m 5..0", "begins above its end"),
        ("ReportA: B m 0..5 float32", "a float32 has no range"),
        ("ReportA: B m 0..5 int16", "is an unsigned integer"),
        ("ReportA: B scaled", "needs a range"),
        ("ReportA: B a|a", "lists a value twice"),
        ("ReportA: B a|", "none empty"),
        ("ReportA: B text m", "a text has no unit"),
        ("ReportA: B 0..1e30", "no integer type holds"),
        ("ReportA: B m 0..1e999", "is no number"),
        ("ReportA: B 0..300 uint8", "uint8 does not hold 0..300"),
    ],
)
def test_words_that_describe_no_message(words, told):
    with pytest.raises(AnswerError, match=told.replace(".", r"\.")):
        message_of_words(words)


@settings(max_examples=200, deadline=None)
@given(
    st.lists(
        st.sampled_from(
            [
                "ReportA",
                "B",
                "B?",
                ":",
                ",",
                "m",
                "per",
                "0..1",
                "-5..300",
                "1..",
                "on|off",
                "|",
                "uint8",
                "int16",
                "float32",
                "text",
                "TimeStamp",
                "scaled",
                "D100",
                "query",
                "\x00",
            ]
        ),
        max_size=12,
    )
)
def test_any_words_are_a_message_or_told_of(words):
    try:
        made = message_of_words(" ".join(words))
    except AnswerError:
        return
    assert made.kind in KINDS
    assert made.child(0xD100).values["name"] == (made.name,)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--message", "ReportA: B mete"), "field B: 'mete' is no unit"),
        (("--message", "A: B", "--message", "A: C"), "two messages are named A"),
        (("--inherits", "Managment"), "did you mean 'Management'?"),
        (("--urn", "urn:jaus:jss:core:Time"), "already"),
    ],
)
def test_bad_words_change_nothing(water, jausml, words, told):
    model = water("xmi")
    before = model.read_bytes()
    done = jausml("new", "service", "Sonar", *words)
    assert (done.exit_code, told in done.output) == (2, True), done.output
    done = jausml("new", "service", "So nar")
    assert (done.exit_code, "is no name" in done.output) == (2, True), done.output
    assert model.read_bytes() == before


@pytest.mark.slow
@pytest.mark.parametrize("suffix", sweep(["xmi", "ros2jaus"], every=2))
def test_a_file_of_services_has_no_system(rover, jausml, suffix):
    """A second system would have each further verb ask which one is meant."""
    rover("xmi")
    for name in ("Sonar", "Lamp"):
        done = jausml("new", "service", name, "--model", f"models/services.{suffix}")
        assert done.exit_code == 0, done.output
        assert f"Report{name}" in done.output
    assert jausml("new", "component", "a", "--provides", "PrimitiveDriver").exit_code == 0
    done = jausml("validate", "models")
    assert done.exit_code == 0, done.output
    model = read_models([f"models/services.{suffix}"], notations=NOTATIONS).model
    [services] = model.documents[0].roots
    assert services.name == "services"
    assert [each.name for each in services.services] == ["Sonar", "Lamp"]


@NOTATION
@pytest.mark.parametrize("urn", ['urn:x:y"} component c {', "Sonar", "urn:example:" + "a" * 255])
def test_a_urn_that_is_none_is_refused(water, jausml, notation, urn):
    model = water(notation)
    before = model.read_bytes()
    done = jausml("new", "service", "Sonar", "--model", model, "--urn", urn)
    assert done.exit_code == 2
    assert "URN" in done.stderr
    assert model.read_bytes() == before
