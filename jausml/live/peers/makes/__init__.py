"""Simulated peers of other makes, with their habits on the wire, to try a robot without them."""
