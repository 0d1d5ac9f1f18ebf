"""Dispatch of received messages to their handlers by message code."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from .message import DecodeError, Message
from .services.definitions import Guard

if TYPE_CHECKING:
    from .address import JausAddress
    from .counters import Counters

M = TypeVar("M", bound=Message)
Q = TypeVar("Q", bound=Message)
R = TypeVar("R", bound=Message)

Action = Callable[[Any, "JausAddress"], object]
"""Takes a decoded message and its sender."""


@dataclass(frozen=True)
class Provision(Generic[Q, R]):
    """What answers a query.

    Attributes:
        query_class: Codec of the query.
        report_class: Codec of the report.
        provider: Returns the present report, or None without one.
        periodic: Whether periodic events may be set up on the query.
        every_change: Whether every-change events may be set up on the query.
    """

    query_class: type[Q]
    report_class: type[R]
    provider: Callable[[Q, JausAddress], R | None]
    periodic: bool = True
    every_change: bool = True


@dataclass(slots=True)
class _Handler:
    message_class: type[Message]
    action: Action
    guard: Guard


@dataclass(slots=True)
class _Route:
    handler: _Handler | None = None
    # Replaced, never changed: a callback may add listeners while the route is in use.
    listeners: dict[type[Message], tuple[Action, ...]] = field(default_factory=dict)


class Router:
    """Decodes messages and calls who wants them; what arrives never raises out of it."""

    def __init__(self, counters: Counters, allows: Callable[[Guard, JausAddress], bool]) -> None:
        """Start without routes.

        Args:
            counters: Where ignored messages and failures are counted.
            allows: Decides whether a sender is obeyed under a guard.
        """
        self._counters = counters
        self._allows = allows
        self._routes: dict[int, _Route] = {}
        self._provisions: dict[int, Provision[Any, Any]] = {}

    def set_handler(self, message_class: type[Message], action: Action, guard: Guard) -> None:
        """Handle a message; raises ValueError when it is handled already."""
        route = self._routes.setdefault(message_class.CODE, _Route())
        if route.handler is not None:
            raise ValueError(f"{message_class.NAME} is handled already")
        route.handler = _Handler(message_class, action, guard)

    def set_provision(
        self,
        provision: Provision[Any, Any],
        answer: Callable[[Provision[Any, Any], Message, JausAddress], None],
    ) -> None:
        """Answer a query; raises ValueError when it is handled already."""
        query_class = provision.query_class
        self.set_handler(query_class, partial(answer, provision), Guard.ANY)
        self._provisions[query_class.CODE] = provision

    def provision(self, query_code: int) -> Provision[Any, Any] | None:
        """Return what answers a query."""
        return self._provisions.get(query_code)

    def add_listener(self, message_class: type[Message], action: Action) -> None:
        """Also call ``action`` for each such message."""
        route = self._routes.setdefault(message_class.CODE, _Route())
        actions = (*route.listeners.get(message_class, ()), action)
        route.listeners = {**route.listeners, message_class: actions}

    def receive(self, payload: bytes, sender: JausAddress) -> None:
        """Dispatch one message, given as code and body."""
        route = self._routes.get(payload[0] | payload[1] << 8) if len(payload) > 1 else None
        if route is None:
            self._counters.add("component.unknown_message")
            return
        handler = route.handler
        if handler is not None:
            if handler.guard is Guard.ANY or self._allows(handler.guard, sender):
                self._deliver(handler.message_class, (handler.action,), payload, sender)
            else:
                self._counters.count(
                    "component.command_refused",
                    f"{handler.message_class.NAME} of {sender} needs {handler.guard.value}",
                )
        for message_class, actions in route.listeners.items():
            self._deliver(message_class, actions, payload, sender)

    def call(self, function: Callable[..., Any], *arguments: object) -> Any:
        """Call a function; an error is logged and counted, and None returned."""
        try:
            return function(*arguments)
        except Exception as error:
            name = getattr(function, "__qualname__", repr(function))
            self._counters.count("component.handler_failed", f"{name}: {error!r}", error=error)
            return None

    def _deliver(
        self,
        message_class: type[Message],
        actions: tuple[Action, ...],
        payload: bytes,
        sender: JausAddress,
    ) -> None:
        try:
            message = message_class.decode(payload)
        except DecodeError as error:
            self._counters.count(
                "component.bad_message", f"{message_class.NAME} of {sender}: {error}"
            )
            return
        for action in actions:
            self.call(action, message, sender)
