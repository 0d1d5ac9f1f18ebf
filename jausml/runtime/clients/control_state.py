"""What a component knows of its control over another one, and who is told."""

from __future__ import annotations

from enum import Enum
from typing import Protocol


class ControlState(Enum):
    """What a component knows of its control over another one."""

    SEEKING = "seeking"
    """The target does not answer, or control was lost; it is requested."""
    CONTROLLED = "controlled"
    """The target is controlled, and not (yet) Ready."""
    READY = "ready"
    """The target is controlled and obeys every command."""
    REFUSED = "refused"
    """The target is not available or has a controller of the same or higher authority."""


class Session(Protocol):
    """One user's share, as the control sees it."""

    authority: int
    resume: bool

    def changed(self) -> None:
        """Learn that the state is another one."""
