"""Command events: commands whose result is reported to their client (AS5710 v1.1, Events).

Report events use the same event ids and rejections, which are here too.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ..base.address import JausAddress
from ..base.api import JausError
from ..base.loop import Timer
from ..messages import (
    CancelEvent,
    CommandEvent,
    ConfirmEventRequest,
    CreateCommandEvent,
    CreateEvent,
    RejectEventRequest,
    UpdateEvent,
)
from ..wire.message import DecodeError, Message, read_code
from .definitions import Completion
from .dispatch import Handler
from .host import Host

RejectCode = RejectEventRequest.ResponseCode

EVENT_IDS = 255  # event ids are 0 to 254; peers take 255 for "no event"
MAX_TEXT = 80  # characters that an ErrorMessage holds


class RequestError(JausError):
    """An event request is rejected; `code` is that of the rejection."""

    def __init__(self, code: RejectCode, text: str) -> None:
        super().__init__(text)
        self.code = code


class EventIds:
    """Assigns free event ids, each as late as possible after its last use."""

    def __init__(self, limit: int, make_room: Callable[[JausAddress], object]) -> None:
        """Starts with all ids free; `make_room` may give back one for a client."""
        self._limit = limit
        self._make_room = make_room
        self._used: set[int] = set()
        self._next = 0

    def take(self, client: JausAddress) -> int:
        """Returns a free id; raises RequestError if there is none for the client."""
        if len(self._used) >= self._limit:
            self._make_room(client)
        if len(self._used) >= self._limit:
            raise RequestError(RejectCode.CONNECTION_REFUSED, "too many events")
        while self._next in self._used:
            self._next = (self._next + 1) % EVENT_IDS
        event_id = self._next
        self._next = (event_id + 1) % EVENT_IDS
        self._used.add(event_id)
        return event_id

    def give_back(self, event_id: int) -> None:
        """Makes an id free again."""
        self._used.discard(event_id)


def reject(component: Host, client: JausAddress, request_id: int, error: RequestError) -> None:
    """Sends a client the rejection of its request."""
    component.counters.add("events.rejected")
    message = RejectEventRequest(
        request_id=request_id, response_code=error.code, error_message=str(error)[:MAX_TEXT]
    )
    component.send(message, client)


Result = CommandEvent.CommandResult

NO_COMMANDS = frozenset(  # codes of messages of Events itself, which must not be nested
    message_class.CODE
    for message_class in (CreateEvent, UpdateEvent, CancelEvent, CreateCommandEvent)
)


@dataclass(slots=True, eq=False)
class _Command:
    event_id: int
    client: JausAddress
    message: Message
    payload: bytes
    handler: Handler
    completion: Completion | None = None
    expiry: Timer | None = None


class CommandEvents:
    """Executes command events, and reports their results."""

    def __init__(self, component: Host, ids: EventIds) -> None:
        self._component = component
        self._ids = ids
        self._commands: dict[int, _Command] = {}

    def cancel(self, client: JausAddress, event_id: int) -> bool:
        """Cancels a command event of a client; returns whether there was one."""
        command = self._commands.get(event_id)
        if command is None or command.client != client:
            return False
        self._remove(command)
        return True

    def recheck(self) -> None:
        """Fails commands whose clients are not allowed to command any more."""
        for command in list(self._commands.values()):
            # One without a completion is being executed, and may end control itself, as Reset does.
            if command.completion is None:
                continue
            if not self._permits(command.handler, command.message, command.client):
                self._finish(command, Result.UNSUCCESSFUL)

    def stop(self) -> None:
        """Fails all commands."""
        for command in list(self._commands.values()):
            self._finish(command, Result.UNSUCCESSFUL)

    def create(self, request: CreateCommandEvent, sender: JausAddress) -> None:
        """Confirms a command event and executes its command, or rejects it."""
        try:
            handler, message = self._check(request.command_message, sender)
            command = self._event_of(sender, message)
            if command is None:
                event_id = self._ids.take(sender)
                command = _Command(event_id, sender, message, request.command_message, handler)
                self._commands[event_id] = command
        except RequestError as error:
            reject(self._component, sender, request.request_id, error)
            return
        # What a former command of the event began is not reported any more.
        self._detach(command)
        command.message, command.payload = message, request.command_message
        # Confirmed before execution, so that the client knows the id before the result.
        confirm = ConfirmEventRequest(request_id=request.request_id, event_id=command.event_id)
        self._component.send(confirm, sender)
        command.expiry = self._component.loop.call_later(
            request.maximum_allowed_duration, lambda: self._expire(command)
        )
        self._execute(command)

    def _check(self, payload: bytes, sender: JausAddress) -> tuple[Handler, Message]:
        """Returns the handler and the decoded command; raises RequestError if it is rejected."""
        try:
            code = read_code(payload)
            handler = self._component.command_handler(code)
            is_query = self._component.provision(code) is not None
            if handler is None or is_query or code in NO_COMMANDS:
                raise RequestError(RejectCode.MESSAGE_NOT_SUPPORTED, f"no command {code:04X}")
            message = handler.message_class.decode(payload)
        except DecodeError as error:
            raise RequestError(RejectCode.INVALID_EVENT_SETUP, f"bad command: {error}") from error
        # Checked before an id is taken.
        if not self._permits(handler, message, sender):
            self._component.counters.add("component.command_refused")
            raise RequestError(RejectCode.CONNECTION_REFUSED, "not controlled by you and ready")
        return handler, message

    def _permits(self, handler: Handler, message: Message, client: JausAddress) -> bool:
        guard = self._component.call(handler.guard_for, message)
        return guard is not None and self._component.allows(guard, client)

    def _event_of(self, client: JausAddress, message: Message) -> _Command | None:
        """Returns the event of a client with the same kind of command; None without one."""
        for command in self._commands.values():
            if command.client == client and command.message.CODE == message.CODE:
                return command
        return None

    def _execute(self, command: _Command) -> None:
        handler = command.handler
        content = command.payload if handler.takes_payload else command.message
        succeeded, answer = self._component.attempt(handler.action, content, command.client)
        if self._commands.get(command.event_id) is not command:
            return  # the handler has stopped the component
        if not succeeded:
            self._finish(command, Result.UNSUCCESSFUL)
        elif isinstance(answer, Completion):
            command.completion = answer
            answer.when_ended(lambda: self._report_end(command, answer))
            # Control may have ended while the handler ran.
            self.recheck()
        else:
            self._finish(command, Result.SUCCESSFUL)

    def _report_end(self, command: _Command, completion: Completion) -> None:
        with self._component.loop.lock:
            # Another command may have replaced it in the same event.
            if command.completion is completion and command.event_id in self._commands:
                result = Result.SUCCESSFUL if completion.succeeded else Result.UNSUCCESSFUL
                self._finish(command, result)

    def _expire(self, command: _Command) -> None:
        self._component.counters.add("events.command_expired")
        self._finish(command, Result.UNSUCCESSFUL)

    def _finish(self, command: _Command, result: Result) -> None:
        self._remove(command)
        message = CommandEvent(event_id=command.event_id, command_result=result)
        self._component.send(message, command.client)

    def _remove(self, command: _Command) -> None:
        del self._commands[command.event_id]
        self._ids.give_back(command.event_id)
        self._detach(command)

    @staticmethod
    def _detach(command: _Command) -> None:
        """Ends the timer and the completion of a command that is not reported any more."""
        # Removed first: `fail` calls `_report_end`, which must not report it.
        completion, command.completion = command.completion, None
        if completion is not None:
            completion.fail()
        if command.expiry is not None:
            command.expiry.cancel()
            command.expiry = None
