"""Names of connections: none hides what a bridge has anyway."""

import pytest
from generated import model_in, text_of

from jausml.runtime import BridgeSettings, JausAddress
from jausml.runtime.bridge.bridge import Bridge
from jausml_generators.bridge.parameters import parameter_lines
from jausml_generators.bridge.target import TARGET
from jausml_generators.bridge.views import bridge_views

MODEL = """
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
    base = text_of(model_in(tmp_path, MODEL.format(connections=connections)), [TARGET])
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
    base = text_of(model, [TARGET])
    (view,) = bridge_views(model)

    assert f' = TopicsToReport(\n            "{name}",' in base
    owners = {line.name.partition(".")[0] for line in parameter_lines(view) if "." in line.name}
    assert name in owners
    assert view.connections[0].name not in owners - {name}
