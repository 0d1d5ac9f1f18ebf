"""Blocks become the elements that XMI would have made of them, and faults stand where they are."""

# ruff: noqa: E501 -- a text stands on one line

from pathlib import Path

import pytest

from jausml.language.metamodel.classes import bridge
from jausml.language.model import read_models
from jausml.language.model.comparison import compare

MINIMAL = Path(__file__).parents[2] / "models" / "minimal" / "minimal.xmi"
MAP = """\
  /** JAUS axes are x forward, y right, z down; ROS axes are x forward, y left, z up. */
  velocity {
    JAUS ReportVelocityState
    ROS geometry_msgs/TwistStamped
    JAUS->ROS (
      clock -> header.stamp
      "base_link" -> header.frame_id
      Velocity_X -> twist.linear.x { whenAbsent: dropMessage }
      YawRate -> twist.angular.z : negate { whenAbsent: dropMessage }
    )
  }
"""
SYSTEM = f"""\
/** Reports a velocity. */
component sensor {{
  address: 10.1.1
  type: vehicle
  provides: VelocityStateSensor
}}

/** Publishes the velocity of the sensor. */
bridge sensor_bridge {{
  address: 10.1.2
  uses: VelocityStateSensor
{MAP}
  /** Ten times a second. */
  connection velocity {{
    map: velocity
    exchange: periodicEvent
    peers: sensor
    rate: 10
    topic velocity {{}}
  }}
}}
"""


def conversion(model):
    return model.instances(bridge.Conversion, library=False)[0]


def assignments(texts, content, direction="JAUS->ROS"):
    model = texts.good(
        f"m {{ JAUS ReportVelocityState ROS nav_msgs/Odometry {direction} ( {content} )\n"
        "quantity top { value: 2 } table gear ( A <-> 1 ) }"
    )
    [found] = model.instances(bridge.AttributeMap, library=False)
    return list(found.toRos if direction == "JAUS->ROS" else found.toJaus)


def test_same_model_as_xmi(texts):
    ours = texts.good(SYSTEM, "minimal.ros2jaus")
    theirs = read_models([MINIMAL]).model
    # The system has no documentation where nobody writes it.
    theirs.root.documentation = None
    assert compare(ours.root, theirs.root, ours.metamodels) == []


def test_elements_and_values_have_their_places(texts):
    model = texts.good(SYSTEM)
    owner = model.instances(bridge.Bridge)[0]
    assert str(model.location(owner)).endswith(":9:1")
    assert str(model.location(owner, "address")).endswith(":10:12")
    assert str(model.location(owner, "uses")).endswith(":11:9")
    assert str(model.location(owner, "name")).endswith(":9:8")
    assert str(model.location(owner.maps[0])).endswith(":13:3")
    last = owner.maps[0].toRos[3]
    assert str(model.location(last, "target")).endswith(":20:18")
    assert str(model.location(last.conversions[0])).endswith(":20:36")


def test_implicit_roots_stand_where_their_first_item_stands(texts):
    text = f"{MAP}\ncomponent c {{ address: 1.1.1 }}\nmap_library other {{}}"
    model = texts.good(text, "demo-Two.ros2jaus")
    kinds = [(root.eClass.name, root.name) for root in model.roots if not model.is_library(root)]
    assert kinds == [("MapLibrary", "demo_two"), ("System", "demo_two"), ("MapLibrary", "other")]


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ('service A { urn: "u" }', "ServiceSet"),
        ("message_type A { }", "InterfacePackage"),
        ("node a { }", "System"),
        ("host a { }", "System"),
        ("system a { }", "System"),
        ("root: new component a { address: 1.1.1 }", "Component"),
    ],
)
def test_roots(texts, text, kind):
    assert texts.good(text).root.eClass.name == kind


def test_keyword_goes_to_the_feature_of_its_very_class(texts):
    model = texts.good("system s { component a { address: 1.1.1 } }")
    assert [component.name for component in model.root.components] == ["a"]
    system = texts.one("system s { bridge b { address: 1.1.2 } }").model.root
    assert [bridge_element.name for bridge_element in system.bridges] == ["b"]
    assert not system.components


def test_several_sources_and_targets(texts):
    [one] = assignments(texts, 'a, b.c -> d, e[1].f : expression("a"), scale(-2.5)')
    assert (one.source, one.target) == ("a, b.c", "d, e[1].f")
    names = [conversion_step.kind.name for conversion_step in one.conversions]
    assert names == ["expression", "scale"]
    assert one.conversions[0].expression == "a"
    assert list(one.conversions[1].arguments) == [-2.5]


def test_arguments_by_kind(texts):
    [one] = assignments(
        texts,
        'a -> b : value_to_percent(top), look_up(gear), user(mine), with_units("m"), linear(1, 2)',
    )
    percent, look_up, user, units, linear = one.conversions
    assert percent.quantity.name == "top"
    assert look_up.table.name == "gear"
    assert user.method == "mine"
    assert units.units == "m"
    assert list(linear.arguments) == [1.0, 2.0]


def test_lists_nest(texts):
    [outer] = assignments(
        texts,
        "poses -> L { pose.x -> X  inner -> M { . -> . } keys: names names: a, b }",
        "ROS->JAUS",
    )
    assert [assignment.target for assignment in outer.assignments] == ["X", "M"]
    assert outer.assignments[1].assignments[0].source == "."
    assert (outer.keys, list(outer.names)) == ("names", ["a", "b"])


def test_documentation_of_items(texts):
    [one, two] = assignments(texts, "\n/** Why. */ a -> b\n/** Not yet. */ ignore c")
    assert (one.documentation, two.documentation) == ("Why.", "Not yet.")


FAULTS = {
    "keyword": "⟦JML702⟧brigde front { }",
    "map_like": "⟦JML702⟧whatever { }",
    "owner": "host h { ⟦JML702⟧component c { } }",
    "no_name": "node n { publisher p { topic: a type: std_msgs/Empty qos: new qos_profile ⟦JML702⟧x { } } }",
    "top_feature": "⟦JML702⟧rate: 25",
    "top_end": "component c { address: 1.1.1 ⟦JML702⟧JAUS ReportVelocityState }",
    "colon": "node n { publisher p { topic: a type: std_msgs/Empty ⟦JML702⟧qos { depth: 5 } } }",
    "feature": "host h { ⟦JML103⟧prot: 5 }",
    "twice": "host h { port: 5 port: ⟦JML111⟧6 }",
    "value": "host h { port: ⟦JML106⟧much }",
    "literal": "host h { transport: ⟦JML105⟧upd }",
    "pattern": "component c { address: ⟦JML107⟧9 }",
    "missing": "⟦JML108⟧component c { }",
    "block_for_value": "host h { port: ⟦JML705⟧{ } }",
    "block_for_name": "component c { address: 1.1.1 provides: ⟦JML705⟧{ } }",
    "name_for_block": "node n { publisher p { topic: a type: std_msgs/Empty qos: ⟦JML705⟧fast } }",
    "number_for_name": "component c { address: 1.1.1 provides: ⟦JML705⟧5 }",
    "wrong_class": "service_set s { service A { urn: u ⟦JML702⟧message_def Q { code: 0x0D01 } } }",
    "abstract": "service_set s { types: ⟦JML705⟧{ } }",
    "lost_comment": "host h { /** Usual. */ ⟦JML703⟧port: 3794 }",
    "import": "import ⟦JML704⟧mappings.no_such_thing",
    "absent_import": 'import ⟦JML203⟧"none.xmi"\nbridge b { address: 1.1.1 uses: Nowhere\nconnection c { map: m topic t {} } }',
    "conversion": "m { JAUS ReportVelocityState ROS std_msgs/Float64 JAUS->ROS ( Velocity_X -> data : ⟦JML105⟧negat ) }",
    "constant_converted": "m { JAUS ReportVelocityState ROS std_msgs/Float64 JAUS->ROS ( 1 -> data : ⟦JML705⟧negate ) }",
    "constant_among": "m { JAUS ReportVelocityState ROS std_msgs/Float64 JAUS->ROS ( ⟦JML108⟧X, ⟦JML705⟧true -> data ) }",
    "text_argument": 'm { JAUS ReportVelocityState ROS std_msgs/Float64 JAUS->ROS ( X -> data : scale(⟦JML705⟧"2") ) }',
    "syntax": "host h { port ⟦JML701⟧5 }\nhost k { port: 6 ⟦JML103⟧prot: 6 }\n",
    "unnamed_struct": "⟦JML706⟧struct [ uint8 a ]",
    "unused_struct": "struct [ uint8 a ] ⟦JML706⟧pose",
    "struct_twice": "uint8 [2] ⟦JML706⟧a ⟦JML707⟧uint8 [3] a",
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_fault(name, texts):
    for finding in texts.check(FAULTS[name]).diagnostics:
        assert "\n" not in finding.message
        assert "<" not in finding.message, "XML in the words of a text"


def test_what_could_not_be_read_is_not_missed(texts):
    """A syntax error in an element hides what the element may have: it is the one finding."""
    texts.check("bridge b { address: 100.1.2  connection a { topic /odom ⟦JML701⟧= 5 } }")


def test_features_without_their_colon_are_named(texts):
    [finding] = texts.check(
        "import mappings.velocity_state_sensor bridge b { address: 100.1.2\n"
        " connection a { map: velocity_state ⟦JML702⟧direction rosToJaus topic odom } }"
    ).diagnostics
    assert finding.hint == "write 'direction: rosToJaus'"


def test_keywords_that_are_misspelt_are_named(texts):
    [finding] = texts.check("m { ⟦JML702⟧Jaus ReportGlobalPose  ROS std_msgs/Empty }").diagnostics
    assert finding.hint == "did you mean 'JAUS'?"
