"""A bridge does without the parts of ROS that make code of types."""

import sys

import needs
import pytest
from scripts import succeeded

pytestmark = pytest.mark.live

PROGRAM = """
import sys
from jausml.runtime.bridge.ros.node import RosNode
node = RosNode("spared", "/")
print(*sorted({"em", "lark", "hashlib", "rosidl_generator_py"} & set(sys.modules)))
from rosidl_generator_py.generate_py_impl import generate_py
print(callable(generate_py))
"""


def test_what_generates_code_of_types_is_not_loaded_with_a_node_and_can_be_later():
    needs.ask("rclpy")
    done = succeeded([sys.executable, "-c", PROGRAM], timeout=60)
    assert done.stdout.splitlines() == ["rosidl_generator_py", "True"]
