"""Operators: each one changes the one thing that it says, and what it does can be undone."""

from pathlib import Path

import pytest

from jausml.language.model.xmi.writer import to_xmi
from jausml.language.validation.engine import check_project
from jausml.mutating.operators import OPERATORS
from jausml.mutating.running import mutations, sample

GUARDS = ("jausml/mutating",)

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "models" / "examples"

IN_MODEL = {
    ("sign", "conversions: nothing -> negate"),
    ("sign", "conversions: negate -> nothing"),
    ("factor", "conversions: nothing -> scale"),
    ("offset", "conversions: nothing -> linear"),
    ("figure", "arguments: 10.0 -> 11.0"),
    ("figure", "minimum: 0.5 -> 0.55"),
    ("conversion", "conversions: scale -> nothing"),
    ("member", "source: linear.x -> linear.y"),
    ("member", "target: PropulsiveLinearEffortX -> PropulsiveLinearEffortY"),
    ("assignment", "toJaus: ResistiveLinearEffortX -> nothing"),
    ("constant", "value: 0 -> 1"),
    ("constant", "value: 1.5 -> 1.625"),
    ("constant", "value: true -> false"),
    ("order", "conversions: negate, scale -> scale, negate"),
    ("rate", "maxRate: 50.0 -> 25.0"),
    ("rate", "frequency: 20.0 -> 10.0"),
    ("time-out", "silenceTimeout: 0.5 -> 5.0"),
    ("time-out", "silenceTimeout: 0.5 -> nothing"),
    ("stop", "safeValue: PropulsiveLinearEffortX -> nothing"),
    ("QoS", "reliability: automatic -> reliable"),
    ("figure of QoS", "depth: 4 -> 8"),
    ("figure of QoS", "deadline: 0.5 -> 1.0"),
    ("policy", "outOfRange: dropField -> error"),
    ("control", "control: True -> False"),
    ("authority", "authority: 100 -> 50"),
    ("wiring", "peers: vehicle -> nothing"),
    ("wiring", "publishers: speed -> nothing"),
    ("topic", "name: speed -> speed_2"),
}
IN_WINCH = {
    ("unit", "units: newton -> kilonewton"),
    ("figure", "upper: 20000.0 -> 22000.0"),
    ("table", "values: IDLE -> nothing"),
    ("number of a name", "value: 4 -> 5"),
    ("number of a name", "code: 0xD401 -> 0xD402"),
    ("order", "fields: RopeLength, RopeSpeed -> RopeSpeed, RopeLength"),
    ("control", "isCommand: True -> False"),
    ("guard", "guard: isControllingClient -> nothing"),
    ("target", "target: Locked -> Moving.PayingIn"),
    ("behaviour", "exit: stopMotor -> nothing"),
}
TABLES = """\
lamps {
    JAUS WinchStatus ( uint16 number  float32 v { units: "meter" frame: localUp }  float32 w )
    ROS WinchStatus ( uint16 number  float32 v  float32 w )
    table t ( 1 <-> 4  2 <-> 5 )
    stopRos: {}
    JAUS->ROS ( number -> number : look_up(t)  v -> v  w -> w )
    ROS->JAUS ( number -> number : look_up(t)  v -> v  w -> w )
}
"""
IN_TABLES = {
    ("table entry", "ros: 4 -> 5"),
    ("entries", "ros: 4 -> 5; ros: 5 -> 4"),
    ("sign both ways", "conversions: nothing -> negate; conversions: nothing -> negate"),
    ("members both ways", "target: v -> w; target: w -> v; target: v -> w; target: w -> v"),
    ("stop that drives", "values: nothing -> number"),
    ("table entry", "jaus: 1 -> 2"),
    ("table", "entries: 1 -> nothing"),
    ("frame", "frame: localUp -> localDown"),
}


def model_of(path: Path):
    report = check_project([path])
    assert not report.has_errors, report.diagnostics
    return report.model


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """Returns the models by their names."""
    tables = tmp_path_factory.mktemp("models") / "tables.ros2jaus"
    tables.write_text(TABLES)
    return {
        "drive": model_of(Path(__file__).with_name("drive.ros2jaus")),
        "tables": model_of(tables),
        "winch": model_of(EXAMPLES / "winch" / "winch.xmi"),
    }


EXPECTED = {"drive": IN_MODEL, "winch": IN_WINCH, "tables": IN_TABLES}


@pytest.mark.parametrize("name", EXPECTED)
def test_operators_break_what_they_say(written, name):
    found = {(mutation.operator.name, mutation.words) for mutation in mutations(written[name])}
    assert EXPECTED[name] - found == set()


def test_every_operator_is_among_them():
    named = {operator for expectation in EXPECTED.values() for operator, _ in expectation}
    assert {operator.name for operator in OPERATORS} == named


@pytest.mark.parametrize("name", EXPECTED)
def test_a_mutation_changes_the_document_until_it_is_undone(written, name):
    model = written[name]
    roots = [
        root for document in model.documents if not document.is_library for root in document.roots
    ]
    before = to_xmi(roots, model, "/elsewhere/model.xmi")
    texts = set()
    found = mutations(model)
    for mutation in found:
        undoing = mutation.change.apply()
        texts.add(to_xmi(roots, model, "/elsewhere/model.xmi"))
        undoing.apply()
        assert to_xmi(roots, model, "/elsewhere/model.xmi") == before, mutation.words
    assert before not in texts
    assert len(texts) > 0.9 * len(found)


def test_a_sample_is_spread_over_the_operators_and_the_same_each_time(written):
    found = mutations(written["drive"])
    names = {mutation.operator.name for mutation in found}
    chosen = sample(found, len(names))
    assert {found[index].operator.name for index in chosen} == names
    assert chosen == sorted(chosen) == sample(mutations(written["drive"]), len(names))
    assert sample(found, 10_000) == list(range(len(found)))
    assert [len(sample(found, limit)) for limit in range(len(names) + 3)] == [
        *range(len(names) + 3)
    ]
