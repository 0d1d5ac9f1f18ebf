"""The language server for ros2jaus text."""
