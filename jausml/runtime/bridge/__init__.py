"""Bridges: a JAUS component and a ROS 2 node in one process, and the connections between them."""
