"""Names mean elements: of the document from the inside out, of imports, of the library."""

# ruff: noqa: E501 -- a text stands on one line

from collections import defaultdict

import pytest

from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.model.library import library_root
from jausml.language.text.reading.imports import library_maps

LIBRARY = "http://www.jausml.org/library/jaus/"


def provided(model):
    return [
        provide.name
        for c in model.instances(jaus.Component, library=False)
        for provide in c.provides
    ]


def test_library_is_known_without_an_import(texts):
    model = texts.good(
        "component a { address: 1.1.1 provides: VelocityStateSensor, mobility.LocalPoseSensor }"
    )
    assert provided(model) == ["VelocityStateSensor", "LocalPoseSensor"]
    names = {document.path.name for document in model.documents if document.is_library}
    assert "mobility.xmi" in names
    assert "environment-sensing.xmi" not in names, "only what a name needs is read"


@pytest.mark.parametrize("name", ["geometry_msgs/TwistStamped", "TwistStamped",
                                  "geometry_msgs/msg/TwistStamped", "geometry_msgs.TwistStamped"])  # fmt: skip
def test_ros_types(texts, name):
    model = texts.good(f"node n {{ publisher p {{ topic: a type: {name} }} }}")
    assert model.instances(ros.Publisher)[0].type.name == "TwistStamped"


@pytest.mark.parametrize("name", ["std_srvs/SetBool.request", "std_srvs/srv/SetBool.request",
                                  "SetBool.request", "SetBool_Request"])  # fmt: skip
def test_parts_of_ros_services_go_by_what_they_are(texts, name):
    imports = "" if "." in name else "import ros.std_srvs\n"
    model = texts.good(f"{imports}m {{ JAUS SetWrenchEffort ROS {name} }}")
    [found] = model.instances(bridge.AttributeMap)
    assert found.type.eContainer().request is found.type
    assert found.type.name == "SetBool_Request"


def test_parts_of_own_ros_actions_go_by_what_they_are(texts):
    model = texts.good(
        "action_type Go { goal: { name: Go_Goal } result: { name: Go_Result }"
        " feedback: { name: Go_Feedback } }\nm { JAUS SetWrenchEffort ROS Go.feedback }"
    )
    [found] = model.instances(bridge.AttributeMap)
    assert found.type.eContainer().feedback is found.type


def test_what_has_no_such_part_is_unknown(texts):
    findings = texts.one("m { JAUS SetWrenchEffort ROS std_srvs/SetBool.goal }").diagnostics
    assert [finding.rule for finding in findings] == ["JML215"]


def test_own_names_go_before_the_library(texts):
    model = texts.good(
        'service Events { urn: "u" inherits: Liveness_ }\nservice Liveness_ { urn: "v" }\n'
        "component a { address: 1.1.1 provides: Events }"
    )
    [component] = model.instances(jaus.Component)
    assert component.provides[0].urn == "u"
    assert component.provides[0].inherits.urn == "v"


def test_a_topic_names_the_join_of_the_map_of_its_connection(texts):
    attribute_map = """\
{} {{
  JAUS ReportVelocityState
  ROS nav_msgs/Odometry
  join imu {{ type: sensor_msgs/Imu }}
  ROS->JAUS ( imu.angular_velocity.z -> YawRate : negate )
}}
"""
    texts.write("maps.ros2jaus", attribute_map.format("far"))
    connection = """\
  connection {0} {{ topic odom {{}} topic imu {{ join: imu }} direction: rosToJaus map: {0} }}
"""
    model = texts.good(
        'import "maps.ros2jaus"\n'
        + "".join(map(attribute_map.format, ("one", "two")))
        + "bridge b { address: 1.1.1  uses: VelocityStateSensor\n"
        + "".join(map(connection.format, ("one", "two", "far")))
        + "}"
    )
    [owner] = model.instances(bridge.Bridge)
    for bridge_connection in owner.bridgeConnections:
        assert bridge_connection.topics[1].join is bridge_connection.map.joins[0], (
            bridge_connection.name
        )


def test_a_source_names_the_report_join_of_the_map_of_its_connection(texts):
    model = texts.good(
        """\
odometry {
  JAUS ReportLocalPose
  ROS nav_msgs/Odometry
  report_join velocity { message: ReportVelocityState whenStale: dropMessage }
  JAUS->ROS ( X -> pose.pose.position.x  velocity.Velocity_X -> twist.twist.linear.x )
}
component vehicle { address: 1.1.2 provides: LocalPoseSensor, VelocityStateSensor }
bridge b { address: 1.1.1
  connection odometry { topic odom map: odometry peers: vehicle sources: { join: velocity rate: 20 } }
}
"""
    )
    [owner] = model.instances(bridge.Bridge)
    [connection] = owner.bridgeConnections
    assert connection.direction.name == "jausToRos"
    assert connection.sources[0].join is connection.map.reportJoins[0]


def test_an_element_never_means_itself(texts):
    model = texts.good('service VelocityStateSensor { urn: "u" inherits: VelocityStateSensor }')
    [own] = model.root.services
    assert own.inherits is not own
    assert model.is_library(own.inherits)


def test_innermost_scope_wins(texts):
    model = texts.good(
        """\
service_set one { service A { urn: "1" inputs: new message_def Query { code: 0xD001 }
  state_machine M { state S { initial: true transitions: { message: Query } } } } }
service_set two { service A { urn: "2" inputs: new message_def Query { code: 0xD002 }
  state_machine M { state S { initial: true transitions: { message: Query } } } } }
"""
    )
    found = [
        transition.message.code for transition in model.instances(jaus.Transition, library=False)
    ]
    assert found == ["0xD001", "0xD002"]


def test_imports_in_a_circle(texts):
    text = 'import "{}.ros2jaus"\ncomponent {} {{ address: 1.1.{} controls: {} }}'
    texts.write("b.ros2jaus", text.format("a", "two", 2, "one"))
    model = texts.good(text.format("b", "one", 1, "two"), "a.ros2jaus")
    assert [c.controls[0].name for c in model.instances(jaus.Component)] == ["two", "one"]


def test_of_two_versions_the_newest_is_meant(texts):
    text = "component a { address: 1.1.1 provides: Events, Discovery }"
    for imported, version in (("", "1.1"), ("import `jaus.core-1.0`\n", "1.0")):
        [component] = texts.good(f"{imported}{text}").instances(jaus.Component, library=False)
        assert [provide.version for provide in component.provides] == [version, version]


def test_messages_of_two_versions_are_those_of_the_newest(texts):
    model = texts.good(
        "component a { address: 1.1.1 }\n"
        "component b { address: 1.1.2\n"
        "    service_connection c { provider: a message: ReportStatus } }"
    )
    [connection] = model.instances(jaus.ServiceConnection)
    assert connection.message.eContainer().version == "1.1"


def test_import_decides_between_versions_that_do_not_understand_each_other(texts):
    text = "component a { address: 1.1.1 provides: PrimitivePanTilt }"
    [ambiguous] = texts.one(text).diagnostics
    assert ambiguous.rule == "JML216"
    assert "manipulator.PrimitivePanTilt (manipulator-1.0.xmi)" in ambiguous.message
    assert len(ambiguous.related) == 2
    assert "import `jaus.manipulator-2.0`" in ambiguous.hint
    for written in (f'"{LIBRARY}manipulator-2.0.xmi"', "`jaus.manipulator-2.0`"):
        assert provided(texts.good(f"import {written}\n{text}")) == ["PrimitivePanTilt"]


def test_of_two_imported_versions_one_is_dropped_or_said_where_it_stands(texts):
    """Each of the two cures of the hint helps."""
    first, second = ("import `jaus.manipulator-1.0`\n", "import `jaus.manipulator-2.0`\n")
    text = "component a {{ address: 1.1.1 provides: {} }}"
    [ambiguous] = texts.one(first + second + text.format("PrimitivePanTilt")).diagnostics
    assert ambiguous.rule == "JML216"
    assert ambiguous.hint.startswith(f"drop one of the imports, such as {second.strip()}, or say")
    other = ambiguous.hint.rpartition(": ")[2]
    assert provided(texts.good(first + text.format("PrimitivePanTilt"))) == ["PrimitivePanTilt"]
    assert provided(texts.good(first + second + text.format(other))) == ["PrimitivePanTilt"]


def test_import_of_library_maps(texts):
    model = texts.good(
        "import mappings.velocity_state_sensor\n"
        'bridge b { address: 1.1.1 connection c { map: @"http://www.jausml.org/library/mappings/'
        'velocity_state_sensor.ros2jaus#//@maps.0" topic t {} } }'
    )
    [connection] = model.instances(bridge.Connection)
    assert model.is_library(connection.map)


def test_href_into_the_own_document(texts):
    model = texts.good(
        'component a { address: 1.1.1 controls: @"#//@components.1" }\n'
        "component b { address: 1.1.2 }"
    )
    assert model.root.components[0].controls[0].name == "b"


FAULTS = {
    "unknown": ("component a { address: 1.1.1 provides: ⟦JML215⟧VelocityStatSensor }",
                "did you mean 'VelocityStateSensor'"),
    "case": ("component a { address: 1.1.1 provides: ⟦JML215⟧velocitystatesensor }",
             "did you mean 'VelocityStateSensor'"),
    "other_class": ("component a { address: 1.1.1 provides: ⟦JML215⟧a }", "is a jaus.Component"),
    "own": ("component sensor { address: 1.1.1 }\n"
            "component b { address: 1.1.2 controls: ⟦JML215⟧sensr }", "did you mean 'sensor'"),
    "qualifier": ("component a { address: 1.1.1 provides: ⟦JML215⟧ugv.LocalPoseSensor }",
                  "LocalPoseSensor"),
    "several": ("component a { address: 1.1.1 provides: ⟦JML215⟧Nope1, LocalPoseSensor, "
                "⟦JML215⟧Nope2 }", ""),
    "beside_syntax": ("host h { port ⟦JML701⟧= 5 }\n"
                      "component a { address: 1.1.1 provides: ⟦JML215⟧LocalPosSensor }",
                      "did you mean 'LocalPoseSensor'"),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_fault(name, texts):
    text, hint = FAULTS[name]
    found = [finding for finding in texts.check(text).diagnostics if finding.rule == "JML215"]
    assert all(hint in finding.hint for finding in found)


def test_names_of_an_import_that_is_lost_are_not_missed(texts):
    result = texts.one('import "none.xmi"\ncomponent a { address: 1.1.1 provides: Own }')
    assert [diagnostic.rule for diagnostic in result.diagnostics] == ["JML203"]


def test_nothing_is_declared_that_an_import_that_is_lost_may_have(texts):
    result = texts.one('import "none.xmi"\nm { JAUS Own ( uint8 a ) ROS Own ( uint8 a ) }')
    assert [diagnostic.rule for diagnostic in result.diagnostics] == ["JML203"]


def test_referring_twice_is_a_warning(texts):
    [finding] = texts.check(
        "component a { address: 1.1.1 provides: LocalPoseSensor, ⟦JML213⟧LocalPoseSensor }"
    ).diagnostics
    assert "'LocalPoseSensor'" in finding.message


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        (
            "bridge b { connection c { map: velocity_state } }",
            "the library has it: import mappings.velocity_state_sensor",
        ),
        (
            "m { ROS my_msgs/Frobnicate }",
            "list its members to declare it: my_msgs/Frobnicate ( float64 x ); "
            "jausml import ros reads packages",
        ),
        (
            "m { JAUS Frobnicate }",
            "list its members to declare it: Frobnicate ( uint16 x ); "
            "jausml import jsidl reads service sets",
        ),
    ],
)
def test_unknown_name_tells_what_makes_it_known(texts, text, hint):
    findings = [
        diagnostic for diagnostic in texts.one(text).diagnostics if diagnostic.rule == "JML215"
    ]
    assert [finding.hint for finding in findings] == [hint]


def test_every_map_of_the_library_is_found_by_its_name(texts):
    of_modules = defaultdict(list)
    for library in library_maps():
        of_modules[library.module].append(library)
    for module, maps in of_modules.items():
        lines = [f"connection c{i} {{ map: {library.name} }}" for i, library in enumerate(maps)]
        text = f"import {module}\nbridge b {{ {' '.join(lines)} }}"
        connections = list(texts.one(text).model.instances(bridge.Connection))
        for library, connection in zip(maps, connections, strict=True):
            used = connection.map
            assert (used.name, used.message.name) == (library.name, library.message)
            owner, name = used.type.eContainer(), used.type.name
            if not isinstance(owner, ros.InterfacePackage):  # a half of a service or action
                owner, name = owner.eContainer(), owner.name
            assert library.type == f"{owner.name}/{name}"


def test_index_of_the_library_has_all_its_maps(texts):
    folder = library_root() / "mappings"
    modules = {library_map.module for library_map in library_maps()}
    assert modules == {f"mappings.{path.stem}" for path in folder.glob("*.ros2jaus")}
    imports = "".join(f"import {module}\n" for module in sorted(modules))
    model = texts.one(imports).model
    known = [attribute_map.name for attribute_map in model.instances(bridge.AttributeMap)]
    assert sorted(known) == sorted(library_map.name for library_map in library_maps())
