"""A bridge does without modules that ROS imports and it does not use."""

import sys

import needs
import pytest
from scripts import succeeded

pytestmark = pytest.mark.live

NODE = """
import inspect, sys
from jausml.runtime.bridge.ros.spared import spare_modules
spare_modules()
from jausml.runtime.bridge.ros.node import RosNode
from nav_msgs.msg import Odometry
node = RosNode("spared", "/")
inspect.getmodule(node)
print(*sorted({"em", "lark", "hashlib", "numpy._core", "yaml.nodes"} & set(sys.modules)))
"""


def lines_of(program):
    done = succeeded([sys.executable, "-c", program], timeout=60)
    return done.stdout.splitlines()


TOGETHER = """
import sys
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier
from jausml.runtime.bridge.ros.spared import spare_modules
spare_modules()
from nav_msgs.msg import Odometry
barrier = Barrier(8)
def made(_):
    barrier.wait()
    return Odometry().pose.covariance.sum()
with ThreadPoolExecutor(8) as pool:
    print(*pool.map(made, range(8)))
"""


def test_threads_that_ask_for_it_at_once_have_it():
    needs.ask("rclpy")
    assert lines_of(TOGETHER) == [" ".join(["0.0"] * 8)]


LATER = (
    "from rosidl_generator_py.generate_py_impl import generate_py",
    "assert callable(generate_py)",
    "from numpy import zeros",
    "import numpy.linalg",
    "assert numpy.linalg.det([[2.0]]) == 2.0",
    "assert (Odometry().pose.covariance == zeros(36)).all()",
    "import yaml",
    "assert yaml.safe_load('[1]') == [1]",
)


def test_a_node_does_without_what_it_does_not_use_and_whoever_imports_it_later_has_it():
    needs.ask("rclpy")
    assert lines_of("\n".join([NODE, *LATER])) == [""]


CODEC = """
from jausml.runtime.bridge.ros.internals import Codec
Codec(Odometry)
print("numpy._core" in sys.modules)
"""


def test_a_codec_has_what_its_messages_need_before_one_passes():
    needs.ask("rclpy")
    assert lines_of(NODE + CODEC) == ["", "True"]
