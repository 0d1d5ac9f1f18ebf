"""A system made from nothing by the palette and by drawing lines, in both notations."""

import pytest
from scope_support import EditedFile

from jausml.authoring.editing.commands import Create
from jausml.authoring.studio.views.connecting import connect
from jausml.authoring.studio.views.palette import palette
from jausml.authoring.studio.views.planning import plan
from jausml.authoring.studio.views.spots import Spot
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.validation.engine import check


class Editor(EditedFile):
    """A project in which one file is edited."""

    def __init__(self, root, file):
        super().__init__(root, file)
        self.project.do([Create(file, "system.System", {"name": ("robot",)})], "new system")

    def add(self, query, group, note=""):
        item = next(e for e in palette(self.scope, query, [group]) if note in e.note)
        self.project.do(item.commands, item.label_of_edit)

    def one(self, kind, name):
        found = self.scope.model.instances(kind, library=False)
        return next(element for element in found if name in element.name)

    def draw(self, source, target):
        best = connect(self.scope, source, target).options[0]
        assert best.is_best
        self.take(best)


@pytest.mark.parametrize("file", ["robot.xmi", "robot.ros2jaus"])
def test_a_system_is_made_from_nothing_without_a_finding(file, tmp_path):
    editor = Editor(tmp_path, file)
    editor.add("LocalPoseSensor", "components")
    editor.add("geometry_msgs/PoseStamped", "ros types", "subscription")
    node = editor.one(ros.Node, "pose_stamped")
    sensor = editor.one(jaus.Component, "local_pose")
    editor.draw(Spot(sensor), Spot(node, node.subscriptions[0]))
    editor.add("VelocityStateDriver", "components")
    editor.add("geometry_msgs/Twist", "ros types", "publisher")
    node = editor.one(ros.Node, "twist")
    driver = editor.one(jaus.Component, "velocity")
    editor.draw(Spot(node, node.publishers[0]), Spot(driver))
    report = check(editor.project.model(file))
    assert report.diagnostics == ()
    [made] = report.model.instances(bridge.Bridge)
    names = [bridge_connection.map.name for bridge_connection in made.bridgeConnections]
    assert names == ["local_pose_stamped", "velocity_command"]
    assert [bridge_connection.direction.name for bridge_connection in made.bridgeConnections] == [
        "jausToRos",
        "rosToJaus",
    ]
    planned = plan(report, tmp_path / "ws")
    assert not planned.problems
    assert {planned_file.action for planned_file in planned.files} == {"create"}
    while editor.project.undo() is not None:
        pass
    assert not (tmp_path / file).exists()
