"""What goes wrong with projects."""

from __future__ import annotations


class ProjectError(Exception):
    """A project or an element of one cannot be made; the message says why."""
