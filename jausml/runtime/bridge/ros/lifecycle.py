"""Life of nodes on rclpy: managed transitions, what runs callbacks, and command lines of ROS."""

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

# ROS is typed in parts; whoever checks generated code reads this module too.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call, misc"


class ManagedNode(LazyParameters, LifecycleNode):
    """A node whose transitions bring something up and down."""

    def __init__(self, name: str, **options: Any) -> None:
        super().__init__(name, **options)
        self._managed: Any = None
        self._error: BaseException | None = None
        self._is_asked = True  # by a service, whose answer says no more than that it failed

    def manage(self, managed: Any) -> None:
        """Has transitions call methods of something, each named as its transition."""
        self._managed = managed

    def bring_up(self) -> None:
        """Goes from unconfigured to active at once; raises what keeps it from that."""
        self._is_asked = False
        for trigger in (self.trigger_configure, self.trigger_activate):
            self._error = None
            if trigger() is not TransitionCallbackReturn.SUCCESS and self._error is not None:
                raise self._error
        self._is_asked = True

    def destroy_node(self) -> None:
        """Leaves ROS, and lets go of the state machine, which rclpy forgets."""
        super().destroy_node()
        self._state_machine.destroy_when_not_in_use()

    @property
    def state(self) -> str:
        """Name of the present state, e.g. `active`."""
        name: str = self._state_machine.current_state[1]
        return name

    def on_configure(self, state: Any) -> TransitionCallbackReturn:  # noqa: ARG002
        """Makes topics and the JAUS component."""
        return self._done(lambda managed: managed.configure())

    def on_activate(self, state: Any) -> TransitionCallbackReturn:  # noqa: ARG002
        """Lets messages pass."""
        return self._done(lambda managed: managed.activate())

    def on_deactivate(self, state: Any) -> TransitionCallbackReturn:  # noqa: ARG002
        """Lets nothing pass."""
        return self._done(lambda managed: managed.deactivate())

    def on_cleanup(self, state: Any) -> TransitionCallbackReturn:  # noqa: ARG002
        """Ends the JAUS component and gives topics back."""
        return self._done(lambda managed: managed.cleanup())

    def on_shutdown(self, state: Any) -> TransitionCallbackReturn:  # noqa: ARG002
        """Does the same for good, from any state."""
        return self._done(lambda managed: managed.shut_down())

    def _done(self, act: Callable[[Any], None]) -> TransitionCallbackReturn:
        """Acts; a failure stays in the state before."""
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
    """Runs the callbacks of nodes on one thread until another one ends it.

    The `shutdown` of rclpy takes the condition that wakes `spin` away while that may prepare to
    wait: it would wait for ever. It is for an executor that does not spin any more.
    Other threads may destroy publishers and subscriptions meanwhile. What rclpy does with those
    that it has looked up already, it does not do with what tells their events, which raises.
    """

    def __init__(self, context: Context) -> None:
        super().__init__(context=context)
        self._is_ended = False

    def spin(self) -> None:
        """Runs callbacks until `end`, or an ExternalShutdownException of ROS."""
        while self.context.ok() and not self._is_ended:
            # By another condition it would forget what is ready, and serve the first ones alone.
            self._spin_once_impl(None, self._has_ended)

    def end(self) -> None:
        """Lets `spin` return after the callback that it runs."""
        self._is_ended = True
        self.wake()

    def wait_for_ready_callbacks(self, *arguments: Any, **named: Any) -> Any:
        """Waits for the next callback, anew when something was destroyed before the wait."""
        while True:
            with suppress(InvalidHandle):
                return super().wait_for_ready_callbacks(*arguments, **named)

    def _take_waitable(self, waitable: Any) -> Any:
        # Raised here, it would leave the callback group of the node occupied for ever.
        with suppress(InvalidHandle):
            return super()._take_waitable(waitable)
        return None

    def _has_ended(self) -> bool:
        return self._is_ended


class GuardedExecutor(EndableExecutor):
    """Runs the callbacks of a node, and counts what they raise: no request may end a bridge.

    rclpy raises out of `spin` what a callback raises, be it of its own services: for a transition
    that is not possible now, or a parameter of an unknown type.
    What ROS itself raises while it waits, and what is meant to end a process, still ends `spin`.
    """

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        self.counters = Counters()

    def add_node(self, node: Any) -> bool:
        """Serves a node; each of its services answers whatever it is asked."""
        for service in node.services:
            service.callback = partial(self._answer, service.callback)
        return bool(super().add_node(node))

    def create_task(self, callback: Any, *arguments: Any, **named: Any) -> Any:
        """Runs a callback in a later turn."""
        return super().create_task(self._guarded(callback), *arguments, **named)

    def _make_handler(self, entity: Any, node: Any, take: Callable[[Any], Any]) -> Any:
        # Taking fails too, and rclpy would serve the entity never again.
        return super()._make_handler(entity, node, partial(self._taken, take))

    def _taken(self, take: Callable[[Any], Any], entity: Any) -> Any:
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
        """Answers a request; what cannot be done is refused."""
        try:
            return serve(request, response)
        except Exception as error:
            text = " ".join(str(error).split())
            self.counters.count(REFUSED, f"{type(request).__qualname__}: {text}")
            return _refused(request, response, text)

    def _count(self, error: Exception) -> None:
        self.counters.count(FAILED, repr(error), error=error)


def _refused(request: Any, response: Any, reason: str) -> Any:
    """Returns a response that says that a request was refused, as far as its type can.

    Others are those of a transition, which fails unless it says that it succeeded, and of
    questions.
    """
    refused = SetParametersResult(successful=False, reason=reason)
    if isinstance(response, SetParameters.Response):
        lacking = len(request.parameters) - len(response.results)
        response.results.extend([refused] * lacking)
    elif isinstance(response, SetParametersAtomically.Response):
        response.result = refused
    return response


def without_ros_arguments(line: Sequence[str]) -> list[str]:
    """Returns a command line without what is meant for ROS, where wrong a ParameterError."""
    with as_parameter_error():
        own: list[str] = remove_ros_args(["", *line])[1:]
    return own
