"""Peers of other makes, to try a robot before the real ones are there: habits on the wire."""
