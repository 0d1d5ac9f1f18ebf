"""Rows that tell which services a component provides and uses: they go, the services stay."""

import pytest
from scope_support import EditedFile

from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.studio.views.service_lines import cut
from jausml.language.metamodel.classes import jaus
from jausml.language.model.library import LIBRARY_URI
from jausml.views.diagrams.views import graph_of

FILE = "robot.ros2jaus"
TEXT = """\
import jaus.mobility

system robot {
    component arm {
        address: 100.1.1
        provides: VelocityStateSensor, AccelerationStateSensor
        uses: GlobalPoseSensor
    }
}
"""


def test_of_two_versions_of_a_service_the_one_of_the_row_goes(tmp_path):
    provided = (
        f'<provides href="{LIBRARY_URI}jaus/manipulator-{version}.xmi#PrimitiveManipulator"/>'
        for version in ("1.0", "2.0")
    )
    (tmp_path / "robot.xmi").write_text(
        '<system:System xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI" '
        'xmlns:system="http://www.jausml.org/system/1.0" name="robot">'
        f'<components name="arm" address="100.1.1">{"".join(provided)}</components></system:System>'
    )
    robot = EditedFile(tmp_path, "robot.xmi")
    scope = robot.scope
    (node,) = graph_of(scope.model, "system", root=robot.project.root).nodes
    old, new = (dict(port.details)["version"] for port in node.ports)
    assert (old, new) == ("1.0", "2.0")
    [option] = cut(scope, node.ports[0].id).options
    robot.take(option)
    (left,) = robot.scope.model.instances(jaus.Component, library=False)[0].provides
    assert left.version == "2.0"


@pytest.mark.parametrize(
    ("name", "way"), [("AccelerationStateSensor", "provides"), ("GlobalPoseSensor", "uses")]
)
def test_a_row_of_a_use_goes_and_its_service_stays(name, way, tmp_path):
    (tmp_path / FILE).write_text(TEXT, encoding="utf-8")
    robot = EditedFile(tmp_path / FILE, FILE)

    def rows():
        nodes = graph_of(robot.scope.model, "system", root=robot.project.root).nodes
        return {port.label: port.id for node in nodes for port in node.ports}

    row = rows()[name]
    [option] = cut(robot.scope, row).options
    assert option.label == f"arm no longer {way} {name}; the service stays"
    robot.take(option)
    others = {"VelocityStateSensor", "AccelerationStateSensor", "GlobalPoseSensor"} - {name}
    assert set(rows()) == others
    assert name not in robot.project.text(FILE).decode()
    services = {service.name for service in robot.scope.model.instances(jaus.Service)}
    assert name in services
    with pytest.raises(AnswerError):
        cut(robot.scope, row)
