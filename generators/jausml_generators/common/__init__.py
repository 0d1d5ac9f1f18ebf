"""Shared parts of several targets: components, ROS names, names of the runtime."""
