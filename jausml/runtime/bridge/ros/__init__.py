"""The ROS side, on rclpy."""
