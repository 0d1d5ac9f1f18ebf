"""The executor of rclpy under a bridge, which no request from outside ends.

rclpy raises out of `spin` what a callback raises, be it of its own services: for a transition that
is not possible now, or a parameter of an unknown type. Whoever asks for that is a stranger, and the
bridge has to go on.
"""

# ROS is typed in parts; whoever checks generated code reads this module too.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call, misc"

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.executors import SingleThreadedExecutor, await_or_execute

from ...base.counters import Counters

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from rclpy.context import Context

FAILED = "ros.callback_failed"
REFUSED = "ros.request_refused"


class GuardedExecutor(SingleThreadedExecutor):
    """Runs the callbacks of a node, and counts what they raise.

    What ROS itself raises while it waits, and what is meant to end a process, still ends `spin`.
    """

    def __init__(self, context: Context) -> None:
        super().__init__(context=context)
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
