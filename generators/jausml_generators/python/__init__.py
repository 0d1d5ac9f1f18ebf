"""Shared parts of all targets that write Python: names, layout, imports, package files."""
