"""jausml: generates ROS 2 <-> JAUS bridges and JAUS components from models."""

__version__ = "0.1.0"
