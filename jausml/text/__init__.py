"""The ros2jaus language: text to model and model to text."""
