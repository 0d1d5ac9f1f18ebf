"""Error of a message definition that has no layout."""

from __future__ import annotations


class LayoutError(ValueError):
    """A message definition that cannot be encoded; `jausml validate` tells more.

    Attributes:
        path: Names of the message and its fields down to the wrong one, joined by dots.
    """

    def __init__(self, reason: str, path: str = "") -> None:
        super().__init__(reason)
        self.reason = reason
        self.path = path

    def __str__(self) -> str:
        return f"{self.path}: {self.reason}" if self.path else self.reason

    def inside(self, step: str) -> LayoutError:
        """Puts a step before the path and returns the error, on its way out of a container."""
        self.path = f"{step}.{self.path}" if self.path else step
        return self


class LimitError(LayoutError):
    """A message definition that has a layout, but one beyond what machines should work on."""
