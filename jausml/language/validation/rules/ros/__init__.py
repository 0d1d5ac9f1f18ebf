"""Rules about ROS 2 types, nodes and installed interfaces."""

from jausml.language.validation.rules.ros import installed, types

MODULES = (installed, types)
