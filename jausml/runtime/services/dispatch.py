"""Dispatch of received messages to their handlers and listeners by message code."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Generic, TypeVar

from ..base.address import JausAddress
from ..base.counters import Clock, Counters
from ..base.fast_path import FastPath, fast_path_of, with_fast_path
from ..transports.delivery import Ordering
from ..wire.message import DecodeError, Message
from .definitions import Guard

_MAX_DROPS = 1024
LONGEST_CALL = 0.5  # seconds after which a call of user code is logged as blocking
Q = TypeVar("Q", bound=Message)
R = TypeVar("R", bound=Message)
Action = Callable[[Any, "JausAddress"], object]  # takes a decoded message and its sender
Take = Callable[[bytes, "JausAddress"], object]  # takes an encoded message and its sender
Condition = Guard | Callable[[Any], Guard]  # the guard of a message, or one for each


@dataclass(frozen=True)
class Provision(Generic[Q, R]):
    """A query and the provider of its report: a message, an encoded one, or None for no answer."""

    query_class: type[Q]
    report_class: type[R]
    provider: Callable[[Q, JausAddress], R | bytes | None]
    periodic: bool = True  # whether clients may request periodic events
    every_change: bool = True  # whether clients may request events on every change


@dataclass(slots=True)
class Handler:
    """The action for an input message, and its guard."""

    message_class: type[Message]
    action: Action
    condition: Condition
    takes_payload: bool = False  # whether the action takes the encoded message
    is_robust: bool = False  # whether such an action never raises, and checks itself for blocking
    counts_each: bool = True  # whether a message is taken that came after a newer one

    def guard_for(self, message: Message) -> Guard:
        """Returns the guard of a message."""
        return self.condition if isinstance(self.condition, Guard) else self.condition(message)


def _name_of(function: Callable[..., Any]) -> str:
    while isinstance(function, partial):
        function = function.func
    return str(getattr(function, "__qualname__", repr(function)))


@dataclass(slots=True)
class _Route:
    """The handler and listeners of the messages of one code.

    Attributes:
        handler_takers: The taker of the handler, if there is one. It remembers which messages are
            late, and so stays when listeners come.
    """

    handler: Handler | None = None
    handler_takers: list[Take] = field(default_factory=list)
    payload_listeners: list[Take] = field(default_factory=list)
    listeners: dict[type[Message], list[Action]] = field(default_factory=dict)


class Router:
    """Decodes messages and calls their handlers and listeners.

    No message makes it raise unless a robust action or a watcher of unwanted messages does.

    Attributes:
        takers: Functions that take payloads, by message code. A tuple is replaced, not changed,
            since a function may add others while it runs.
        unwanted: Watchers by message code, called where nothing takes the message.
        unknown: Takers for codes without one; a message is counted unless a watcher takes it.
        drops: Number of dropped messages by sender, reason and message, at most 1,024 entries.
    """

    def __init__(
        self,
        counters: Counters,
        allows: Callable[[Guard, JausAddress], bool],
        ordering: Callable[[], Ordering],
        stopwatch: Clock,
        changed: Callable[[], None],
    ) -> None:
        """Takes nothing yet.

        Args:
            allows: Tells whether a sender passes a guard.
            ordering: Returns a new order of the messages of one taker.
            stopwatch: Returns seconds.
            changed: Called when fast paths may have become invalid.
        """
        self._counters = counters
        self._changed = changed
        self._allows = allows
        self._ordering = ordering
        self._stopwatch = stopwatch
        self._routes: dict[int, _Route] = {}
        self._provisions: dict[int, Provision[Any, Any]] = {}
        self.takers: dict[int, tuple[Take, ...]] = {}
        self.unwanted: dict[int, Take] = {}
        self.unknown: tuple[Take, ...] = (self._take_unknown,)
        self.drops: dict[tuple[JausAddress, str, str], int] = {}

    def fast_path(self, code: int, sender: JausAddress) -> FastPath | None:
        """Returns the fast path of the messages of a code; None without, or with several takers."""
        takers = self.takers.get(code, ())
        return fast_path_of(takers[0], sender) if len(takers) == 1 else None

    # ---- routes -----------------------------------------------------------------------------

    def set_handler(self, handler: Handler) -> None:
        """Sets the handler of a message; raises ValueError if it has one."""
        message_class = handler.message_class
        route = self._routes.setdefault(message_class.CODE, _Route())
        if route.handler is not None:
            raise ValueError(f"{message_class.NAME} is handled already")
        route.handler = handler
        route.handler_takers.append(self._handler_taker(handler))
        self._prepare(message_class.CODE)

    def set_provision(
        self,
        provision: Provision[Any, Any],
        answer: Callable[[Provision[Any, Any], Message, JausAddress], None],
    ) -> None:
        """Sets the provider of a query; raises ValueError if it has a handler."""
        query_class = provision.query_class
        self.set_handler(Handler(query_class, partial(answer, provision), Guard.ANY))
        self._provisions[query_class.CODE] = provision

    def provision(self, query_code: int) -> Provision[Any, Any] | None:
        """Returns the provision of a query; None without one."""
        return self._provisions.get(query_code)

    def handler(self, code: int) -> Handler | None:
        """Returns the handler of a message; None without one."""
        route = self._routes.get(code)
        return None if route is None else route.handler

    def add_listener(self, message_class: type[Message], action: Action) -> None:
        """Adds an action for each decoded message of a class."""
        route = self._routes.setdefault(message_class.CODE, _Route())
        route.listeners.setdefault(message_class, []).append(action)
        self._prepare(message_class.CODE)

    def add_payload_listener(
        self,
        message_class: type[Message],
        action: Action,
        *,
        is_robust: bool = False,
        counts_each: bool = True,
    ) -> None:
        """Adds an action for each encoded message of a class."""
        route = self._routes.setdefault(message_class.CODE, _Route())
        take = self._payload_taker(message_class, action, is_robust)
        if not counts_each:
            take = self._in_order(message_class, take)
        route.payload_listeners.append(take)
        self._prepare(message_class.CODE)

    def _prepare(self, code: int) -> None:
        """Makes the takers of a code: the handler, then the listeners."""
        route = self._routes[code]
        listeners = [self._decoding_taker(*item) for item in route.listeners.items()]
        self.takers[code] = (*route.handler_takers, *route.payload_listeners, *listeners)
        self._changed()

    # ---- takers -----------------------------------------------------------------------------

    def _handler_taker(self, handler: Handler) -> Take:
        """Returns the taker of a handler; it only decodes messages that its guard allows."""
        message_class, action = handler.message_class, handler.action
        take = (
            self._payload_taker(message_class, action, handler.is_robust)
            if handler.takes_payload
            else self._decoding_taker(message_class, [action])
        )
        if not handler.counts_each:
            take = self._in_order(message_class, take)
        if not isinstance(handler.condition, Guard):
            return partial(self._handle, handler, take)
        if handler.condition is Guard.ANY:
            return take
        guard, allows = handler.condition, self._allows

        def take_guarded(payload: bytes, sender: JausAddress) -> None:
            if allows(guard, sender):
                take(payload, sender)
            else:
                self._count_refused(handler, guard, sender)

        def fast_path(sender: JausAddress) -> FastPath | None:
            return fast_path_of(take, sender) if allows(guard, sender) else None

        return with_fast_path(take_guarded, fast_path)

    def _handle(self, handler: Handler, take: Take, payload: bytes, sender: JausAddress) -> None:
        """Takes a message whose guard depends on its content.

        A message for `takes_payload` is not decoded if its sender is allowed in Ready: no guard is
        stricter.
        """
        if handler.takes_payload and self._allows(Guard.READY, sender):
            take(payload, sender)
            return
        try:
            message = handler.message_class.decode(payload)
        except DecodeError as error:
            self._count_bad(handler.message_class, sender, error)
            return
        guard = self.call(handler.guard_for, message)
        if guard is None:
            return
        if guard is Guard.ANY or self._allows(guard, sender):
            take(payload, sender)
        else:
            self._count_refused(handler, guard, sender)

    def _in_order(self, message_class: type[Message], take: Take) -> Take:
        """Returns a taker that drops messages which come after newer ones of their sender."""
        ordering, counters, note = self._ordering(), self._counters, self._note_drop
        is_late = ordering.is_late

        def take_newer(payload: bytes, sender: JausAddress) -> None:
            if is_late(sender):
                note(sender, "out of order", message_class.NAME)
                counters.count("component.out_of_order", f"{message_class.NAME} of {sender}")
            else:
                take(payload, sender)

        def fast_path(sender: JausAddress) -> FastPath | None:
            path = fast_path_of(take, sender)
            return None if path is None else ordering.ordered_path(path, sender)

        return with_fast_path(take_newer, fast_path)

    def _decoding_taker(self, message_class: type[Message], actions: Sequence[Action]) -> Take:
        """Returns a taker that decodes a message and calls actions with it."""
        actions, decode, attempt = tuple(actions), message_class.decode, self.attempt

        def take(payload: bytes, sender: JausAddress) -> None:
            try:
                message = decode(payload)
            except DecodeError as error:
                self._count_bad(message_class, sender, error)
                return
            for action in actions:
                attempt(action, message, sender)

        return take

    def _payload_taker(
        self,
        message_class: type[Message],
        action: Action,
        is_robust: bool,  # noqa: FBT001 - as its callers have it
    ) -> Take:
        if is_robust:
            return action
        return self.payload_caller(action, partial(self._count_bad, message_class))

    def payload_caller(
        self, function: Action, on_bad: Callable[[JausAddress, DecodeError], None]
    ) -> Callable[[bytes, JausAddress], None]:
        """Returns a taker that calls a function with encoded messages.

        `on_bad` is called with the sender and the error if the function raises DecodeError.
        """
        clock = self._stopwatch

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
                self._count_blocked(function, elapsed)

        return take

    # ---- user code --------------------------------------------------------------------------

    def call(self, function: Callable[..., Any], *arguments: object) -> Any:
        """Calls a function and returns its result; None after an error.

        Errors, and calls that take longer than `LONGEST_CALL`, are counted.
        """
        return self.attempt(function, *arguments)[1]

    def attempt(self, function: Callable[..., Any], *arguments: object) -> tuple[bool, Any]:
        """Calls a function as `call`; returns whether it succeeded, and its result."""
        started = self._stopwatch()
        try:
            return True, function(*arguments)
        except Exception as error:
            self._count_failure(function, error)
            return False, None
        finally:
            elapsed = self._stopwatch() - started
            if elapsed > LONGEST_CALL:
                self._count_blocked(function, elapsed)

    # ---- counts -----------------------------------------------------------------------------

    def _take_unknown(self, payload: bytes, sender: JausAddress) -> None:
        self.unwanted.get(payload[0] | payload[1] << 8, self._count_unknown)(payload, sender)

    def _note_drop(self, sender: JausAddress, reason: str, message: str) -> None:
        key = sender, reason, message
        count = self.drops.get(key, 0)
        if count or len(self.drops) < _MAX_DROPS:
            self.drops[key] = count + 1

    def _count_unknown(self, payload: bytes, sender: JausAddress) -> None:
        self._note_drop(sender, "unknown", f"{payload[0] | payload[1] << 8:04X}h")
        self._counters.add("component.unknown_message")

    def _count_bad(
        self, message_class: type[Message], sender: JausAddress, error: DecodeError
    ) -> None:
        self._note_drop(sender, "unreadable", message_class.NAME)
        self._counters.count("component.bad_message", f"{message_class.NAME} of {sender}: {error}")

    def _count_refused(self, handler: Handler, guard: Guard, sender: JausAddress) -> None:
        self._note_drop(sender, "refused", handler.message_class.NAME)
        self._counters.count(
            "component.command_refused",
            f"{handler.message_class.NAME} of {sender} needs {guard.value}",
        )

    def _count_failure(self, function: Callable[..., Any], error: Exception) -> None:
        name = _name_of(function)
        self._counters.count("component.handler_failed", f"{name}: {error!r}", error=error)

    def _count_blocked(self, function: Callable[..., Any], seconds: float) -> None:
        self._counters.count(
            "component.handler_blocked",
            f"{_name_of(function)} took {seconds:.1f} s; nothing was received meanwhile",
        )
