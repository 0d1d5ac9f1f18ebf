"""Names that meet in generated code: those of programs, messages, events and actions."""

import re

import pytest
from generated import model_in, texts_of

from jausml_generators.bridge.target import TARGET as BRIDGES
from jausml_generators.jaus_component.target import TARGET as COMPONENTS

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
