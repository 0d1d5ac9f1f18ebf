"""Recording: traffic of JAUS and ROS in MCAP files, and its replay through maps of a model."""
