"""Connections of ROS services and JAUS queries."""
