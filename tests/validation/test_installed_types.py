"""ROS types are compared with what is installed, where something is."""

import sys

import pytest

from jausml.language.interfaces import Installation
from jausml.language.metamodel.classes import ros
from jausml.language.model.library import library_root
from jausml.language.semantics.ros_types import installed_differences
from jausml.language.validation.engine import check_project

MODEL = """<?xml version="1.0" encoding="UTF-8"?>
<ros:Node xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xmlns:ros="http://www.jausml.org/ros/1.0" name="driver">
  <publishers name="cmd_vel" topic="cmd_vel">
    <type href="http://www.jausml.org/library/ros/geometry_msgs.xmi#TwistStamped"/>
  </publishers>
</ros:Node>
"""


@pytest.fixture
def install(tmp_path, monkeypatch):
    """Installs definitions of geometry_msgs, and nothing else, in a prefix."""
    folder = tmp_path / "prefix" / "share" / "geometry_msgs" / "msg"
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "prefix"))
    monkeypatch.setattr(sys, "prefix", str(tmp_path / "none"))

    def write(**definitions):
        folder.mkdir(parents=True)
        for name, text in definitions.items():
            (folder / f"{name}.msg").write_text(text, encoding="utf-8")

    return write


def findings(tmp_path):
    path = tmp_path / "node.xmi"
    path.write_text(MODEL, encoding="utf-8")
    return [
        (diagnostic.rule, diagnostic.location.line, diagnostic.message)
        for diagnostic in check_project([path]).diagnostics
    ]


TWIST_STAMPED = "std_msgs/Header header\nTwist twist\n"
TWIST = "Vector3 linear\nVector3 angular\n"
VECTOR = "float64 x\nfloat64 y\nfloat64 z\n"


@pytest.mark.usefixtures("install")
def test_nothing_is_installed(tmp_path):
    assert findings(tmp_path) == []


def test_the_same_is_installed(install, tmp_path):
    install(TwistStamped=TWIST_STAMPED, Twist=TWIST, Vector3=VECTOR)
    assert findings(tmp_path) == []


@pytest.mark.parametrize(
    ("definitions", "said"),
    [
        ({"Twist": TWIST.replace("angular", "rates")}, "field 'angular' is named 'rates' there"),
        ({"Twist": "float64 a\n" + TWIST}, "field 'a' (float64) is missing here"),
        ({"Twist": "Vector3 angular\nVector3 linear\n"}, "its fields stand in another order there"),
        ({"Vector3": VECTOR.replace("64 x", "32 x")}, "field 'x' is float64 here, float32 there"),
        ({"Vector3": VECTOR.replace("float64 z\n", "")}, "there is no field 'z' there"),
        ({"TwistStamped": TWIST_STAMPED.replace("Twist ", "Twist[] ")}, "Twist[] there"),
    ],
)
def test_a_difference_stands_at_the_use(install, tmp_path, definitions, said):
    install(**{"TwistStamped": TWIST_STAMPED, "Twist": TWIST, "Vector3": VECTOR, **definitions})
    ((rule, line, message),) = findings(tmp_path)
    assert (rule, line) == ("JML409", 6)
    assert said in message


def test_a_definition_that_nobody_understands_says_nothing(install, tmp_path):
    install(TwistStamped="what?", Twist=TWIST, Vector3=VECTOR)
    assert findings(tmp_path) == []


@pytest.mark.parametrize("name", ["../geometry_msgs", "/etc", "geometry_msgs/../x", "a\0b", ""])
def test_no_name_of_a_model_leads_out_of_the_share_folders(install, name):
    install(Twist=TWIST)
    assert Installation().folder("geometry_msgs") is not None
    assert Installation().folder(name) is None


@pytest.mark.needs("interfaces")
def test_the_shipped_library_is_what_is_installed():
    installation = Installation()
    model = check_project(sorted((library_root() / "ros").glob("*.xmi"))).model
    kinds = (ros.MessageType, ros.ServiceType)
    types = [named_element for kind in kinds for named_element in model.instances(kind)]
    tops = [element for element in types if isinstance(element.eContainer(), ros.InterfacePackage)]
    assert len(tops) > 100
    differences = [
        difference for top in tops for difference in installed_differences(top, installation)
    ]
    assert [difference.message for difference in differences] == []
