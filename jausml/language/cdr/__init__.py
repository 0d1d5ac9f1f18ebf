"""CDR, the serialized form of ROS messages: layouts of their types, resolved once."""
