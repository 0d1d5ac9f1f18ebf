"""Common parts of ROS action clients and servers: messages, and work on the executor."""

# rclpy has few types, and type checks of generated code include this module.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call"

from __future__ import annotations

import math
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from functools import partial
from itertools import accumulate, islice
from operator import attrgetter
from typing import Any

from ...base.loop import Loop
from ..ends.actions import LONGEST_GOAL, ListAction, Progress
from ..light_message import assign, installed
from ..messages.limits import RosTypeError
from .internals import Codec


class ActionWork:
    """Runs callbacks of the actions of one node in order, and tracks goals under way."""

    def __init__(self, node: Any, executor: Any, loop: Loop, ward: Any) -> None:
        self.loop = loop
        self.ward = ward
        self.node = node
        # Ids of the goals of this process, also of other connections to one action.
        self.own_goals: set[bytes] = set()
        self._executor = executor
        self._waiting: deque[Callable[[], object]] = deque()
        self._goals: set[object] = set()
        self._changed = threading.Condition()

    def run(self, callback: Callable[..., object], *arguments: object) -> None:
        """Runs a callback on the thread of the executor, after those of earlier calls.

        The order is kept here, as the executor begins with its newest task.
        """
        self._waiting.append(partial(callback, *arguments))
        self._executor.create_task(self._run_next)

    def _run_next(self) -> None:
        self.guarded(self._waiting.popleft())

    def guarded(self, callback: Callable[..., object], *arguments: object) -> None:
        """Runs a callback; counts an error, which would end the executor."""
        try:
            callback(*arguments)
        except Exception as error:
            self.loop.counters.count("ros_actions.failed", repr(error), error=error)

    def add_goal(self, goal: object) -> None:
        """Adds a goal under way."""
        with self._changed:
            self._goals.add(goal)

    def remove_goal(self, goal: object) -> None:
        """Removes a goal that has ended."""
        with self._changed:
            self._goals.discard(goal)
            self._changed.notify_all()

    def wait(self, deadline: float) -> None:
        """Waits until all goals have ended, or until a time of the steady clock."""
        with self._changed:
            while self._goals and (left := deadline - time.monotonic()) > 0:
                self._changed.wait(left)


class ActionMessages:
    """The classes of rclpy of an action, and access to the fields that the bridge uses."""

    def __init__(self, action: ListAction) -> None:
        try:
            self.type = installed(action.type_name)
        except ImportError as error:
            raise RosTypeError(f"{action.type_name} is not installed ({error})") from error
        self._codec = Codec(action.element)
        self._action = action
        kind = self._codec.message_class
        element = f"{kind.__module__.split('.')[0]}/{kind.__name__}"
        allowed = (f"sequence<{element}", element)
        goal_type = _require(self.type.Goal, action.goal, allowed, action.type_name)
        self._is_single = goal_type == element
        is_distance = action.counting is Progress.DISTANCE
        numbers = ("float", "double") if is_distance else ("int", "uint")
        _require(self.type.Feedback, action.progress, numbers, action.type_name)
        _require(self.type.Result, action.reason, "string", action.type_name)

    def goal(self, elements: Sequence[bytes]) -> Any:
        """Returns a goal with these serialized elements."""
        goal = self.type.Goal()
        messages = [self._codec.decode(element) for element in elements]
        assign(goal, self._action.goal, value=messages[0] if self._is_single else messages)
        # A nav_msgs/Path is in the frame of its own header, not in those of its poses.
        parent = self._action.goal.rpartition(".")[0]
        path: Any = attrgetter(parent)(goal) if parent else None
        if messages and hasattr(path, "header") and hasattr(messages[0], "header"):
            path.header = messages[0].header
        return goal

    def distances(self, goal: Any) -> list[float]:
        """Returns the metres from each element of a list to the last, if feedback counts these."""
        if self._is_single or self._action.counting is not Progress.DISTANCE:
            return []
        positions = map(_position, attrgetter(self._action.goal)(goal))
        points = [(position.x, position.y, position.z) for position in positions]
        lengths = map(math.dist, points[:0:-1], points[-2::-1])
        return [*accumulate(lengths, initial=0.0)][::-1]

    def elements(self, goal: Any) -> list[bytes]:
        """Returns the serialized elements of a goal, at most one more than are allowed."""
        elements = attrgetter(self._action.goal)(goal)
        return [self._codec.encode(element) for element in islice(elements, LONGEST_GOAL + 1)]

    def feedback(self, number: int) -> Any:
        """Returns a feedback with the number of the progress; None if the action has none."""
        if not self._action.progress:
            return None
        feedback = self.type.Feedback()
        assign(feedback, self._action.progress, value=number)
        return feedback

    def progress(self, feedback: Any, distances: Sequence[float]) -> int | None:
        """Returns the number of the progress in a feedback; None if the action has none."""
        if not self._action.progress:
            return None
        number: float = attrgetter(self._action.progress)(feedback)
        if self._action.counting is not Progress.DISTANCE:
            return int(number)
        return sum(distance > number for distance in distances)

    def result(self, reason: str) -> Any:
        """Returns a result, with the reason if the action has a field for it."""
        result = self.type.Result()
        if self._action.reason:
            assign(result, self._action.reason, value=reason)
        return result

    def reason(self, result: Any) -> str:
        """Returns the reason in a result; empty if the action has none."""
        return str(attrgetter(self._action.reason)(result)) if self._action.reason else ""


def _require(kind: Any, path: str, types: str | tuple[str, ...], name: str) -> str:
    """Returns the type at a path of a class; raises RosTypeError if it is none of `types`."""
    if not path:
        return ""
    parent, _, member = path.rpartition(".")
    try:
        owner = attrgetter(parent)(kind()) if parent else kind
        actual_type = owner.get_fields_and_field_types()[member]
    except (AttributeError, KeyError):
        actual_type = "nothing"
    if not actual_type.startswith(types):
        wanted = types if isinstance(types, str) else " or ".join(types)
        raise RosTypeError(f"{name}: {path} is {actual_type} there, not {wanted}")
    return str(actual_type)


def _position(element: Any) -> Any:
    return getattr(element, "pose", element).position
