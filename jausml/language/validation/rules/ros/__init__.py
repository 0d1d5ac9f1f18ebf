"""Rules about ROS 2 types, nodes and installed interfaces."""
