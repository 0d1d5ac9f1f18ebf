"""Virtual time: components and bridges on a simulated network, ROS and clock, for tests only."""

from .graph import GraphSubscription as GraphSubscription
from .graph import RosGraph as RosGraph
from .network import Link as Link
from .network import VirtualTransport as VirtualTransport
from .node import VirtualRosNode as VirtualRosNode
from .world import VirtualWorld as VirtualWorld
