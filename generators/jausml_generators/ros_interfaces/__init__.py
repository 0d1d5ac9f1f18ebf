"""Packages of ROS interfaces: those that a model declares, and JAUS messages as ROS messages."""
