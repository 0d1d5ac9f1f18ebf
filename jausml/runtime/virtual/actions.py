"""Actions of a virtual ROS: goals are sent to servers, feedback and results to clients.

Elements of goals are serialized. The other fields of a goal are attributes of a plain object, since
virtual time needs no ROS, and so may have no class of the action.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from types import SimpleNamespace
from typing import Any

from ..bridge.ends.actions import GoalTaker, GoalWatcher, Outcome
from ..bridge.ends.topics import TopicFault
from .network import Path

NO_SERVER = "no_action_server"


class VirtualAction:
    """An action and its server."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.server: GoalTaker | None = None  # takes the goals; None without one

    def close(self, server: GoalTaker) -> None:
        """Removes a server; no effect if another one has replaced it."""
        if self.server is server:
            self.server = None


class VirtualActionClient:
    """Sends goals of one action; see `ActionClient` of ends/actions.py."""

    def __init__(self, action: VirtualAction, path: Path) -> None:
        self._action = action
        self._path = path

    def send(
        self, elements: Sequence[bytes], fill: Callable[[Any], object] | None, watcher: GoalWatcher
    ) -> VirtualGoal:
        """Sends a goal, or keeps it until there is a server; `fill` sets its further fields."""
        goal = VirtualGoal(self._action, self._path, elements, watcher)
        goal.send(fill)
        return goal

    def faults(self) -> list[TopicFault]:
        """Returns the faults for which goals cannot be sent."""
        if self._action.server is not None:
            return []
        return [TopicFault(NO_SERVER, f"nobody serves the action {self._action.name}")]


class VirtualGoal:
    """A goal, both for its client and for its server."""

    def __init__(
        self, action: VirtualAction, path: Path, elements: Sequence[bytes], watcher: GoalWatcher
    ) -> None:
        self.elements = list(elements)  # serialized
        self.request = SimpleNamespace()  # the other fields
        self._action = action
        self._path = path
        self._watcher: GoalWatcher | None = watcher
        self._server: GoalTaker | None = None
        self._has_arrived = self._is_cancelled = self._has_ended = False

    # ------------------------------------------------------------------ for its client

    def send(self, fill: Callable[[Any], object] | None) -> None:
        """Sends the goal to the server of the action, if there is one."""
        try:
            if fill is not None:
                fill(self.request)
        except Exception as error:  # of user code
            self._finish(Outcome.REFUSED, f"the goal cannot be made: {error!r}")
            return
        self.check()

    def cancel(self) -> None:
        """Requests cancellation, also of a goal that is accepted later; may be repeated."""
        self._is_cancelled = True
        # Without a server, the goal ends at once.
        if self._server is None:
            self._finish(Outcome.CANCELED, "")
        else:
            self._path.carry(self._request_cancel)

    def check(self) -> None:
        """Ends the goal if its server is gone; sends it if there is a server now."""
        server = self._action.server
        if self._has_ended:
            return
        if self._server is not None and server is not self._server:
            self._finish(Outcome.LOST, "the action server is gone")
        elif self._server is None and server is not None:
            self._server = server
            self._path.carry(partial(self._arrive, server))

    def forget(self) -> None:
        """Cancels the goal, also if it is accepted later, without further calls of the watcher."""
        # First, as the cancellation may end the goal.
        self._watcher = None
        self.cancel()

    # ------------------------------------------------------------------ for its server

    def progress(self, number: int) -> None:
        """Publishes feedback."""
        self._path.carry(partial(self._notify, "progressed", number))

    def end(self, outcome: Outcome, reason: str = "") -> None:
        """Sends the result."""
        self._path.carry(partial(self._finish, outcome, reason))

    # ------------------------------------------------------------------ between both

    def _arrive(self, server: GoalTaker) -> None:
        if self._has_arrived:  # a copy
            return
        self._has_arrived = True
        if not server.accepts(self.elements, self.request):
            self.end(Outcome.REFUSED, "the action server refused the goal")
            return
        self._path.carry(partial(self._notify, "accepted"))
        server.begin(self)
        # Cancelled before its arrival.
        if self._is_cancelled:
            self._request_cancel()

    def _request_cancel(self) -> None:
        if self._server is not None and not self._has_ended:
            self._server.cancel(self)

    def _finish(self, outcome: Outcome, reason: str) -> None:
        if not self._has_ended:
            # Before the goal has ended: `_notify` does nothing afterwards.
            self._notify("ended", outcome, reason)
            self._has_ended = True

    def _notify(self, method: str, *arguments: object) -> None:
        watcher = self._watcher
        if watcher is not None and not self._has_ended:
            getattr(watcher, method)(self, *arguments)
