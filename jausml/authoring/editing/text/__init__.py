"""Changes of ros2jaus texts: splices that keep layout and comments."""
