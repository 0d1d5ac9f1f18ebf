"""Completion: the end of a command that takes time."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable


class Completion:
    """What a handler returns when its command is not done yet, and ends when it is.

    A client that sent the command in a CreateCommandEvent learns the end from a CommandEvent
    (AS5710 v1.1, Events); the end of any other command concerns nobody. A handler that returns
    nothing has done its command at once, one that raises has failed. May be used on any thread.
    """

    def __init__(self) -> None:
        self._succeeded: bool | None = None
        self._on_end: Callable[[], None] | None = None

    @property
    def active(self) -> bool:
        """Whether the command is still under way: neither done, failed, expired nor cancelled."""
        return self._succeeded is None

    @property
    def succeeded(self) -> bool | None:
        """Whether the command was done; None as long as it is under way."""
        return self._succeeded

    def succeed(self) -> None:
        """The command is done; no effect after its end."""
        self._end(succeeded=True)

    def fail(self) -> None:
        """The command cannot be done; no effect after its end."""
        self._end(succeeded=False)

    def when_ended(self, action: Callable[[], None]) -> None:
        """Run an action at the end, or now if that is past; one action at most."""
        self._on_end = action
        if self._succeeded is not None:
            action()

    def _end(self, *, succeeded: bool) -> None:
        if self._succeeded is None:
            self._succeeded = succeeded
            if self._on_end is not None:
                self._on_end()
