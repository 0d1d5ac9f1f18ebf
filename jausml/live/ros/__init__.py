"""ROS as it runs: a quiet node, the graph, messages on topics, parameters. Needs rclpy."""
