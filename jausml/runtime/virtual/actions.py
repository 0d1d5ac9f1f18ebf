"""Actions of a virtual ROS: goals go from clients to servers, feedback and results come back.

Elements of goals are serialized. What a goal has besides is a plain object, since in virtual time
there need not be a class of ROS for it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from types import SimpleNamespace
from typing import Any

from ..bridge.ends.actions import GoalTaker, GoalWatcher, Outcome
from ..bridge.ends.topics import TopicFault
from .network import Way

NO_SERVER = "no_action_server"


class VirtualAction:
    """An action by its name."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.server: GoalTaker | None = None  # whoever takes its goals; None for nobody

    def close(self, server: GoalTaker) -> None:
        """Serves no more; no effect where another one does."""
        if self.server is server:
            self.server = None


class VirtualActionClient:
    """Sends goals of one action; see `ActionClient` of ends/actions.py."""

    def __init__(self, action: VirtualAction, way: Way) -> None:
        self._action = action
        self._way = way

    def send(
        self, elements: Sequence[bytes], fill: Callable[[Any], object] | None, watcher: GoalWatcher
    ) -> VirtualGoal:
        """Sends a goal; it waits for a server where there is none."""
        goal = VirtualGoal(self._action, self._way, elements, watcher)
        goal.send(fill)
        return goal

    def faults(self) -> list[TopicFault]:
        """Returns why goals cannot be sent; nothing while they can."""
        if self._action.server is not None:
            return []
        return [TopicFault(NO_SERVER, f"nobody serves the action {self._action.name}")]


class VirtualGoal:
    """A goal: what its client has sent, and what its server executes."""

    def __init__(
        self, action: VirtualAction, way: Way, elements: Sequence[bytes], watcher: GoalWatcher
    ) -> None:
        self.elements = list(elements)  # serialized
        self.request = SimpleNamespace()
        self._action = action
        self._way = way
        self._watcher: GoalWatcher | None = watcher
        self._server: GoalTaker | None = None
        self._has_arrived = self._is_cancelled = self._has_ended = False

    # ------------------------------------------------------------------ for its client

    def send(self, fill: Callable[[Any], object] | None) -> None:
        """Lets it come to whoever serves the action."""
        try:
            if fill is not None:
                fill(self.request)
        except Exception as error:  # of what the user has written
            self._finish(Outcome.REFUSED, f"the goal cannot be made: {error!r}")
            return
        self.check()

    def cancel(self) -> None:
        """Asks that it ends; also when it is accepted later. May be repeated."""
        self._is_cancelled = True
        # No server has it, so there is nobody to ask.
        if self._server is None:
            self._finish(Outcome.CANCELED, "")
        else:
            self._way.carry(self._ask_to_end)

    def check(self) -> None:
        """Finds out whether whoever executes it is there; sends it where nobody was."""
        server = self._action.server
        if self._has_ended:
            return
        if self._server is not None and server is not self._server:
            self._finish(Outcome.LOST, "the action server is gone")
        elif self._server is None and server is not None:
            self._server = server
            self._way.carry(partial(self._arrive, server))

    def forget(self) -> None:
        """Tells nothing of it any more; if it is accepted later, it is cancelled."""
        # First: the end that this brings about is told to nobody.
        self._watcher = None
        self.cancel()

    # ------------------------------------------------------------------ for its server

    def progress(self, number: int) -> None:
        """Publishes feedback."""
        self._way.carry(partial(self._tell, "progressed", number))

    def end(self, outcome: Outcome, reason: str = "") -> None:
        """Gives the result."""
        self._way.carry(partial(self._finish, outcome, reason))

    # ------------------------------------------------------------------ on its way

    def _arrive(self, server: GoalTaker) -> None:
        if self._has_arrived:  # a copy
            return
        self._has_arrived = True
        if not server.accepts(self.elements, self.request):
            self.end(Outcome.REFUSED, "the action server refused the goal")
            return
        self._way.carry(partial(self._tell, "accepted"))
        server.begin(self)
        # Cancelled while it was on its way.
        if self._is_cancelled:
            self._ask_to_end()

    def _ask_to_end(self) -> None:
        if self._server is not None and not self._has_ended:
            self._server.cancel(self)

    def _finish(self, outcome: Outcome, reason: str) -> None:
        if not self._has_ended:
            # While it has not ended: `_tell` is silent after that.
            self._tell("ended", outcome, reason)
            self._has_ended = True

    def _tell(self, what: str, *arguments: object) -> None:
        watcher = self._watcher
        if watcher is not None and not self._has_ended:
            getattr(watcher, what)(self, *arguments)
