"""The error of projects."""


class ProjectError(Exception):
    """A project or an element of one cannot be made; the message says why."""
