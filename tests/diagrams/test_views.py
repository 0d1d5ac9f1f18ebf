"""Views: what the graphs of models hold, whatever the model."""

import os
import tempfile
from pathlib import Path

import mutants
import pytest
from click.testing import CliRunner
from diagram_support import CAR, MODELS, graphs, look_at, read
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from sweeps import sweep

from jausml.cli import main
from jausml.language.model.library import LIBRARY_URI
from jausml.language.model.refs import ref_of
from jausml.views.diagrams.graph import severity
from jausml.views.diagrams.views import UnknownViewError, graph_of, view_names
from jausml.views.diagrams.writers.text import render_dot, render_mermaid

EXAMPLES = int(os.environ.get("JAUSML_EXAMPLES", "12"))
SHIPPED = sorted(
    path
    for path in MODELS.rglob("*")
    if path.suffix in (".xmi", ".ros2jaus") and "library" not in path.parts
)
NEW = (
    '<system:System xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI" '
    'xmlns:system="http://www.jausml.org/system/1.0" name="new"/>'
)
WINCH = MODELS / "examples" / "winch" / "service.xmi"


def car(view):
    report = read(CAR)
    return graph_of(report.model, view, report.diagnostics)


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_every_view_of_what_is_shipped(path):
    found = list(graphs(read(path)))
    assert found
    for graph in found:
        look_at(graph)
        assert graph.nodes
        assert not severity(graph.findings)


def test_components_of_files_of_one_name_are_boxes_of_their_own(tmp_path):
    for folder, name, address in (("a", "first", "100.1.1"), ("b", "second", "100.2.1")):
        (tmp_path / folder).mkdir()
        text = f"component {name} {{ address: {address} provides: VelocityStateSensor }}\n"
        (tmp_path / folder / "robot.ros2jaus").write_text(text, encoding="utf-8")
    main = tmp_path / "systems" / "main.ros2jaus"
    main.parent.mkdir()
    (tmp_path / ".git").mkdir()  # the root of what files may refer to
    main.write_text(
        """import "../a/robot.ros2jaus"
        import "../b/robot.ros2jaus"
        bridge front { address: 100.1.2 uses: VelocityStateSensor controls: first, second }""",
        encoding="utf-8",
    )
    graph = graph_of(read(main).model, "system")
    assert {node.title for node in graph.nodes} == {"front", "first", "second"}
    assert (
        len({edge.source.node for edge in graph.edges} | {e.target.node for e in graph.edges}) == 3
    )
    # Layouts are kept by key, for all who have the files.
    assert not any(str(tmp_path) in node.id + node.key for node in graph.nodes)


def test_maps_of_one_name_in_two_bridges_have_views_of_their_own(tmp_path):
    bridges = (
        f"""bridge {name} {{ address: 100.1.{number} speed {{
            JAUS ReportVelocityState
            ROS geometry_msgs/Twist
            JAUS->ROS ( Velocity_{axis} -> linear.x )
        }} }}"""
        for number, (name, axis) in enumerate([("front", "X"), ("back", "Y")], start=1)
    )
    path = tmp_path / "robot.ros2jaus"
    imports = "import jaus.mobility\nimport ros.geometry_msgs\n"
    path.write_text(imports + "\n".join(bridges), encoding="utf-8")
    model = read(path).model
    views = [name for name in view_names(model, library=False) if name.startswith("map:")]
    assert views == ["map:speed", "map:back.speed"]
    edges = [graph_of(model, view).edges[0].source.port for view in views]
    assert edges == ["Velocity_X", "Velocity_Y"]


def test_every_view_of_the_library_that_is_used():
    for graph in graphs(read(CAR), library=True):
        look_at(graph)


@settings(max_examples=EXAMPLES, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_whatever_the_model_edges_end_at_ports(data):
    def choose(things):
        return data.draw(st.sampled_from(things))

    text = mutants.mutant(choose, mutants.seed_texts())
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "model.xmi"
        path.write_text(text, encoding="utf-8")
        for graph in graphs(read(path)):
            look_at(graph)
            render_mermaid(graph)
            render_dot(graph)


def test_the_system_has_what_the_model_says():
    graph = car("system")
    kinds = {node.title: node.kind for node in graph.nodes}
    assert kinds["vehicle"] == "component"
    assert kinds["bridge"] == "bridge"
    assert kinds["logger"] == "node"
    assert [group.title for group in graph.groups] == ["host onboard (judp)"]
    bridge = next(node for node in graph.nodes if node.title == "bridge")
    row = next(port for port in bridge.ports if port.label == "odometry")
    assert row.note == "ReportVelocityState → Odometry"
    (edge,) = (e for e in graph.edges if e.target.port == row.id and e.kind == "message")
    assert edge.source.node == "vehicle"
    assert edge.labels == ("event, 25 Hz",)
    # From ROS to JAUS the arrow points the other way.
    (command,) = (
        e for e in graph.edges if e.title == "SetWrenchEffort" and "Connections.4" in e.source.port
    )
    assert command.target.node == "vehicle"


def test_a_connection_tells_its_quality_its_limits_and_what_it_does_when_its_source_is_lost(
    tmp_path,
):
    bridge = next(node for node in car("system").nodes if node.title == "bridge")
    told = {port.label: dict(port.details) for port in bridge.ports}
    lost = told["cruise_speed"]["when lost"]
    assert lost.startswith("after 2 s of silence: ")
    assert "twist.linear.x = 0.0" in lost
    assert told["odometry"]["QoS"] == "odometry: best effort, volatile, keep last 5"
    assert not {"when lost", "limits"} & set(told["odometry"])
    text = CAR.read_text(encoding="utf-8").replace("../library/", LIBRARY_URI)
    start = text.index("<bridgeConnections", text.index("<bridges"))
    changed = text[:start] + text[start:].replace(
        "<bridgeConnections", '<bridgeConnections rateCap="50" decimation="2" ageLimit="0.5"', 1
    )
    changed = changed.replace('depth="5"/>', 'depth="1" deadline="0.1"/>')
    path = tmp_path / "car.xmi"
    path.write_text(changed, encoding="utf-8")
    bridge = next(n for n in next(graphs(read(path))).nodes if n.title == "bridge")
    told = {port.label: dict(port.details) for port in bridge.ports}["odometry"]
    assert told["limits"] == (
        "at most 50 Hz are taken of one source, one of 2 passes, none older than 0.5 s"
    )
    assert told["QoS"] == "odometry: best effort, volatile, keep last 1, deadline 0.1 s"


def test_services_and_actions_are_connections_too():
    graph = next(graphs(read(MODELS / "examples" / "nav2" / "nav2.ros2jaus")))
    assert {port.mark for node in graph.nodes for port in node.ports} >= {"action"}
    assert any(edge.kind == "call" for edge in graph.edges)


def test_a_joined_topic_has_its_own_type_and_what_the_model_does_not_name_stands_outside(tmp_path):
    path = tmp_path / "boat.ros2jaus"
    command = ["new", "bridge", "b", "fix:sensor_msgs/NavSatFix", "imu:sensor_msgs/Imu", "--yes"]
    assert CliRunner().invoke(main, [*command, "-m", str(path)]).exit_code == 0
    graph = next(graphs(read(path)))
    others = {node.title: node for node in graph.nodes if node.kind == "others"}
    assert {other.group for other in others.values()} == {""}
    types = {port.label: port.note for port in others["other ROS nodes"].ports}
    assert types == {"/fix": "sensor_msgs/NavSatFix", "/imu": "sensor_msgs/Imu"}


def test_a_map_has_a_line_for_each_assignment():
    graph = car("map:velocity_state")
    labels = [edge.labels for edge in graph.edges]
    assert labels == [("timestamp_to_time",), (), ("negate",), ("negate",)]
    jaus, ros = graph.nodes
    marks = {port.id: port.mark for port in ros.ports}
    assert marks["header.frame_id"] == "= odom"
    assert marks["pose"] == "unmapped"
    (stamp,) = (dict(port.details) for port in ros.ports if port.id == "header.stamp")
    assert stamp["markers"].startswith("unknown if stamp.sec == 0 and stamp.nanosec == 0 (")
    rows = {port.id: port.note for port in jaus.ports}
    assert (
        rows["Velocity_X"]
        == "scaled uint32 · meter per second · -327.68..327.67 · forwardRightDown"
    )
    ignored = [port.mark for node in car("map:cruise_speed").nodes for port in node.ports]
    assert "ignored" in ignored
    assert "= clock" in ignored


def test_a_service_has_its_messages_and_what_it_inherits():
    graph = car("service:PrimitiveDriver")
    titles = [node.title for node in graph.nodes if node.kind == "service"]
    assert titles == ["PrimitiveDriver", "Management", "AccessControl", "Events", "Transport"]
    assert sum(edge.kind == "inherits" for edge in graph.edges) == len(titles) - 1
    answers = [edge for edge in graph.edges if edge.kind == "answers"]
    assert answers
    assert any(port.mark == "command" for node in graph.nodes for port in node.ports)


def test_a_machine_has_states_in_states_and_transitions():
    report = read(WINCH)
    graph = graph_of(report.model, "machine:ReceiveFSM", report.diagnostics)
    assert graph.downwards
    titles = {node.title for node in graph.nodes}
    assert {"Idle", "Locked", "PayingOut", "PayingIn"} <= titles
    labels = [edge.labels for edge in graph.edges]
    assert ("SetWinchCommand", "[isControllingClient && paysOut]", "/ setSpeed") in labels
    assert [group.title for group in graph.groups][:2] == ["Receiving", "Ready"]


def test_of_a_broken_model_the_rest_is_drawn_with_what_is_wrong(tmp_path):
    text = CAR.read_text(encoding="utf-8").replace("../library/", "http://www.jausml.org/library/")
    broken = text.replace('source="YawRate"', 'source="YawRat"').replace('rate="10.0"', 'rate="x"')
    path = tmp_path / "broken.xmi"
    path.write_text(broken, encoding="utf-8")
    report = read(path)
    assert report.has_errors
    system, velocity, *_ = graphs(report)
    look_at(system)
    rows = [port for node in system.nodes for port in node.ports if port.label == "pose"]
    assert [severity(row.findings) for row in rows] == ["error"]
    look_at(velocity)
    unknown = [port for node in velocity.nodes for port in node.ports if port.mark == "unknown"]
    assert [port.label for port in unknown] == ["YawRat"]


@pytest.mark.parametrize(
    ("name", "text"),
    [("new.ros2jaus", ""), ("new.ros2jaus", "// soon\n"), ("new.xmi", NEW), ("new.xmi", "<")],
)
def test_where_nothing_is_yet_there_is_the_system(tmp_path, name, text):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    report = read(path)
    assert view_names(report.model, library=False) == ["system"]
    assert graph_of(report.model, "system", report.diagnostics).nodes == ()


@pytest.mark.parametrize(
    ("view", "hint"),
    [
        ("map:velocity_stat", "did you mean map:velocity_state?"),
        ("sytem", "did you mean system?"),
        ("machine:x", "there are: machine:AccessControl.ReceiveFSM"),
    ],
)
def test_an_unknown_view_names_the_nearest(view, hint):
    with pytest.raises(UnknownViewError, match="no view") as caught:
        car(view)
    assert hint in str(caught.value)


def test_ids_are_those_of_the_model():
    model = read(CAR).model
    graph = graph_of(model, "system")
    known = {model.fragment(element) for element in model.elements(library=False)}
    own = [node.id for node in graph.nodes if "!" not in node.id]
    assert own
    assert set(own) <= known


def parts(graph):
    yield from graph.nodes
    yield from graph.groups
    yield from graph.edges
    for node in graph.nodes:
        yield from node.ports


@pytest.mark.parametrize("path", sweep(SHIPPED, every=4), ids=lambda path: path.stem)
def test_parts_refer_to_what_they_show_and_have_keys_of_their_own(path):
    report = read(path)
    model = report.model
    known = {ref_of(element, model, MODELS): element for element in model.elements()}
    shown = set()
    for view in view_names(model, library=False):
        graph = graph_of(model, view, report.diagnostics, MODELS)
        assert {part.element for part in parts(graph)} <= {"", *known}
        for many in (graph.nodes, graph.groups, graph.edges, *(node.ports for node in graph.nodes)):
            keys = [part.key for part in many]
            assert all(keys)
            assert len(keys) == len(set(keys))
        shown |= {known[part.element].eClass.name for part in parts(graph) if part.element}
    if path == CAR:
        assert shown >= {"Component", "Bridge", "Node", "Publisher", "Host", "Connection"}
        assert shown >= {"FieldAssignment", "FixedField", "PrimitiveField", "MessageType"}


def test_a_connection_is_shown_by_its_row_and_its_edges():
    graph = car("system")
    bridge = next(node for node in graph.nodes if node.title == "bridge")
    row = next(port for port in bridge.ports if port.label == "odometry")
    assert row.element.startswith("catvehicle.xmi#")
    assert row.key.endswith(":bridge/odometry")
    edges = [e for e in graph.edges if row.id in (e.target.port, e.source.port)]
    assert len(edges) > 1
    assert {edge.element for edge in edges} == {row.element}
    peer = next(node for node in graph.nodes if node.title == "vehicle")
    assert {port.element for port in peer.ports} == {""}


def test_the_same_model_makes_the_same_graph():
    assert car("system") == car("system")
    assert view_names(read(CAR).model) == view_names(read(CAR).model)


def test_a_service_stands_before_what_it_inherits_and_shows_bodies_on_request():
    model = read(WINCH).model
    plain, told = (graph_of(model, f"{kind}:Winch") for kind in ("service", "bodies"))
    look_at(told)
    assert plain.groups[0].kind == told.groups[0].kind == "subject"
    assert {group.kind for group in told.groups[1:]} == {"service"}
    takes, sends = (node for node in told.nodes if node.group == told.groups[0].id and node.column)
    labels = [(port.label, port.depth) for port in takes.ports]
    assert labels[:3] == [("SetWinchCommand", 0), ("RopeSpeed", 1), ("LockBrake", 0)]
    assert ("Tension", 1) in [(port.label, port.depth) for port in sends.ports]
    assert not [port for node in plain.nodes for port in node.ports if port.depth]
    assert "bodies:Winch" not in view_names(model)
    with pytest.raises(UnknownViewError, match="no view 'service:Winsh'; did you mean service"):
        graph_of(model, "bodies:Winsh")
