"""The operator unit of `jausml operate`: who may command, what is stopped, and the answers."""
