"""Shipped models: the library of service sets and interface packages, and the examples."""
