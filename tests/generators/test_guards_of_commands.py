"""Commands of own services: nobody but the controller is obeyed, however the service is written."""

import re
from pathlib import Path

import pytest

from jausml.generation.rendering import render
from jausml.language.model import read_models
from jausml.language.text.notation import NOTATIONS
from jausml_generators.bridge.target import TARGET as BRIDGES
from jausml_generators.jaus_component.target import TARGET as COMPONENTS

MAPS = """
set_winch {
  JAUS SetWinch %s
  ROS std_msgs/Float32
  JAUS->ROS ( speed -> data )
  ROS->JAUS ( data -> speed )
}
"""
IN_MAP = MAPS % "( float32 speed ) { code: 0xD101 isCommand: true }"
OWN_SERVICE = (
    MAPS % ""
    + """
service Winding {
  urn: "urn:example:Winding"
  inputs: new message_def SetWinch {
    code: 0xD101
    isCommand: true
    body: new record rec { fixed_field speed { type: float32 } }
  }
}
"""
)
SYSTEM = """
component winch { address: 1.1.1  coreServices: none  provides: %(provided)s }
bridge deck {
  address: 1.1.2
  coreServices: none
  provides: %(provided)s
  connection command { map: set_winch direction: jausToRos topic winch { } }
  connection wind { map: set_winch direction: rosToJaus peers: winch topic wheel { } }
}
"""


def guards(folder, text):
    """Return the guards in the generated bases: of the handler, and of both connections."""
    path = folder / "demo.ros2jaus"
    path.write_text(f"import `jaus.core-1.1`\n{text}", encoding="utf-8")
    read = read_models([path], notations=NOTATIONS)
    assert [error for error in read.diagnostics if error.severity.name == "ERROR"] == []
    bases = {
        Path(artifact.path).name: artifact.text
        for artifact in render(read.model, [BRIDGES, COMPONENTS])
        if artifact.path.endswith("_base.py")
    }
    handler = re.search(
        r"self\.handle\(\s*SetWinch,[^)]*?when=Guard\.(\w+)", bases["winch_base.py"]
    )
    taken = re.search(r"when=Guard\.(\w+)", bases["deck_base.py"])
    sent = re.search(r"control=Guard\.(\w+)", bases["deck_base.py"])
    return [match and match[1] for match in (handler, taken, sent)]


def test_a_service_declared_in_maps_inherits_what_its_commands_need(tmp_path):
    text = IN_MAP + SYSTEM % {"provided": "Demo"}
    assert guards(tmp_path, text) == ["READY", "READY", "READY"]


@pytest.mark.parametrize(
    ("core", "expected"),
    [(", Management", "READY"), (", AccessControl", "CONTROLLED"), ("", "CONTROLLED")],
)
def test_a_service_that_inherits_nothing_shares_the_controller_of_its_component(
    tmp_path, core, expected
):
    text = OWN_SERVICE + SYSTEM % {"provided": f"Winding{core}"}
    assert guards(tmp_path, text) == [expected] * 3


def test_commands_for_everyone_are_those_of_published_services(tmp_path):
    """As those of Digital Resource Discovery: services that inherit Events alone."""
    path = tmp_path / "demo.ros2jaus"
    path.write_text("""
        import `jaus.core-1.1`
        service Store {
            urn: "urn:jaus:jss:example:Store"  version: "1.0"  inherits: Events
            inputs: new message_def RemoveThing { code: 0xD101  isCommand: true }
        }
        component store { address: 1.1.1  provides: Store }
    """)
    read = read_models([path], notations=NOTATIONS)
    base = next(
        artifact.text
        for artifact in render(read.model, [COMPONENTS])
        if artifact.path.endswith("_base.py")
    )
    assert "RemoveThing" in base
    assert "when=Guard.READY" not in base
    assert "when=Guard.CONTROLLED" not in base
