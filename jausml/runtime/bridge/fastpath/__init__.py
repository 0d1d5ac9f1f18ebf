"""The fast path: messages that pass a compiled core without Python between socket and ROS."""
