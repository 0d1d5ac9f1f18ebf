"""Changes of ros2jaus texts: laid out as a whole, with all comments kept."""
