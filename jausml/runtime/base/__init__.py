"""Foundations of the runtime: addresses, counters, settings, the loop."""
