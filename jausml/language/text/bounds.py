"""Bounds of texts: none beyond them is read, and none is written."""

LONGEST = 4 * 1024 * 1024
"""Characters that a text may have."""
DEEPEST = 64
"""How deep brackets may be nested."""
