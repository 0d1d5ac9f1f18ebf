"""Rules about ROS 2 types, nodes and installed interfaces."""

from jausml.validation.rules.ros import installed, types

MODULES = (installed, types)
