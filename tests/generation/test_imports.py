"""Rendered Python gets the import statements for what it uses, and knows all of it."""

import pytest

from jausml.generation.python import Imports, Modules, Origin, UnknownNameError, offered

HEAD = "from __future__ import annotations\n"
NAMES = {
    **offered("nav_msgs.msg", "Odometry", "Path"),
    "TurtlesimPose": Origin("turtlesim.msg", "Pose"),
    **offered("jausml_runtime", "JausAddress", "set_time", "LIMIT"),
    **offered(".messages", "ReportPose", "ReportPose10", "ReportPose9"),
    "rclpy": Origin("rclpy"),
}


def imported(body: str) -> str:
    """Returns what stands between the first line and the body."""
    text = Modules().finished(f"{HEAD}\n\n{body}", Imports(NAMES))
    assert text.startswith(HEAD)
    assert text.endswith(f"\n\n{body}")
    return text[len(HEAD) : -len(body)].strip("\n")


def test_only_what_is_used_is_imported():
    assert imported("x = Odometry()\n") == "from nav_msgs.msg import Odometry"
    assert imported("x = 1\n") == ""


def test_sections_and_names_are_in_order():
    body = (
        "x = [math.pi, rclpy, set_time, LIMIT, JausAddress, TurtlesimPose, Odometry]\n"
        "y = [ReportPose10, ReportPose9]\n"
    )
    assert imported(body) == (
        "import math\n\n"
        "import rclpy\n"
        "from jausml_runtime import LIMIT, JausAddress, set_time\n"
        "from nav_msgs.msg import Odometry\n"
        "from turtlesim.msg import Pose as TurtlesimPose\n\n"
        "from .messages import ReportPose9, ReportPose10"
    )


def test_names_of_annotations_are_used_too():
    body = "def f(x: Odometry, y: list[ReportPose]) -> Path | None:\n    z: JausAddress = x\n"
    assert imported(body) == (
        "from jausml_runtime import JausAddress\n"
        "from nav_msgs.msg import Odometry, Path\n\n"
        "from .messages import ReportPose"
    )


def test_what_the_module_defines_is_not_imported():
    assert imported("class Odometry:\n    pass\n\n\nx = Odometry()\n") == ""


def test_own_package_comes_last():
    names = {**offered("arm.arm", "Arm"), **offered("zoo", "Bear")}
    text = Modules().finished(f"{HEAD}x = Arm(Bear)\n", Imports(names, own="arm"))
    assert text == f"{HEAD}\nfrom zoo import Bear\n\nfrom arm.arm import Arm\nx = Arm(Bear)\n"


def test_an_unknown_name_is_an_error():
    with pytest.raises(UnknownNameError, match="'Odometer'"):
        imported("x = Odometer()\n")


def test_builtins_and_names_of_modules_are_known():
    assert imported("x = len(__name__), ValueError\n") == ""
