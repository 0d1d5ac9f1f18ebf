"""What `import jausml` offers: models and messages, and its names."""

import ast
import sys
from pathlib import Path

import pytest
from scripts import succeeded

import jausml

ROOT = Path(__file__).resolve().parents[2]
CATVEHICLE = ROOT / "models" / "catvehicle" / "catvehicle.xmi"


def test_every_name_is_there_and_typed():
    stub = ast.parse((ROOT / "jausml" / "__init__.pyi").read_text(encoding="utf-8"))
    imports = [node for node in stub.body if isinstance(node, ast.ImportFrom)]
    typed = {alias.asname: node.module for node in imports for alias in node.names}
    assert {*typed, "__version__"} == set(jausml.__all__)
    for name, home in typed.items():
        assert getattr(jausml, name) is getattr(sys.modules[home], name)
    with pytest.raises(AttributeError, match="has no attribute 'Bridge'"):
        _ = jausml.Bridge


def test_the_package_alone_loads_nothing():
    code = "import sys, jausml; print([m for m in sys.modules if m.startswith('jausml.')])"
    done = succeeded([sys.executable, "-c", code])
    assert done.stdout == "[]\n"


def test_a_model_is_read_and_checked():
    result = jausml.read(CATVEHICLE)
    assert not result.has_errors
    assert result.model.root.name == "catvehicle"
    assert not jausml.validate(CATVEHICLE).has_errors


def test_a_workspace_is_generated(tmp_path):
    result = jausml.generate(CATVEHICLE, tmp_path, targets=["wireshark"])
    assert result.is_written
    assert (tmp_path / "wireshark" / "catvehicle_jaus.lua").is_file()


def test_a_faulty_model_is_not_generated(tmp_path):
    model = tmp_path / "rover.ros2jaus"
    model.write_text("bridge rover {\n    address: nowhere\n}\n", encoding="utf-8")
    with pytest.raises(jausml.ModelError, match=r"rover\.ros2jaus:2:\d+: error") as caught:
        jausml.generate(model, tmp_path / "out")
    assert caught.value.report.has_errors
    assert not (tmp_path / "out").exists()


def test_messages_there_and_back():
    payload = jausml.encode("ReportStatus", {"Status": 1, "Reserved": 0})
    assert payload.hex() == "02400100000000"
    for given in (payload, payload.hex(" ")):
        found = jausml.decode(given)
        assert (found.entry.name, found.fields["ReportStatusRec"]["Status"]) == ("ReportStatus", 1)


@pytest.mark.parametrize(
    ("payload", "error"), [("zz", ValueError), ("0240", jausml.MessageError), (b"", ValueError)]
)
def test_what_is_no_message(payload, error):
    with pytest.raises((error, jausml.MessageError)):
        jausml.decode(payload)
