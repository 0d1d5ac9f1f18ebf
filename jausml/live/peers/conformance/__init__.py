"""Checks of a running component over the wire, one module for each group."""
