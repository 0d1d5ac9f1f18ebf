"""Connections of ROS actions and JAUS lists."""
