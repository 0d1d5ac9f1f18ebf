"""Writing of ros2jaus: models to syntax tree to text."""
