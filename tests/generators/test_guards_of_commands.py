"""Commands of own services: nobody but the controller is obeyed, however the service is written."""

import re

import pytest
from generated import model_in, text_of

from jausml_generators.bridge.target import TARGET as BRIDGES
from jausml_generators.jaus_component.target import TARGET as COMPONENTS

MAPS = """
set_winch { JAUS SetWinch %s  ROS std_msgs/Float32
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
    code: 0xD101  isCommand: true  body: new record rec { fixed_field speed { type: float32 } }
  }
}
"""
)
SYSTEM = """
component winch { address: 1.1.1  coreServices: none  provides: %(provided)s }
bridge deck {
  address: 1.1.2  coreServices: none  provides: %(provided)s
  connection command { map: set_winch direction: jausToRos topic winch { } }
  connection wind { map: set_winch direction: rosToJaus peers: winch topic wheel { } }
}
"""


def guards(folder, text):
    """Returns the guards in the generated bases: of the handler, and of both connections."""
    model = model_in(folder, f"import `jaus.core-1.1`\n{text}", "demo.ros2jaus")
    winch, deck = (text_of(model, [target]) for target in (COMPONENTS, BRIDGES))
    handler = re.search(r"self\.handle\(\s*SetWinch,[^)]*?when=Guard\.(\w+)", winch)
    taken = re.search(r"when=Guard\.(\w+)", deck)
    sent = re.search(r"control=Guard\.(\w+)", deck)
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
    text = """
        import `jaus.core-1.1`
        service Store {
            urn: "urn:jaus:jss:example:Store"  version: "1.0"  inherits: Events
            inputs: new message_def RemoveThing { code: 0xD101  isCommand: true }
        }
        component store { address: 1.1.1  provides: Store }
    """
    base = text_of(model_in(tmp_path, text), [COMPONENTS])
    assert "RemoveThing" in base
    assert "when=Guard.READY" not in base
    assert "when=Guard.CONTROLLED" not in base
