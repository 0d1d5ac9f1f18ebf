"""Language server for ros2jaus text."""
