"""Virtual time: components and bridges on a simulated network, ROS and clock, for tests.

Nothing of it is imported by what runs on a robot.
"""

from .graph import GraphSubscription, RosGraph
from .network import Link, VirtualTransport
from .node import VirtualRosNode
from .world import VirtualWorld

__all__ = [
    "GraphSubscription",
    "Link",
    "RosGraph",
    "VirtualRosNode",
    "VirtualTransport",
    "VirtualWorld",
]
