"""No name of a model hides what the module of a bridge imports."""

import dataclasses

import needs
import pytest

from tests.generators.assignment_support import generated

needs.ask("rclpy")


NAMES = (
    "Absolute", "Negate", "Scale", "Conversions", "Arithmetic", "Target", "Source", "Self", "Math",
    "By_Name", "Set_Time", "Set_Quaternion", "Float",
)  # fmt: skip
FIELDS = "\n".join(
    f"          fixed_field {name} {{ type: float64 optional: true }}" for name in NAMES
)


def ways(name: str) -> str:
    """Assignments that give the field a local name, and then call functions of all kinds."""
    return f"""
    {name}, Other -> angular.x : expression("sqrt(abs({name} + Other))")
      {{ whenAbsent: useDefault defaultValue: "0" }}
    {name}, Other -> angular.y : expression("sqrt(abs({name})) * {name} - Other ^ 2")
      {{ whenAbsent: useDefault defaultValue: "0" }}
    {name} -> linear.x : negate {{ whenAbsent: useDefault defaultValue: "0" }}
    Other -> linear.y : negate, scale(2), clamp(-9, 9), square_root {{ whenAbsent: lastValue }}
    {name} -> linear.z : square
"""


MODEL = f"""
service_set hostile {{
  service Hostile {{
    urn: "urn:example:Hostile"
    inputs: new message_def QueryHostile {{
      code: "0x2201"
      body: new record QueryRec {{ fixed_field PresenceVector {{ type: uint16 }} }}
    }}
    outputs: new message_def ReportHostile {{
      code: "0xD201"
      body: new record HostileRec {{
        presenceVector: uint16
{FIELDS}
        fixed_field Other {{ type: float64 optional: true }}
      }}
    }}
  }}
}}
""" + "".join(
    f"map_{name} {{\n  JAUS ReportHostile\n  ROS geometry_msgs/Twist\n"
    f"  JAUS->ROS ({ways(name)})\n}}\n"
    for name in NAMES
)
BRIDGE = "\nbridge hostile_names {\n  address: 1.1.2\n" + "".join(
    f"  connection {name} {{ map: map_{name} topic t_{name} {{}} }}\n" for name in NAMES
)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    return generated(MODEL + BRIDGE + "}\n", tmp_path_factory.mktemp("hostile"), "hostile_names")


@pytest.mark.slow
def test_text_is_clean(made):
    made.check_text()


@pytest.mark.parametrize("name", NAMES)
def test_values_go_through_all_functions(made, name):
    view, position = made.messages.ReportHostile, NAMES.index(name)
    attribute = dataclasses.fields(view)[position].name
    source = view(**{attribute: 4.0, "other": -8.0})
    methods = [
        method_name
        for method_name in type(made.bridge).__mro__[1].__dict__
        if "translate_" in method_name
    ]
    target = getattr(made.bridge, methods[position])(source)
    assert target.TYPE == "geometry_msgs/msg/Twist"
    assert target.angular.y == 2.0 * 4.0 - 64.0
    assert target.linear.x == -4.0
    assert target.linear.y == 3.0
    assert target.linear.z == 16.0
