"""Target `ros_node`: one package with a skeleton for each modelled ROS 2 node."""
