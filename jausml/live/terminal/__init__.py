"""The terminal view of a running system. Its modules need textual."""
