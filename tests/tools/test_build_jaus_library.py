"""The tool that writes the library: from facts to models that our reader takes as they are."""

import json
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import build_jaus_library as tool
import pytest
from needs import SHARED

from jausml.language.metamodel.classes import jaus
from jausml.language.model import read_models

ROOT = Path(__file__).resolve().parents[2]
LIBRARY = ROOT / "models" / "library" / "jaus"
FACTS = "reference/jaus_services.json"
BY_HAND = {"hmi.xmi", "machine-states.xmi", "mission-spooling.xmi"}
"""Sets of one public source, read with `jausml import jsidl` and corrected by hand, and our own."""

NUMBER = {"kind": "fixed_field", "name": "N", "type": "u16", "units": "meter  per\n second"}
GRID = {
    "kind": "array",
    "name": "Grid",
    "dimensions": [{"size": 2}, {"size": 3}],
    "fields": [NUMBER],
}
INTERVAL = {"range": ["1", "9"], "bounds": ["inclusive", "exclusive"]}
CHOICE = {**NUMBER, "name": "Choice", "values": [{"index": 0, "name": "none"}, INTERVAL]}
RECORD = {
    "kind": "record",
    "name": 'A "quoted" <name>',
    "presence_vector": "u8",
    "fields": [{**NUMBER, "optional": True}, GRID, CHOICE],
}
SET_IT = {"name": "SetIt", "id": "4ab", "command": True, "body": {"fields": [RECORD]}}
BASE = {"name": "Base", "urn": "urn:base", "version": "1.0", "inherits": None}
DERIVED = {
    "name": "Derived",
    "urn": "urn:derived",
    "version": "1.0",
    "inherits": {"urn": "urn:base", "version": "1.0"},
    "input": [SET_IT],
    "output": [],
}
SMALL: dict[str, Any] = {
    "sets": {"core-v1.0": [{**BASE, "input": [], "output": []}], "mobility": [DERIVED]}
}


def test_the_facts_arrive_in_the_model(tmp_path, capsys):
    facts = tmp_path / "facts.json"
    facts.write_text(json.dumps(SMALL), "utf-8")
    assert tool.main([str(facts), str(tmp_path / "out")]) == 0
    assert "mobility.xmi" in capsys.readouterr().out
    result = read_models([tmp_path / "out" / "mobility.xmi"])
    assert not result.diagnostics
    (derived,) = (s for s in result.model.instances(jaus.Service) if s.name == "Derived")
    assert derived.inherits.name == "Base"
    (message,) = derived.inputs
    assert (message.code, message.isCommand) == ("0x04AB", True)
    assert message.body.name == 'A "quoted" <name>'
    assert message.body.presenceVector.name == "uint8"
    number, grid, choice = message.body.fields
    assert (number.optional, number.type.name, number.units) == (True, "uint16", "meter per second")
    assert list(grid.dimensions) == [2, 3]
    enumerated, interval = choice.values.values
    assert (enumerated.name, enumerated.value) == ("none", 0)
    assert (interval.lower, interval.upper, interval.upperInclusive) == (1.0, 9.0, False)


def test_the_same_facts_give_the_same_bytes():
    assert tool.build(SMALL) == tool.build(json.loads(json.dumps(SMALL)))


def test_wrong_arguments_show_the_usage(capsys):
    assert tool.main([]) == 2
    assert "Usage" in capsys.readouterr().err


@pytest.mark.parametrize("path", sorted(LIBRARY.glob("*.xmi")), ids=lambda path: path.name)
def test_the_shipped_library_has_no_problem(path):
    result = read_models([path])
    assert not result.diagnostics
    assert list(result.model.instances(jaus.Service))


@pytest.mark.beside(FACTS)
def test_the_shipped_library_is_what_the_facts_say():
    texts = tool.build(json.loads((SHARED / FACTS).read_text("utf-8")))
    shipped = {path.name: path.read_text("utf-8") for path in LIBRARY.glob("*.xmi")}
    assert {name: shipped[name] for name in texts} == texts
    assert set(shipped) - set(texts) == BY_HAND


def fields_of(model: Any, message: str) -> dict[str, Any]:
    """Returns the fields of the messages of a name by `record.field`, and by `field` alone."""
    found = {}
    for definition in model.instances(jaus.MessageDef):
        if definition.name != message:
            continue
        todo = [definition.body]
        while todo:
            around = todo.pop()
            for member in around.eContents:
                if hasattr(member, "frame"):
                    found[f"{around.name}.{member.name}"] = found[member.name] = member
                    todo.append(member)
    return found


@pytest.fixture(scope="module")
def library() -> Any:
    return read_models(sorted(LIBRARY.glob("*.xmi"))).model


def test_axes_and_units_come_from_the_rules(library):
    velocity = fields_of(library, "ReportVelocityState")
    assert velocity["Velocity_Y"].frame.name == velocity["YawRate"].frame.name == "forwardRightDown"
    assert velocity["Velocity_RMS"].frame.name == velocity["TimeStamp"].frame.name == "unstated"
    pose = fields_of(library, "ReportGlobalPose")
    assert (pose["Yaw"].frame.name, pose["Latitude"].frame.name) == ("northEastDown", "geodetic")
    path = fields_of(library, "ReportPath")
    assert path["GlobalPoseRec.Yaw"].frame.name == "northEastDown"
    assert path["LocalPoseRec.Yaw"].frame.name == "localDown"
    wrench = fields_of(library, "SetWrenchEffort")
    assert wrench["PropulsiveRotationalEffortZ"].frame.name == "forwardRightDown"
    assert wrench["ResistiveLinearEffortX"].frame.name == "unstated"
    assert {member.units for member in wrench.values()} == {"percent"}


def test_each_rule_is_for_fields_that_there_are(library):
    rules = tool.frame_rules()
    assert rules
    for rule in rules:
        fields = {message: fields_of(library, message) for message in rule.messages}
        assert all(fields.values()), rule.messages
        names = set().union(*fields.values())
        for pattern in rule.fields:
            assert any(fnmatchcase(name, pattern) for name in names), pattern
