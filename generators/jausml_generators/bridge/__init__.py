"""Target `bridge`: one package for each bridge between JAUS and ROS 2."""
