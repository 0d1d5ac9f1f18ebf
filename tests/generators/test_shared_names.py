"""Names that meet in generated code: of programs, messages, events, actions and connections."""

import re

import pytest
from generated import model_in, text_of, texts_of

from jausml.runtime import BridgeSettings, JausAddress
from jausml.runtime.bridge.bridge import Bridge
from jausml_generators.bridge.parameters import parameter_lines
from jausml_generators.bridge.target import TARGET as BRIDGES
from jausml_generators.bridge.views import bridge_views
from jausml_generators.jaus_component.target import TARGET as COMPONENTS
from jausml_generators.messages.target import TARGET as MESSAGES

MODEL = """
service Lamp {
    urn: "urn:example:Lamp"
    inputs: new message_def Lamp { code: 0xD101 }
    inputs: new message_def ADDRESS { code: 0xD102 }
    inputs: new message_def Siren { code: 0xD103 }
    events: new internal_event Lamp { }
    machines: new state_machine Walk {
        states: new state Off { initial: true
            transitions: new transition { event: Lamp  target: "On"
                actions: new action refused { } }
            transitions: new transition { message: Lamp  target: "On" } }
        states: new state On { }
    }
}
component lamp { address: 1.1.1  provides: Lamp }
component transport { address: 1.1.3  provides: Lamp }
seen { JAUS Siren  ROS std_msgs/Empty  JAUS->ROS ( ) }
bridge siren { address: 1.1.2  provides: Lamp
    connection translate_seen { map: seen  topic again { } }
    connection seen { map: seen  topic seen { } } }
"""
"""A message has the name of its component, of its bridge, of its event; its machine one of ours."""


@pytest.fixture(scope="module")
def texts(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    return texts_of(model_in(tmp_path_factory.mktemp("names"), MODEL), [BRIDGES, COMPONENTS])


def test_a_program_leaves_the_names_of_messages_and_of_the_runtime_to_them(texts):
    assert "class LampComponent(LampComponentBase):" in texts["lamp/lamp/lamp.py"]
    assert "class SirenBridge(SirenBridgeBase):" in texts["siren/siren/siren.py"]
    # The runtime has a class Transport too.
    other = texts["transport/transport/transport.py"]
    assert "class TransportComponent(" in other


def test_a_constant_of_a_base_hides_no_message(texts):
    base = texts["transport/transport/transport_base.py"]
    assert re.search(r"^ADDRESS = JausAddress", base, re.MULTILINE)
    assert "self.handle(ADDRESS2, " in base


def test_walks_tell_an_event_from_a_message_of_its_name(texts):
    test = texts["lamp/test/test_lamp.py"]
    assert re.findall(r'\(\("(.*?)", 0, "On"', test) == ["event Lamp", "Lamp"]


def test_a_test_of_machines_hides_none_of_their_methods(texts):
    base = texts["lamp/lamp/lamp_base.py"]
    assert 'self.walk_ = self.add_machine("Walk"' in base
    assert "def refused_(self)" in base


def test_a_connection_hides_no_translation_of_another(texts):
    base = texts["siren/siren/siren_base.py"]
    assert "def translate_seen(self" in base
    assert "self.translate_seen_ = MessageToTopics(" in base


def test_a_type_leaves_the_name_of_any_type_to_python(tmp_path):
    model = model_in(
        tmp_path,
        "level { JAUS ReportLevel ( uint8 x ) { code: 0xD111 }  ROS own_msgs/Any ( uint8 x )\n"
        "JAUS->ROS ( x -> x : user(measured) ) }\n"
        "bridge robot { address: 1.1.1  connection level { map: level  topic level } }",
    )
    base = text_of(model, [BRIDGES])
    assert "from .ros_types import Any as OwnMsgsAny\n" in base


def test_lists_of_records_of_one_name_have_the_classes_of_their_message(tmp_path):
    element = "element: new record r { fixed_field x { type: %s } }"
    model = model_in(
        tmp_path,
        'service Any { urn: "urn:example:Any"  inputs: new message_def SetAny {'
        "code: 0xD301  body: new record AnyRec {"
        f"list some {{ countType: uint8 {element % 'uint8'} }}"
        f"list more {{ countType: uint8 {element % 'int8'} }} }} }} }}\n"
        "any { JAUS SetAny  ROS std_msgs/UInt8MultiArray\n"
        "ROS->JAUS ( data -> some { . -> x }  data -> more { . -> x } ) }\n"
        "bridge robot { address: 1.1.1  connection any { map: any  topic any } }",
    )
    messages = text_of(model, [MESSAGES], "/any_.py")
    assert re.findall(r"    class (\w+):", messages) == ["R", "SetAnyR"]
    made = set(re.findall(r"SetAny\.\w+\(\)", text_of(model, [BRIDGES])))
    assert made == {"SetAny.R()", "SetAny.SetAnyR()"}


LISTS = """
import mappings.local_waypoint_driver

bridge robot {{
    address: 1.1.1
    provides: LocalWaypointListDriver
{connections}
}}
"""
CONNECTION = """
    ros_action_connection `{name}` {{
        action: go
        type: nav2_msgs/FollowWaypoints
        driver: LocalWaypointListDriver
        element: local_waypoint
        goalMember: poses
    }}
"""


def test_a_connection_hides_nothing_of_its_bridge(tmp_path):
    made = Bridge(BridgeSettings(name="robot", address=JausAddress(1, 1, 1)))
    public = {*dir(Bridge), *Bridge.__annotations__, *vars(made)}
    names = sorted(attribute for attribute in public if not attribute.startswith("_"))
    assert {"component", "connections", "follow", "settings"} < set(names)
    connections = "".join(CONNECTION.format(name=name) for name in names)
    base = text_of(model_in(tmp_path, LISTS.format(connections=connections)), [BRIDGES])
    hidden = [name for name in names if f"self.{name}_ = ListToAction(" not in base]
    assert hidden == []


@pytest.mark.parametrize("name", ["range", "input", "map", "filter", "clock", "SonarRange"])
def test_a_connection_is_told_by_its_name_in_the_model(tmp_path, name):
    # In Python it may have another name; diagnostics, parameters and logs say the model's.
    model = model_in(
        tmp_path,
        "import jaus.mobility\nimport mappings.velocity_state_sensor\n"
        "bridge robot { address: 1.1.1  provides: VelocityStateSensor\n"
        f"connection `{name}` {{ map: velocity_state  topic odom }} }}",
    )
    base = text_of(model, [BRIDGES])
    (view,) = bridge_views(model)

    assert f' = TopicsToReport(\n            "{name}",' in base
    owners = {line.name.partition(".")[0] for line in parameter_lines(view) if "." in line.name}
    assert name in owners
    assert view.connections[0].name not in owners - {name}
