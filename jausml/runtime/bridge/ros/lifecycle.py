"""Managed nodes on rclpy, executors that run their callbacks, and command lines of ROS."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Sequence
from contextlib import suppress
from functools import partial
from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.context import Context
from rclpy.exceptions import InvalidHandle
from rclpy.executors import SingleThreadedExecutor, await_or_execute
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.utilities import remove_ros_args

from ...base.counters import LOGGER, Counters
from .parameters import LazyParameters, as_parameter_error

# rclpy has few types, and type checks of generated code include this module.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call, misc"


class ManagedNode(LazyParameters, LifecycleNode):
    """A node whose transitions call the methods of a `ManagedBridge`."""

    def __init__(self, name: str, **options: Any) -> None:
        super().__init__(name, **options)
        self._managed: Any = None
        self._error: BaseException | None = None
        self._is_asked = True  # whether a service asks, which does not return the error

    def manage(self, managed: Any) -> None:
        """Sets the object whose methods the transitions call; they have the same names."""
        self._managed = managed

    def bring_up(self) -> None:
        """Goes from unconfigured to active; raises the error of a failed transition."""
        self._is_asked = False
        for trigger in (self.trigger_configure, self.trigger_activate):
            self._error = None
            if trigger() is not TransitionCallbackReturn.SUCCESS and self._error is not None:
                raise self._error
        self._is_asked = True

    def destroy_node(self) -> None:
        """Leaves ROS, and destroys the state machine, which rclpy does not."""
        super().destroy_node()
        self._state_machine.destroy_when_not_in_use()

    @property
    def state(self) -> str:
        """Name of the present state, e.g. `active`."""
        name: str = self._state_machine.current_state[1]
        return name

    def on_configure(self, state: Any) -> TransitionCallbackReturn:  # noqa: ARG002
        """Makes topics and the JAUS component."""
        return self._transition(lambda managed: managed.configure())

    def on_activate(self, state: Any) -> TransitionCallbackReturn:  # noqa: ARG002
        """Begins to pass messages on."""
        return self._transition(lambda managed: managed.activate())

    def on_deactivate(self, state: Any) -> TransitionCallbackReturn:  # noqa: ARG002
        """Stops passing messages on."""
        return self._transition(lambda managed: managed.deactivate())

    def on_cleanup(self, state: Any) -> TransitionCallbackReturn:  # noqa: ARG002
        """Ends the JAUS component and destroys topics."""
        return self._transition(lambda managed: managed.cleanup())

    def on_shutdown(self, state: Any) -> TransitionCallbackReturn:  # noqa: ARG002
        """Does the same from any state, and ends the process."""
        return self._transition(lambda managed: managed.shut_down())

    def _transition(self, act: Callable[[Any], None]) -> TransitionCallbackReturn:
        """Performs a transition; returns FAILURE, which keeps the state, if it raises."""
        if self._managed is None:
            return TransitionCallbackReturn.SUCCESS
        try:
            act(self._managed)
        except BaseException as error:  # SystemExit of overridden methods too
            self._error = error
            if self._is_asked:
                LOGGER.error("%s: a transition failed: %s", self.get_fully_qualified_name(), error)
            return TransitionCallbackReturn.FAILURE
        return TransitionCallbackReturn.SUCCESS


FAILED = "ros.callback_failed"
REFUSED = "ros.request_refused"


class EndableExecutor(SingleThreadedExecutor):
    """Runs the callbacks of nodes on one thread until another thread ends it.

    `shutdown` of rclpy removes the condition that wakes `spin`, which might then wait for ever. It
    is for an executor that does not spin any more. Other threads may destroy publishers and
    subscriptions meanwhile; rclpy ignores a destroyed one, but raises for its event handlers.
    """

    def __init__(self, context: Context) -> None:
        super().__init__(context=context)
        self._is_ended = False

    def spin(self) -> None:
        """Runs callbacks until `end`, or an ExternalShutdownException of ROS."""
        while self.context.ok() and not self._is_ended:
            # The same condition each time: with a new one rclpy forgets which callbacks are ready.
            self._spin_once_impl(None, self._has_ended)

    def end(self) -> None:
        """Lets `spin` return after the callback that it runs."""
        self._is_ended = True
        self.wake()

    def wait_for_ready_callbacks(self, *arguments: Any, **named: Any) -> Any:
        """Waits for the next callback; again, if a handle was destroyed before the wait."""
        while True:
            with suppress(InvalidHandle):
                return super().wait_for_ready_callbacks(*arguments, **named)

    def _take_waitable(self, waitable: Any) -> Any:
        # An error would leave the callback group of the node occupied for ever.
        with suppress(InvalidHandle):
            return super()._take_waitable(waitable)
        return None

    def _has_ended(self) -> bool:
        return self._is_ended


class GuardedExecutor(EndableExecutor):
    """Runs the callbacks of a node and counts their errors, so that no request ends a bridge.

    In rclpy each error of a callback ends `spin`, even of its own services: for a transition that
    is not possible now, or a parameter of an unknown type. Errors of ROS itself while it waits, and
    SystemExit, still end `spin` here.
    """

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        self.counters = Counters()

    def add_node(self, node: Any) -> bool:
        """Serves a node, whose services answer even requests that fail."""
        for service in node.services:
            service.callback = partial(self._answer, service.callback)
        return bool(super().add_node(node))

    def create_task(self, callback: Any, *arguments: Any, **named: Any) -> Any:
        """Runs a callback in a later turn."""
        return super().create_task(self._guarded(callback), *arguments, **named)

    def _make_handler(self, entity: Any, node: Any, take: Callable[[Any], Any]) -> Any:
        # Also if taking fails, after which rclpy would not serve the entity any more.
        return super()._make_handler(entity, node, partial(self._take_guarded, take))

    def _take_guarded(self, take: Callable[[Any], Any], entity: Any) -> Any:
        try:
            work = take(entity)
        except Exception as error:
            self._count(error)
            return None
        return None if work is None else self._guarded(work)

    def _guarded(self, callback: Callable[..., Any]) -> Callable[..., Awaitable[Any]]:
        async def guarded(*arguments: Any, **named: Any) -> Any:
            try:
                return await await_or_execute(partial(callback, **named), *arguments)
            except Exception as error:
                self._count(error)

        return guarded

    def _answer(self, serve: Callable[[Any, Any], Any], request: Any, response: Any) -> Any:
        """Answers a request; refuses it if `serve` raises."""
        try:
            return serve(request, response)
        except Exception as error:
            text = " ".join(str(error).split())
            self.counters.count(REFUSED, f"{type(request).__qualname__}: {text}")
            return _refused(request, response, text)

    def _count(self, error: Exception) -> None:
        self.counters.count(FAILED, repr(error), error=error)


def _refused(request: Any, response: Any, reason: str) -> Any:
    """Returns the response with a refusal, for requests to set parameters.

    Other responses are unchanged: those to transitions say failure by default.
    """
    refused = SetParametersResult(successful=False, reason=reason)
    if isinstance(response, SetParameters.Response):
        missing = len(request.parameters) - len(response.results)
        response.results.extend([refused] * missing)
    elif isinstance(response, SetParametersAtomically.Response):
        response.result = refused
    return response


def without_ros_arguments(line: Sequence[str]) -> list[str]:
    """Returns a command line without arguments for ROS; raises ParameterError for wrong ones."""
    with as_parameter_error():
        own: list[str] = remove_ros_args(["", *line])[1:]
    return own
