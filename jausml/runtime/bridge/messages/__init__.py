"""ROS messages as bytes, their values, limits and errors."""
