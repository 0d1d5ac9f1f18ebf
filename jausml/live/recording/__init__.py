"""Recording: traffic of JAUS and ROS in MCAP files, and from there through the maps of a model."""
