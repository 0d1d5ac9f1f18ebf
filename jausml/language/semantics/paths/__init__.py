"""Paths of maps: where they start, and the attributes of either side that they lead to."""
