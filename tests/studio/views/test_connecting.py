"""Connecting ends of the system view: what is offered, and why not."""

import pytest
from scope_support import CAR, MODELS, scope_of

from jausml.authoring.editing.commands import Add, Set
from jausml.authoring.editing.project import Project
from jausml.authoring.proposals.elements import AnswerError, Scope
from jausml.authoring.studio.views.connecting import connect, ends
from jausml.authoring.studio.views.spots import Spot, end_of, spot
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.model import LIBRARY_URI, Severity
from jausml.language.validation.engine import check
from jausml.views.diagrams.views import graph_of


class Ends:
    """The ends of the car by names."""

    def __init__(self, scope):
        self.scope = scope
        self.owners = {
            owner.name: owner
            for kind in (jaus.Component, ros.Node)
            for owner in scope.model.instances(kind, library=False)
        }

    def __call__(self, text):
        owner, _, name = text.partition("/")
        element = self.owners[owner]
        kinds = bridge.Connection, ros.TopicEndpoint
        for child in self.scope.model.owned(element) if name else ():
            if isinstance(child, kinds) and child.name == name:
                return Spot(element, child)
        return Spot(element, message=name)

    def connect(self, source, target):
        return connect(self.scope, self(source), self(target))


@pytest.fixture
def car():
    return Ends(scope_of(CAR))


def test_a_component_reaches_a_node_through_the_bridge_by_a_ready_map(car):
    found = car.connect("vehicle", "logger/pose")
    assert found.options == () or "already" not in found.refusal
    best = car.connect("vehicle", "velocity_controller/dead_reckoning").options[0]
    assert best.is_best
    assert "ready map" in best.label
    assert "VelocityStateSensor" in best.why
    [connection] = best.commands
    assert isinstance(connection, Add)
    assert connection.kind == "bridge.Connection"
    assert connection.values["exchange"] == ("periodicEvent",)
    assert "direction" not in connection.values
    [topic] = connection.children
    assert topic.values["name"] == ("dead_reckoning",)


def test_a_new_map_is_offered_where_none_is_ready(car):
    found = car.connect("vehicle/ReportLocalPose", "logger/speed_command")
    [option] = found.options
    assert "new map" in option.label
    new_map, connection = option.commands
    assert new_map.kind == "bridge.AttributeMap"
    assert connection.values["map"] == ("new:0",)


def test_from_a_node_to_a_component_messages_are_commands(car):
    options = car.connect("steering_controller/steering_command", "vehicle").options
    assert options == () or options[0].commands
    options = car.connect("steering_controller", "vehicle/SetWrenchEffort").options
    best = options[0].commands
    assert best[0].values["direction"] == ("rosToJaus",)
    assert best[0].values["peers"]
    assert best[-1].kind == "ros.Publisher"


def test_what_a_connection_carries_is_not_offered_again(car):
    found = car.connect("vehicle/ReportVelocityState", "logger/odometry")
    assert found.options == ()
    assert "already" in found.refusal


def test_a_component_asks_another(car):
    found = car.connect("vehicle", "operator_control_unit")
    names = [option.label for option in found.options]
    assert "ReportVelocityState" in names
    assert "ReportControl" not in names  # the runtime asks for it
    uses, connection = found.options[0].commands
    assert isinstance(uses, Set)
    assert connection.kind == "jaus.ServiceConnection"
    chosen = car.connect("vehicle/ReportLocalPose", "operator_control_unit")
    assert [option.label for option in chosen.options] == ["ReportLocalPose"]


def test_nodes_meet_on_topics(car):
    [option] = car.connect("steering_controller/dead_reckoning", "logger").options
    [add] = option.commands
    assert (add.kind, add.values["topic"]) == ("ros.Subscription", ("dead_reckoning",))
    [option] = car.connect("steering_controller/dead_reckoning", "logger/odometry").options
    assert option.commands[0].values == ("dead_reckoning",)
    refused = car.connect("steering_controller/steering_command", "logger/odometry")
    assert "one type alone" in refused.refusal
    refused = car.connect("steering_controller/steering_command", "logger/steering_command")
    assert "already" in refused.refusal
    refused = car.connect("logger/odometry", "steering_controller")
    assert "draw to it" in refused.refusal


def test_a_connection_of_a_bridge_gets_further_ends(car):
    [option] = car.connect("bridge/odometry", "velocity_controller").options
    assert option.commands[0].kind == "ros.Subscription"
    refused = car.connect("bridge/steering_command", "logger")
    assert "the other way" in refused.refusal
    refused = car.connect("bridge/steering_command", "operator_control_unit")
    assert "takes no SetWrenchEffort" in refused.refusal
    refused = car.connect("bridge/speed_command", "vehicle")
    assert "already" in refused.refusal
    refused = car.connect("vehicle", "vehicle")
    assert "another box" in refused.refusal


def test_ids_of_the_diagram_name_ends(car):
    scope = car.scope
    graph = graph_of(scope.model, "system")
    for node in graph.nodes:
        for port in node.ports if node.kind != "others" else ():
            found = spot(scope, node.id, port.id)
            assert found.owner is not None
            assert found.element is not None or found.message == port.label.rpartition("/")[2]
    with pytest.raises(AnswerError, match="not in the model"):
        spot(scope, "bridge!ros", "")


def test_where_two_bridges_fit_the_one_that_serves_the_component_is_best(tmp_path):
    text = """
system boat {
    bridge first { address: 100.1.2 }
    bridge second {
        address: 100.1.3
        connection speed { map: velocity_state  direction: jausToRos  peers: helm  topic odom }
    }
    component helm { address: 100.1.1  provides: VelocityStateSensor, VelocityStateDriver, Winch }
    node lidar
    node gauge { subscription load { topic: load  type: std_msgs/Float64 } }
}
service_set own {
    service Winch {
        urn: "urn:example:Winch"
        outputs: new message_def ReportLoad { code: 0xD102 }
    }
}
"""
    path = tmp_path / "boat.ros2jaus"
    path.write_text(f"import mappings.velocity_state_sensor\n{text}", encoding="utf-8")
    project = Project(path)
    boat = Ends(Scope(project.model("boat.ros2jaus").model, project.root))
    found = boat.connect("helm", "lidar").options
    assert "through second" in found[0].why
    # What is, before what was commanded.
    first = boat.connect("helm", "first").options
    assert first[0].label.startswith("ReportVelocityState by")
    # Where no map is ready, a new one goes to a topic of the node.
    [*_, last] = boat.connect("helm/ReportLoad", "gauge").options
    assert last.label == "ReportLoad by new map (std_msgs/Float64)"
    assert "has no topic for it" in boat.connect("helm/ReportLoad", "lidar").refusal
    [only] = boat.connect("helm/ReportLoad", "second").options
    assert only.label == "ReportLoad by new map (std_msgs/Float64)"
    kinds = [command.kind for command in only.commands if isinstance(command, Add)]
    assert kinds == ["bridge.AttributeMap", "bridge.Connection"]

    # A service of which nothing is carried has a row, from which one draws as from the box.
    rows = {
        port.label: port
        for node in graph_of(boat.scope.model, "system").nodes
        for port in node.ports
        if port.mark == "unconnected"
    }
    assert set(rows) == {"VelocityStateDriver", "Winch"}
    assert boat.scope.find(rows["Winch"].element).name == "Winch"
    helm = boat.scope.model.fragment(boat.owners["helm"])
    assert spot(boat.scope, helm, rows["Winch"].id) == Spot(boat.owners["helm"])


def test_all_ends_of_a_component_are_told(car):
    found = ends(car.scope, car("vehicle"))
    names = {(end.owner.name, getattr(end.element, "name", "")) for end, _ in found}
    assert ("velocity_controller", "dead_reckoning") in names
    assert ("operator_control_unit", "") in names
    assert all(why for _, why in found)


def test_to_a_bridge_as_a_whole_the_ready_maps_are_offered_that_it_lacks(car):
    found = car.connect("vehicle", "bridge").options
    ready = [option for option in found if "ready map" in option.label]
    assert ready == list(found[: len(ready)])
    assert ready[0].is_best
    names = [option.label for option in ready]
    assert any("ReportLocalPose by ready map" in name for name in names)
    # What it carries already by this map is not offered once more.
    carried = {
        car.scope.ref(bridge_connection.map)
        for bridge_connection in car.owners["bridge"].bridgeConnections
        if bridge_connection.direction.name == "jausToRos"
    }
    assert carried
    assert not carried & {option.commands[-1].values["map"][0] for option in ready}
    pose = next(option for option in ready if "ReportLocalPose" in option.label)
    assert "as a periodic event through bridge" in pose.why
    *_, connection = pose.commands
    assert connection.owner == car.scope.ref(car.owners["bridge"])
    assert connection.values["peers"] == (car.scope.ref(car.owners["vehicle"]),)
    # What a bridge asks for itself, as any component, comes last.
    assert found[-1].commands[-1].kind == "jaus.ServiceConnection"
    chosen = car.connect("vehicle/ReportLocalPose", "bridge").options
    assert {option.label.split()[0] for option in chosen} == {"ReportLocalPose"}


def test_from_a_bridge_components_are_commanded_by_ready_maps(car):
    options = car.connect("bridge", "vehicle").options
    commanded = [option for option in options if "ready map" in option.label]
    assert commanded
    assert all(option.commands[-1].values["direction"] == ("rosToJaus",) for option in commanded)
    assert ("bridge", "") in {(e.owner.name, e.message) for e, _ in ends(car.scope, car("vehicle"))}


@pytest.mark.parametrize("file", [CAR, "examples/catvehicle/catvehicle.ros2jaus"])
def test_what_is_drawn_is_done_and_breaks_nothing(file, tmp_path):
    name = file.rpartition("/")[2]
    text = (MODELS / file).read_text(encoding="utf-8")
    (tmp_path / name).write_text(text.replace('"../library/', f'"{LIBRARY_URI}'), encoding="utf-8")
    project = Project(tmp_path / name)
    before = errors_of(project, name)
    drawn = (
        ("vehicle", "velocity_controller/dead_reckoning"),
        ("vehicle", "operator_control_unit"),
        ("vehicle/ReportLocalPose", "bridge"),
        ("bridge", "vehicle"),
        ("steering_controller/dead_reckoning", "logger"),
        ("steering_controller/dead_reckoning", "logger/odometry"),
        ("bridge/odometry", "velocity_controller"),
        ("steering_controller", "vehicle/SetWrenchEffort"),
    )
    for source, target in drawn:
        ends_now = Ends(Scope(project.model(name).model, project.root))
        best = ends_now.connect(source, target).options[0]
        project.do(best.commands, best.label)
        assert errors_of(project, name) - before <= {"JML451"}, (source, target)
        project.undo()
    assert (tmp_path / name).read_text(encoding="utf-8").count("\n") == text.count("\n")


def errors_of(project, name):
    """Returns the rules that find an error or a warning."""
    report = check(project.model(name))
    return {finding.rule for finding in report.diagnostics if finding.severity is not Severity.INFO}


# -- ends of lines in the view of a map ------------------------------------------------------------


def test_ids_of_the_map_view_name_members():
    scope = scope_of(CAR)
    [used] = [
        attribute_map
        for attribute_map in scope.model.instances(bridge.AttributeMap)
        if attribute_map.name == "velocity_state"
        and scope.model.document_of(attribute_map).path.name in CAR
    ]
    identifier = scope.model.fragment(used)
    assert end_of(scope, used, f"{identifier}!jaus", "Velocity_X").is_jaus
    assert not end_of(scope, used, f"{identifier}!ros", "twist.twist").is_jaus
    with pytest.raises(AnswerError, match="no end"):
        end_of(scope, used, "bridge", "x")


def test_both_ends_mean_one_name_where_their_namespaces_differ(tmp_path):
    text = (MODELS / "examples/catvehicle/catvehicle.ros2jaus").read_text(encoding="utf-8")
    for owner, space in (("bridge bridge", "car"), ("node logger", "arm")):
        text = text.replace(f"    {owner} {{\n", f"    {owner} {{\n        namespace: {space}\n")
    reset = "        service_server reset { service: reset  type: std_srvs/Trigger }\n"
    untyped = "        service_server untyped { service: untyped }\n"
    nameless = "        publisher pose { type: geometry_msgs/PoseStamped }\n"
    text = text.replace("namespace: arm\n", f"namespace: arm\n{reset}{untyped}")
    text = text.replace("node steering_controller {\n", f"node steering_controller {{\n{nameless}")
    path = tmp_path / "car.ros2jaus"
    path.write_text(text, encoding="utf-8")
    project = Project(path)
    car = Ends(Scope(project.model(path.name).model, project.root))
    new = car.connect("vehicle/ReportStatus", "logger").options[0].commands[-1]
    assert new.values["topic"] == ("/car/report_status",)
    assert new.values["name"] == ("report_status",)
    new = car.connect("bridge/odometry", "logger").options[0].commands[-1]
    assert new.values["topic"] == ("/car/odometry",)
    logger = car.owners["logger"]
    ends_by_name = {end.name: Spot(logger, end) for end in logger.serviceServers}
    vehicle = car("vehicle")
    [call] = connect(car.scope, vehicle, ends_by_name["reset"]).options
    assert call.commands[0].values["service"] == ("/arm/reset",)
    assert "has no type" in connect(car.scope, vehicle, ends_by_name["untyped"]).refusal
    [joined] = car.connect("steering_controller/pose", "logger/pose").options
    assert joined.commands[0].values == ("/pose",)
