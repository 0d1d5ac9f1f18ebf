"""Light classes: ROS messages as plain objects that read and write their serialized form."""
