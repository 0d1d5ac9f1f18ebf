"""How models read in ros2jaus text."""

import pytest
from for_each import for_each

from jausml.language.metamodel import load_metamodels
from jausml.language.model import read_models
from jausml.language.model.values import convert
from jausml.language.model.xmi.printing import UnwritableError
from jausml.language.text.notation import NOTATIONS
from jausml.language.text.writing import spelling
from jausml.language.text.writing.unparsing import to_text

REAL = load_metamodels().classes["ros.Node"].features["frequency"].data_type
HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<xmi:XMI xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xmlns:bridge="http://www.jausml.org/bridge/1.0" xmlns:jaus="http://www.jausml.org/jaus/1.0"
    xmlns:ros="http://www.jausml.org/ros/1.0" xmlns:system="http://www.jausml.org/system/1.0">
"""
JAUS = "http://www.jausml.org/library/jaus"
ROS = "http://www.jausml.org/library/ros"


@pytest.fixture
def text_of(tmp_path):
    """Returns the text of a model in XMI, which may refer to other files."""

    def convert(body, name="robot", **others):
        for stem, other in {**others, name: body}.items():
            (tmp_path / f"{stem}.xmi").write_text(f"{HEAD}{other}\n</xmi:XMI>", encoding="utf-8")
        result = read_models([tmp_path / f"{name}.xmi"], project_root=tmp_path)
        document = result.model.documents[0]
        return to_text(document.roots, result.model, tmp_path / f"{name}.ros2jaus")

    return convert


MAP = f"""
  <maps name="speed" documentation="How fast.">
    <message href="{JAUS}/mobility.xmi#VelocityStateSensor.ReportVelocityState"/>
    <type href="{ROS}/nav_msgs.xmi#Odometry"/>
    <toRos xsi:type="bridge:FieldAssignment" target="header.stamp" source="TimeStamp">
      <conversions kind="timestamp_to_time"/>
    </toRos>
    <toRos xsi:type="bridge:ConstantAssignment" target="header.frame_id" value="odom"/>
    <toRos xsi:type="bridge:ConstantAssignment" target="child_frame_id" value="1.0"/>
    <toRos xsi:type="bridge:ClockAssignment" target="header.stamp"/>
    <toRos xsi:type="bridge:FieldAssignment" target="twist.twist.linear.x" source="Velocity_X"
        whenAbsent="dropMessage" precision="0.5">
      <conversions/>
      <conversions kind="scale"><arguments>0.5</arguments></conversions>
      <conversions kind="look_up" table="//@maps.0/@tables.0"/>
    </toRos>
    <toRos xsi:type="bridge:FieldAssignment" target="x" source="Velocity_Y">
      <conversions kind="value_to_percent" quantity="//@maps.0/@quantities.0"/>
      <conversions kind="expression" expression="2 * value"/>
    </toRos>
    <toRos xsi:type="bridge:FieldAssignment" target="pose" source="Roll, Pitch, Yaw">
      <conversions kind="with_units" units="m/s"/>
      <conversions kind="user" method="smooth"/>
    </toRos>
    <toRos xsi:type="bridge:Ignore" target="twist.angular" documentation="Nobody asks."/>
    <toJaus xsi:type="bridge:ListAssignment" target="List" source="poses" keys="name">
      <names>a</names>
      <names>b</names>
      <assignments xsi:type="bridge:FieldAssignment" target="X" source="."/>
      <assignments xsi:type="bridge:MessageAssignment" target="Y" source="." map="//@maps.0"/>
    </toJaus>
    <tables name="gear">
      <entries jaus="PARK" ros="0"/>
      <entries jaus="IN DRIVE" ros="true"/>
    </tables>
    <quantities name="top" value="8.94" units="m/s"/>
    <joins name="imu" freshness="0.5"><type href="{ROS}/sensor_msgs.xmi#Imu"/></joins>
    <reportJoins name="heading" whenStale="dropMessage">
      <message href="http://www.jausml.org/library/jaus/mobility.xmi#GlobalPoseSensor.ReportGlobalPose"/>
    </reportJoins>
    <vectors name="still" direction="rosToJaus">
      <given path="twist.x" value="0"/>
      <expected path="Velocity_X" value="absent" tolerance="0.001"/>
    </vectors>
  </maps>"""


def test_maps_have_their_own_notation(text_of):
    text = text_of(
        f'<bridge:MapLibrary name="robot">{MAP}</bridge:MapLibrary>'.replace("//@", "/0/@")
    )
    assert (
        text
        == """\
/** How fast. */
speed {
    JAUS ReportVelocityState
    ROS nav_msgs/Odometry
    table gear ( PARK <-> 0  "IN DRIVE" <-> true )
    quantity top { value: 8.94  units: "m/s" }
    join imu { type: sensor_msgs/Imu  freshness: 0.5 }
    report_join heading { message: ReportGlobalPose  whenStale: dropMessage }
    JAUS->ROS (
        TimeStamp -> header.stamp : timestamp_to_time
        "odom" -> header.frame_id
        1.0 -> child_frame_id
        clock -> header.stamp
        Velocity_X -> twist.twist.linear.x : negate, scale(0.5), look_up(gear) {
            whenAbsent: dropMessage
            precision: 0.5
        }
        Velocity_Y -> x : value_to_percent(top), expression("2 * value")
        Roll, Pitch, Yaw -> pose : with_units("m/s"), user(smooth)
        /** Nobody asks. */
        ignore twist.angular
    )
    ROS->JAUS (
        poses -> List {
            keys: name
            names: a, b
            . -> X
            . -> Y { map: speed }
        }
    )
    vector still ROS->JAUS ( twist.x = 0 => Velocity_X = absent ~ 0.001 )
}
"""
    )


def test_what_arrows_cannot_say_is_said_by_blocks(text_of):
    text = text_of(
        f"""<bridge:MapLibrary name="robot" documentation="Maps.">
  <maps name="odd">
    <type href="{ROS}/std_msgs.xmi#Bool"/>
    <toRos xsi:type="bridge:FieldAssignment" target="a" source="x"/>
    <toRos xsi:type="bridge:FieldAssignment" target="b" source="true"/>
    <toRos xsi:type="bridge:FieldAssignment" target="c,d" source="y"/>
    <toRos xsi:type="bridge:FieldAssignment" target="e" source="z">
      <conversions kind="negate"><arguments>1.0</arguments></conversions>
      <conversions kind="scale" units="m"><arguments>2.0</arguments></conversions>
    </toRos>
  </maps>
  <maps/>
</bridge:MapLibrary>"""
    )
    assert (
        text
        == """\
/** Maps. */
map_library robot {
    odd {
        ROS std_msgs/Bool
        JAUS->ROS (
            x -> a
        )
        toRos: new field_assignment { target: b  source: true }
        toRos: new field_assignment { target: "c,d"  source: y }
        JAUS->ROS (
            z -> e {
                conversion { arguments: 1 }
                conversion { kind: scale  arguments: 2  units: "m" }
            }
        )
    }

    maps: {}
}
"""
    )


def test_references_are_as_short_as_they_can_be(text_of):
    services = "".join(
        f'<services name="{name}" urn="u:{name}"><inputs name="Set" code="0xD00{code}"/>'
        f'<inputs name="Only{name}" code="0xD01{code}"/></services>'
        for code, name in enumerate(["One", "Two"])
    )
    action = '<actions name="a" sends="/0/@services.{}/@inputs.{}"/>'
    machine = (
        '<machines name="m"><states name="s"><transitions message="/0/@services.1/@inputs.0">'
        f"{action.format(0, 0)}{action.format(0, 1)}</transitions></states></machines></services>"
    )
    text = text_of(
        f'<jaus:ServiceSet name="robot">{services[: -len("</services>")]}{machine}'
        "</jaus:ServiceSet>"
    )
    assert "message: Set\n" in text, "the innermost scope has one alone"
    assert "action a { sends: One.Set }" in text
    assert "action a { sends: OnlyOne }" in text


def test_parts_of_ros_services_are_named_by_what_they_are(text_of):
    text = text_of(
        """<bridge:MapLibrary name="maps"><maps name="m">
          <message href="http://www.jausml.org/library/jaus/core-1.1.xmi#Management.SetEmergency"/>
          <type href="http://www.jausml.org/library/ros/std_srvs.xmi#SetBool_Request"/>
        </maps></bridge:MapLibrary>"""
    )
    assert "ROS std_srvs/SetBool.request\n" in text


def test_other_files_are_imported_and_unnamed_elements_are_pointed_at(text_of):
    text = text_of(
        """<system:System name="robot">
  <placements>
    <host href="hosts.xmi#//@hosts.0"/>
    <components href="hosts.xmi#//@components.0"/>
    <components xsi:type="jaus:Component" href="hosts.xmi#//@components.1"/>
  </placements>
</system:System>""",
        hosts="""<system:System name="lab"><components name="arm" address="1.1.1"/>
<components address="1.1.2"/><hosts name="two words"/></system:System>""",
    )
    assert text.startswith('import "hosts.xmi"\n\nplacement {')
    assert "host: `two words`" in text
    assert 'components: arm, @"hosts.xmi#//@components.1"' in text


@pytest.mark.parametrize(
    ("often", "once", "head"), [("1.1", "1.0", ""), ("1.0", "1.1", "import `jaus.core-1.0`\n\n")]
)
def test_of_two_versions_the_older_one_is_imported(text_of, often, once, head):
    provides = "".join(
        f'<provides href="{JAUS}/core-{reference}"/>'
        for reference in (f"{often}.xmi#Management", f"{often}.xmi#Events", f"{once}.xmi#Events")
    )
    component = f'<components name="a" address="1.1.1">{provides}</components>'
    text = text_of(f'<system:System name="robot">{component}</system:System>')
    assert (
        text
        == f"""\
{head}component a {{
    address: 1.1.1
    provides: Management, Events, @"{JAUS}/core-{once}.xmi#Events"
}}
"""
    )


@pytest.mark.parametrize(
    ("name", "head"),
    [
        ("front", "host front"),
        ("two words", "host `two words`"),
        ("clock", "host `clock`"),
        ("1st", "host `1st`"),
        ("a`b", 'host { name: "a`b" }'),
        ("", 'host { name: "" }'),
        ("a&#9;b", 'host { name: "a\\tb" }'),
    ],
)
def test_names_are_quoted_where_they_must_be(text_of, name, head):
    hosts = f'<hosts name="{name}"/>'
    assert text_of(f'<system:System name="robot">{hosts}</system:System>') == f"{head}\n"


@pytest.mark.parametrize(
    ("documentation", "said"),
    [
        ("One.", "/** One. */\nhost a\n"),
        ("One.&#10;&#10;Two.", "/**\n * One.\n *\n * Two.\n */\nhost a\n"),
        ("One&#10;line.", 'host a { documentation: "One\\nline." }\n'),
        (" blank", 'host a { documentation: " blank" }\n'),
        ("", 'host a { documentation: "" }\n'),
        ("ends */ early", "/** ends *\\/ early */\nhost a\n"),
    ],
)
def test_documentation_is_exact(text_of, documentation, said):
    hosts = f'<hosts name="a" documentation="{documentation}"/>'
    assert text_of(f'<system:System name="robot">{hosts}</system:System>') == said


def test_a_system_is_written_when_its_file_does_not_imply_it(text_of):
    hosts = '<hosts name="a"/>'
    for head in ('name="other"', 'name="robot" rosDomain="5"', 'name="robot" documentation="x"'):
        assert "system " in text_of(f"<system:System {head}>{hosts}</system:System>")
    assert "system " in text_of('<system:System name="robot"/>')
    assert "system " not in text_of(f'<system:System name="robot">{hosts}</system:System>')


def test_any_element_may_be_a_root(text_of):
    text = text_of('<jaus:Component name="a" address="1.1.1"/><ros:QoSProfile depth="5"/>')
    assert text == (
        "root: new component a { address: 1.1.1 }\n\nroot: new qos_profile { depth: 5 }\n"
    )


def test_bridges_among_components_stay_there(text_of):
    text = text_of('<system:System name="x"><components xsi:type="bridge:Bridge"/></system:System>')
    assert "components: new bridge {}" in text


def test_values_that_defaults_hide(text_of):
    text = text_of(
        '<system:System name="x"><version xsi:nil="true"/><hosts port="3794" multicastTtl="0"/>'
        "</system:System>"
    )
    assert 'version: @""' in text
    assert "host { multicastTtl: 0 }" in text


@for_each(
    ("value", "number"),
    [
        (0.0, "0"),
        (-0.0, "-0"),
        (25.0, "25"),
        (1e-7, "1e-07"),
        (1e300, "1e+300"),
        (0.1, "0.1"),
        (float("nan"), "NaN"),
        (float("-inf"), "-Infinity"),
    ],
)
def test_numbers_are_short_and_exact(value, number):
    written = spelling.number(value).text
    assert written == number
    read, fault = convert(written, REAL)
    assert fault is None
    assert repr(read) == repr(value)


def test_models_that_text_cannot_hold_are_refused(text_of):
    states = "<states>" * 70 + "</states>" * 70
    with pytest.raises(UnwritableError, match="nested more than"):
        text_of(f"<jaus:StateMachine>{states}</jaus:StateMachine>")


def test_comments_stay_with_what_they_explain_when_text_is_laid_out(tmp_path, jausml_format):
    path = tmp_path / "robot.ros2jaus"
    path.write_text(
        "// Both.\nhost   a{port:1}// first\n/* Then */ host b { // inside\n}\n", encoding="utf-8"
    )
    before = read_models([path], notations=NOTATIONS).model
    jausml_format(path)
    assert path.read_text(encoding="utf-8") == (
        "// Both.\nhost a { port: 1 }  // first\n/* Then */\nhost b {\n    // inside\n}\n"
    )
    after = read_models([path], notations=NOTATIONS).model
    assert [host.port for host in after.root.hosts] == [host.port for host in before.root.hosts]


@pytest.fixture
def jausml_format():
    """Runs `jausml format` in this process."""
    from click.testing import CliRunner

    from jausml.cli import main

    def run(path):
        assert CliRunner().invoke(main, ["format", str(path)]).exit_code == 0

    return run
