"""Dispatch of received messages to their handlers by message code."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from ..wire.message import DecodeError, Message
from .definitions import Guard

if TYPE_CHECKING:
    from ..base.address import JausAddress
    from ..base.counters import Counters

LONGEST_CALL = 0.5
"""Seconds after which the log tells that user code blocks."""

M = TypeVar("M", bound=Message)
Q = TypeVar("Q", bound=Message)
R = TypeVar("R", bound=Message)

Action = Callable[[Any, "JausAddress"], object]
"""Takes a decoded message and its sender."""

Take = Callable[[bytes, "JausAddress"], None]
"""Takes an encoded message and its sender."""

Condition = Guard | Callable[[Any], Guard]
"""Whom to obey: always the same, or depending on the message."""


@dataclass(frozen=True)
class Provision(Generic[Q, R]):
    """What answers a query.

    Attributes:
        query_class: Codec of the query.
        report_class: Codec of the report.
        provider: Returns the present report, encoded or not, or None without one.
        periodic: Whether periodic events may be set up on the query.
        every_change: Whether every-change events may be set up on the query.
    """

    query_class: type[Q]
    report_class: type[R]
    provider: Callable[[Q, JausAddress], R | bytes | None]
    periodic: bool = True
    every_change: bool = True


@dataclass(slots=True)
class Handler:
    """What acts on an input message.

    Attributes:
        message_class: Codec of the message.
        action: Acts on the message.
        condition: Whom to obey.
        takes_payload: Whether the action takes the encoded message instead of the decoded one.
    """

    message_class: type[Message]
    action: Action
    condition: Condition
    takes_payload: bool = False

    def guard_for(self, message: Message) -> Guard:
        """Return whom to obey when the message is this one."""
        return self.condition if isinstance(self.condition, Guard) else self.condition(message)


def _name_of(function: Callable[..., Any]) -> str:
    """Returns the name of a function for the log."""
    while isinstance(function, partial):
        function = function.func
    return str(getattr(function, "__qualname__", repr(function)))


@dataclass(slots=True)
class _Route:
    handler: Handler | None = None
    # Replaced, never changed: a callback may add listeners while the route is in use.
    listeners: dict[type[Message], tuple[Action, ...]] = field(default_factory=dict)
    payload_listeners: tuple[Action, ...] = ()


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

    def set_handler(
        self,
        message_class: type[Message],
        action: Action,
        condition: Condition,
        *,
        takes_payload: bool = False,
    ) -> None:
        """Handle a message; raises ValueError when it is handled already."""
        route = self._routes.setdefault(message_class.CODE, _Route())
        if route.handler is not None:
            raise ValueError(f"{message_class.NAME} is handled already")
        route.handler = Handler(message_class, action, condition, takes_payload)

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

    def handler(self, code: int) -> Handler | None:
        """Return what acts on a message."""
        route = self._routes.get(code)
        return None if route is None else route.handler

    def add_listener(self, message_class: type[Message], action: Action) -> None:
        """Also call ``action`` for each such message."""
        route = self._routes.setdefault(message_class.CODE, _Route())
        actions = (*route.listeners.get(message_class, ()), action)
        route.listeners = {**route.listeners, message_class: actions}

    def add_payload_listener(self, message_class: type[Message], action: Action) -> None:
        """Also call ``action`` with the bytes of each such message."""
        route = self._routes.setdefault(message_class.CODE, _Route())
        bad = partial(self._count_bad, message_class)
        route.payload_listeners += (self.payload_caller(action, bad),)

    def receive(self, payload: bytes, sender: JausAddress) -> None:
        """Dispatch one message, given as code and body."""
        route = self._routes.get(payload[0] | payload[1] << 8) if len(payload) > 1 else None
        if route is None:
            self._counters.add("component.unknown_message")
            return
        if route.handler is not None:
            self._handle(route.handler, payload, sender)
        for listener in route.payload_listeners:
            listener(payload, sender)
        for message_class, actions in route.listeners.items():
            self._deliver(message_class, actions, payload, sender)

    def call(self, function: Callable[..., Any], *arguments: object) -> Any:
        """Call a function; an error is logged and counted, and None returned."""
        return self.attempt(function, *arguments)[1]

    def attempt(self, function: Callable[..., Any], *arguments: object) -> tuple[bool, Any]:
        """Call a function; tell whether it raised no error, and what it returned."""
        started = time.monotonic()
        try:
            return True, function(*arguments)
        except Exception as error:
            self._count_failure(function, error)
            return False, None
        finally:
            self._watch_duration(function, time.monotonic() - started)

    def payload_caller(
        self, function: Action, on_bad: Callable[[JausAddress, DecodeError], None]
    ) -> Take:
        """Return what calls a function that takes encoded messages, as ``call`` does.

        Args:
            function: Takes an encoded message and its sender.
            on_bad: Told the sender and the error when the function cannot read a message.
        """
        clock = time.monotonic

        def take(payload: bytes, sender: JausAddress) -> None:
            started = clock()
            try:
                function(payload, sender)
            except DecodeError as error:
                on_bad(sender, error)
            except Exception as error:
                self._count_failure(function, error)
            elapsed = clock() - started
            if elapsed > LONGEST_CALL:
                self._watch_duration(function, elapsed)

        return take

    def _count_failure(self, function: Callable[..., Any], error: Exception) -> None:
        name = _name_of(function)
        self._counters.count("component.handler_failed", f"{name}: {error!r}", error=error)

    def _watch_duration(self, function: Callable[..., Any], seconds: float) -> None:
        if seconds > LONGEST_CALL:
            self._counters.count(
                "component.handler_blocked",
                f"{_name_of(function)} took {seconds:.1f} s; nothing was received meanwhile",
            )

    def _handle(self, handler: Handler, payload: bytes, sender: JausAddress) -> None:
        """Act on a message if its sender is obeyed; one that is not costs no decoding."""
        if handler.takes_payload:
            if self._obeys_payload(handler, payload, sender):
                bad = partial(self._count_bad, handler.message_class)
                self.payload_caller(handler.action, bad)(payload, sender)
        elif not isinstance(handler.condition, Guard):
            message = self._decode(handler.message_class, payload, sender)
            guard = None if message is None else self.call(handler.guard_for, message)
            if guard is not None and self._obeys(handler, guard, sender):
                self.call(handler.action, message, sender)
        elif self._obeys(handler, handler.condition, sender):
            self._deliver(handler.message_class, (handler.action,), payload, sender)

    def _obeys_payload(self, handler: Handler, payload: bytes, sender: JausAddress) -> bool:
        """Return whether a sender is obeyed; the message is only read for one who is not ready."""
        if isinstance(handler.condition, Guard):
            return self._obeys(handler, handler.condition, sender)
        if self._allows(Guard.READY, sender):
            return True
        message = self._decode(handler.message_class, payload, sender)
        guard = None if message is None else self.call(handler.guard_for, message)
        return guard is not None and self._obeys(handler, guard, sender)

    def _obeys(self, handler: Handler, guard: Guard, sender: JausAddress) -> bool:
        if guard is Guard.ANY or self._allows(guard, sender):
            return True
        self._counters.count(
            "component.command_refused",
            f"{handler.message_class.NAME} of {sender} needs {guard.value}",
        )
        return False

    def _deliver(
        self,
        message_class: type[Message],
        actions: tuple[Action, ...],
        payload: bytes,
        sender: JausAddress,
    ) -> None:
        message = self._decode(message_class, payload, sender)
        if message is not None:
            for action in actions:
                self.call(action, message, sender)

    def _decode(
        self, message_class: type[Message], payload: bytes, sender: JausAddress
    ) -> Message | None:
        try:
            return message_class.decode(payload)
        except DecodeError as error:
            self._count_bad(message_class, sender, error)
            return None

    def _count_bad(
        self, message_class: type[Message], sender: JausAddress, error: DecodeError
    ) -> None:
        self._counters.count("component.bad_message", f"{message_class.NAME} of {sender}: {error}")
