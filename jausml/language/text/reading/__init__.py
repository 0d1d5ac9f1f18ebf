"""Reading of ros2jaus: text to syntax tree to nodes."""
